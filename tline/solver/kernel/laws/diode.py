"""Diode of Shockley. Constants: effort beyond the element, saturation current, thermal voltage.

Behind an impedance z the flow is sought as w = (z·saturation/thermal)·exp(u/thermal), of which w + log w is known: w is
Lambert's W of a number whose logarithm that is.

References
----------
F. N. Fritsch, R. E. Shafer, W. P. Crowley: Solution of the transcendental equation w exp(w) = x. Comm. ACM 16 (1973)
123-124, doi:10.1145/361952.361970.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.sampled import sampled
from tline.solver.kernel.network import Crossing

SMALL, LARGE = -1.5, 3.0  # logarithms between which w begins with a series, and beyond with what it tends to
ENOUGH = 1e-4  # relative change after which the next one, of fourth order, is below rounding
STEPS = 8
NEAR = 1.0  # of the thermal voltage: nearer to zero the flow is small beside the saturation current


@function
def lambert(known):
    """Where w + log w is known, w."""
    if known < SMALL:
        w = np.exp(known)
        w /= 1.0 + w
    elif known > LARGE:
        w = known - np.log(known)
    else:
        w = 1.0 + (known - 1.0) * (0.5 + (known - 1.0) / 16.0)
    for _ in range(STEPS if w > 0.0 else 0):
        rest = known - w - np.log(w)
        q = 2.0 * (1.0 + w) * (1.0 + w + 2.0 / 3.0 * rest)
        change = rest / (1.0 + w) * (q - rest) / (q - 2.0 * rest)
        w *= 1.0 + change
        if abs(change) <= ENOUGH:
            break
    return w


@function
def shockley(c, at, _, d, z):
    """Flow i and di/dd where d = u + z i and i = saturation (exp(u/thermal) - 1)."""
    saturation, thermal = c[at + 1], c[at + 2]
    if z == 0.0:
        slope = saturation / thermal * np.exp(d / thermal)
        return saturation * np.expm1(d / thermal), slope
    share = z * saturation / thermal
    w = lambert(d / thermal + share + np.log(share))
    u = d + thermal * (share - w)
    if abs(u) < NEAR * thermal:
        u -= (u + z * saturation * np.expm1(u / thermal) - d) / (1.0 + w)
        i = saturation * np.expm1(u / thermal)
    else:
        i = (w - share) * thermal / z
    return i, w / (z * (1.0 + w))


@unit
def diode(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a diode at n samples, behind the efforts v and the impedance z."""
    return sampled(shockley, crossing, at, n, z)
