"""Table: straight lines through points. Constants: effort beyond the element, number n, n efforts, n flows."""

from tline.solver.kernel.laws.sampled import sampled
from tline.solver.kernel.network import Crossing
from tline.unit import function, unit


@function
def tabled(c, place, _, d, z):
    """Flow i and di/dd where d = u + z i, and (u, i) lies on straight lines through points, continued beyond."""
    at, n = place + 2, int(c[place + 1])
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if c[at + middle] + z * c[at + n + middle] <= d:
            low = middle
        else:
            high = middle
    start, stop = c[at + low] + z * c[at + n + low], c[at + high] + z * c[at + n + high]
    rise = c[at + n + high] - c[at + n + low]
    if stop <= start:
        return c[at + n + low], 0.0
    slope = rise / (stop - start)
    if d - start < stop - d:
        return c[at + n + low] + slope * (d - start), slope
    return c[at + n + high] - slope * (stop - d), slope


@unit
def table(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a table at n samples, behind the efforts v and the impedance z."""
    return sampled(tabled, crossing, at, n, z)
