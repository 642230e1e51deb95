"""A law at many samples."""

from tline.compiled.unit import function


@function
def sampled(law, crossing, at, n, z):
    """Let a law, of its constants, a control signal, an effort and an impedance, give flows and slopes at n samples.

    While nothing changes, such as behind an edge or before a valve moves, it is not asked again.
    """
    c, v, control, flow, slope = crossing.constants, crossing.v, crossing.control, crossing.flow, crossing.slope
    for i in range(n):
        if i > 0 and v[i] == v[i - 1] and control[i] == control[i - 1]:
            flow[i], slope[i] = flow[i - 1], slope[i - 1]
            continue
        flow[i], slope[i] = law(c, at, control[i], v[i] - c[at], z)
    return 0
