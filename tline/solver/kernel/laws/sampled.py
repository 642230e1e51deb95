"""A law at many samples."""

from tline.compiled.unit import function


@function
def sampled(law, crossing, at, n, z):
    """Let a law, of its constants, a control signal, an effort and an impedance, give flows and slopes at n samples."""
    c, v, control, flow, slope = crossing.constants, crossing.v, crossing.control, crossing.flow, crossing.slope
    for i in range(n):
        flow[i], slope[i] = law(c, at, control[i], v[i] - c[at], z)
    return 0
