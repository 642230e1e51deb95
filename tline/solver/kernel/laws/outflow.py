"""Leak and demand: a flow that grows with a power of the pressure; a demand is delivered in full from a pressure on.

Constants: effort beyond the element, flow at a pressure, that pressure, exponent, and that pressure again if the flow
grows no more from there on, else infinity.
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
def passed(c, at, control, d, z):
    """Flow i and di/dd behind the effort d and the impedance z."""
    if d <= 0.0 or control <= 0.0:
        return 0.0, 0.0
    most = c[at + 4]
    if d - z * control * c[at + 1] >= most:
        return control * c[at + 1], 0.0
    if c[at + 3] == 0.5:
        return rooted(d, z, control * c[at + 1] / np.sqrt(c[at + 2]), 0.0)
    return bracketed(power, c, at, control, d, z, 0.0, min(d, most))


@unit
def outflow(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a leak or a demand at n samples, behind the efforts v and the impedance z."""
    return sampled(passed, crossing, at, n, z)
