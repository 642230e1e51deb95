"""A law that a user has written: a C function at an address. Constants: effort beyond the element, address."""

import numpy as np

from tline.compiled.unit import callback, function, unit
from tline.solver.kernel.arithmetic import STEPS, TINY, ULPS
from tline.solver.kernel.laws.crossing import sampled
from tline.solver.kernel.network import Crossing


@function
def user_flow(c, at, control, d, z):
    """Flow i and di/dd where d = u + z i(u), by Ridders' method, which needs no slope of i(u)."""
    address = int(c[at + 1])
    low, high, wide = min(d, 0.0), max(d, 0.0), abs(d)
    at_low = low + z * callback(address, low, control) - d
    at_high = high + z * callback(address, high, control) - d
    for _ in range(STEPS):  # an active law has its effort beyond the wave
        if at_low <= 0.0 <= at_high:
            break
        wide = 2.0 * max(wide, abs(at_low), abs(at_high))
        if at_low > 0.0:
            low -= wide
            at_low = low + z * callback(address, low, control) - d
        if at_high < 0.0:
            high += wide
            at_high = high + z * callback(address, high, control) - d
    if not at_low <= 0.0 <= at_high:
        return np.nan, 0.0
    u = low if at_low == 0.0 else high
    for _ in range(STEPS):
        if at_low == 0.0 or at_high == 0.0 or high - low <= ULPS * max(abs(low), abs(high)):
            break
        before, middle = u, 0.5 * (low + high)
        rest = middle + z * callback(address, middle, control) - d
        u = middle if rest == 0.0 else middle - (middle - low) * rest / np.sqrt(rest**2 - at_low * at_high)
        left = u + z * callback(address, u, control) - d
        for place, value in ((middle, rest), (u, left)):
            if value > 0.0 and place < high:
                high, at_high = place, value
            elif value <= 0.0 and place > low:
                low, at_low = place, value
        if abs(u - before) <= ULPS * abs(u):
            break
    i, step = callback(address, u, control), 1e-6 * max(abs(u), abs(d)) + TINY
    slope = max(callback(address, u + step, control) - callback(address, u - step, control), 0.0) / (2.0 * step)
    if z * slope > 1.0:
        i = (d - u) / z
    return i, slope / (1.0 + z * slope)


@unit
def user_defined(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows through a user-defined element at n samples, behind the efforts v and the impedance z."""
    return sampled(user_flow, crossing, at, n, z)
