"""Table: straight lines through points, all flows scaled by the control signal.

Constants: effort beyond the element, number n, n efforts, n flows.
"""

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import sampled
from tline.solver.kernel.network import Crossing


@function
def tabled(c, place, scale, d, z):
    """Flow i and di/dd where d = u + z i, and (u, i/scale) lies on straight lines through points, continued beyond."""
    at, n, k = place + 2, int(c[place + 1]), max(scale, 0.0)
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if c[at + middle] + z * k * c[at + n + middle] <= d:
            low = middle
        else:
            high = middle
    first, last = k * c[at + n + low], k * c[at + n + high]
    start, stop = c[at + low] + z * first, c[at + high] + z * last
    if stop <= start:
        return first, 0.0
    slope = (last - first) / (stop - start)
    if d - start < stop - d:
        return first + slope * (d - start), slope
    return last - slope * (stop - d), slope


@unit
def table(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a table at n samples, behind the efforts v and the impedance z."""
    return sampled(tabled, crossing, at, n, z)
