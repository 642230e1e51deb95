"""Pump: a head that falls with the square of the flow and follows the laws of affinity.

Constants: effort beyond the element, head at rest, its linear and quadratic fall, 1 with a check valve. The control
signal is the speed over the rated one.
"""

import numpy as np

from tline.solver.kernel.network import Crossing
from tline.unit import function, unit


@function
def parabolic(d, z, bend, one_way):
    """Flow i and di/dd where d = z i + bend i |i|."""
    if one_way > 0.0 and d < 0.0:
        return 0.0, 0.0
    sum_ = z + np.sqrt(z**2 + 4.0 * bend * abs(d))
    if sum_ == 0.0:
        return 0.0, 0.0
    i = 2.0 * d / sum_
    return i, 1.0 / (z + 2.0 * bend * abs(i))


@unit
def pump(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a pump at n samples, behind the efforts v and the impedance z."""
    c, v, control, flow, slope = crossing.constants, crossing.v, crossing.control, crossing.flow, crossing.slope
    for i in range(n):
        speed = max(control[i], 0.0)
        d = v[i] - c[at] + speed**2 * c[at + 1]
        flow[i], slope[i] = parabolic(d, z + speed * c[at + 2], c[at + 3], c[at + 4])
    return 0
