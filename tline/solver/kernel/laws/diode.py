"""Diode of Shockley. Constants: effort beyond the element, saturation current, thermal voltage."""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import STEPS
from tline.solver.kernel.laws.crossing import sampled
from tline.solver.kernel.network import Crossing


@function
def shockley(c, at, _, d, z):
    """Flow i and di/dd where d = u + z i and i = saturation (exp(u/thermal) - 1): Newton from the right, monotone."""
    saturation, thermal, u = c[at + 1], c[at + 2], d
    if d > 0.0 and z > 0.0:
        u = min(d, thermal * np.log1p(d / (z * saturation)))
    elif d < 0.0:
        u = 0.0
    for _ in range(STEPS if z > 0.0 else 0):
        growth = z * saturation * np.exp(u / thermal)
        step = (u + z * saturation * np.expm1(u / thermal) - d) / (1.0 + growth / thermal)
        u -= step
        if abs(step) <= 1e-15 * abs(u) + 1e-300:
            break
    if z == 0.0 and d < 0.0:
        u = d
    slope = saturation / thermal * np.exp(u / thermal)
    return saturation * np.expm1(u / thermal), slope / (1.0 + z * slope)


@unit
def diode(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a diode at n samples, behind the efforts v and the impedance z."""
    return sampled(shockley, crossing, at, n, z)
