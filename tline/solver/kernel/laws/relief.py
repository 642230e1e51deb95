"""Relief valve: opens in proportion to the pressure above its set point, within a band; an orifice beyond it.

Constants: effort beyond the element, capacity, set point, band.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import bracketed, sampled
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Crossing


@function
def opening(c, at, _, u):
    """Flow, and its slope, at an effort u in the band."""
    rate, root = c[at + 1] / c[at + 3], np.sqrt(u)
    return rate * (u - c[at + 2]) * root, rate * (root + 0.5 * (u - c[at + 2]) / root)


@function
def relieved(c, at, factor, d, z):
    """Flow i and di/dd behind the effort d and the impedance z."""
    least = c[at + 2]
    if d <= least or factor <= 0.0:
        return 0.0, 0.0
    i, slope = rooted(d, z, c[at + 1], 0.0)
    high = least + c[at + 3]
    if d - z * i >= high:
        return i, slope
    return bracketed(opening, c, at, factor, d, z, least, min(d, high))


@unit
def relief(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a relief valve at n samples, behind the efforts v and the impedance z."""
    return sampled(relieved, crossing, at, n, z)
