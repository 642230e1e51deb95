"""Orifice: pressure falls with the square of the flow, capacity scaled by the opening.

Constants: effort beyond the element, capacity, 1 if it passes flow one way only.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import sampled
from tline.solver.kernel.network import Crossing


@function
def rooted(d, z, capacity, one_way):
    """Flow i and di/dd where d = z i + i |i| / capacity²; without cancellation from shut to without loss."""
    if capacity == 0.0 or (one_way > 0.0 and d < 0.0):
        return 0.0, 0.0
    if capacity == np.inf:
        return d / z, 1.0 / z
    sum_ = z * capacity + np.sqrt((z * capacity) ** 2 + 4.0 * abs(d))
    if sum_ == 0.0:
        return 0.0, 1.0 / z
    i = 2.0 * d * capacity / sum_
    return i, capacity**2 / (z * capacity**2 + 2.0 * abs(i))


@function
def orifice(c, at, opening, d, z):
    """Flow i and di/dd at an opening."""
    return rooted(d, z, c[at + 1] * max(opening, 0.0), c[at + 2])


@unit
def quadratic(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of an orifice at n samples, behind the efforts v and the impedance z."""
    return sampled(orifice, crossing, at, n, z)
