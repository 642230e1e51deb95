"""Leak and demand: a flow that grows with a power of the pressure; a demand is delivered in full from a pressure on.

Constants: effort beyond the element, flow at a pressure, that pressure, exponent.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import bracketed, sampled
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Crossing


@function
def power(c, at, control, u):
    """Flow, and its slope, at an effort u."""
    share = (u / c[at + 2]) ** c[at + 3] * control * c[at + 1]
    return share, c[at + 3] * share / u


@function
def leaking(c, at, control, d, z):
    """Flow i and di/dd of a leak behind the effort d and the impedance z."""
    if d <= 0.0 or control <= 0.0:
        return 0.0, 0.0
    if c[at + 3] == 0.5:
        return rooted(d, z, control * c[at + 1] / np.sqrt(c[at + 2]), 0.0)
    return bracketed(power, c, at, control, d, z, 0.0, d)


@function
def demanded(c, at, control, d, z):
    """Flow of a demand behind an impedance, and its slope."""
    if d <= 0.0 or control <= 0.0:
        return 0.0, 0.0
    if d - z * control * c[at + 1] >= c[at + 2]:
        return control * c[at + 1], 0.0
    return bracketed(power, c, at, control, d, z, 0.0, min(d, c[at + 2]))


@unit
def leak(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a leak at n samples, behind the efforts v and the impedance z."""
    return sampled(leaking, crossing, at, n, z)


@unit
def demand(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a demand at n samples, behind the efforts v and the impedance z."""
    return sampled(demanded, crossing, at, n, z)
