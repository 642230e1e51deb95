"""Lossy lines in segments one slab long, advanced slab by slab."""

from tline.compiled.unit import unit
from tline.solver.kernel.arithmetic import TINY, add_product
from tline.solver.kernel.network import Run


@unit
def pass_segments(run: Run) -> int:
    """Advance lossy lines in segments by the slab in which the nodes have just worked.

    At an end K is what comes back at once: w = y + K o arrives while o leaves, ŷ = R y with R = 1/(1 + K), and with
    r = 2u - ŷ in the buffer o = r - Q (r + ŷ), Q = R K. Where segments meet, a and b leave them, and X a + Y b and
    X b + Y a enter, with X = 1/(1 - K²) and Y = X K.
    """
    network, state, segments, enter, y = run.network, run.state, run.network.segments, run.work.enter, run.work.leave
    waves, values, s = state.waves, state.segments, state.before.shape[1]
    for r in range(segments.line.size):
        line, D, m, x0 = segments.line[r], segments.number[r], segments.held[r], segments.state[r]
        each, maps, at = m + 2 * s, segments.maps, segments.at[r]
        ends = x0 + D * each
        into = at + each * m
        X = into + each * 2 * s
        Y, R, Q = X + s * s, X + 2 * s * s, X + 3 * s * s
        for i in range(2 * s * D):
            enter[i] = 0.0
        for end in range(2):
            o, here = 2 * s * (D - 1) + s if end else 0, network.offset[line] + (state.side[line] ^ end) * s
            for i in range(s):
                enter[o + i] = waves[here + i]
                y[i] = enter[o + i] + values[ends + end * s + i]
            for j in range(s):
                for i in range(s):
                    enter[o + i] -= maps[Q + j * s + i] * y[j]
        for c in range(D - 1):
            a, b = x0 + c * each + m, x0 + (c + 1) * each + m + s
            add_product(maps, X, s, s, values, a, enter, 2 * s * (c + 1))
            add_product(maps, Y, s, s, values, b, enter, 2 * s * (c + 1))
            add_product(maps, X, s, s, values, b, enter, 2 * s * c + s)
            add_product(maps, Y, s, s, values, a, enter, 2 * s * c + s)
        for c in range(D):
            x = x0 + c * each
            for i in range(each):
                y[i] = 0.0
            add_product(maps, into, each, 2 * s, enter, 2 * s * c, y, 0)
            add_product(maps, at, each, m, values, x, y, 0)
            for i in range(each):
                values[x + i] = 0.0 if abs(y[i]) < TINY else y[i]
        for end in range(2):
            o, there = (
                x0 + (D - 1) * each + m if end else x0 + m + s,
                network.offset[line] + (1 - state.side[line] ^ end) * s,
            )
            for i in range(s):
                values[ends + end * s + i] = 0.0
            add_product(maps, R, s, s, values, o, values, ends + end * s)
            for i in range(s):
                waves[there + i] = values[ends + end * s + i]
    return 0
