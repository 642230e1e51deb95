"""A law that gives its flow as a function of the effort, behind an impedance: a root between two efforts."""

from tline.compiled.unit import function
from tline.solver.kernel.newton import STEPS, ULPS


@function
def bracketed(conducted, c, at, control, d, z, low, high):
    """Flow i and di/dd where d = u + z i(u), and u lies between low and high: Newton, bisection where that fails."""
    u = high
    for _ in range(STEPS):
        i, slope = conducted(c, at, control, u)
        rest = u + z * i - d
        if rest > 0.0:
            high = u
        else:
            low = u
        step = rest / (1.0 + z * slope)
        after = u - step
        if not low * (1.0 - ULPS) <= after <= high * (1.0 + ULPS):
            after = 0.5 * (low + high)
        close = abs(after - u) <= ULPS * u
        u = after
        if close:
            break
    i, slope = conducted(c, at, control, u)
    if z * slope > 1.0:  # then u is known better than what it conducts
        i = (d - u) / z
    return i, slope / (1.0 + z * slope)
