"""What lines in cells remember or leak: circuits, each in its place along the line, from one cell there to the next.

A circuit sees one polynomial of each wave over its cell, and is advanced by Radau IIA. What lies between a wave and its
polynomial changes so fast, as fronts do, that the circuit answers at once: it is attenuated.
"""

from tline.compiled.unit import unit
from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.network import Run


@unit
def remember(run: Run, row: int, column: int) -> int:
    """Let the circuits of a column of cells take from the two waves in the workspace what they see of them.

    Puts the share in the workspace that is left of what they do not see.
    """
    diamonds, work, states = run.network.diamonds, run.work.diamonds, run.state.memory
    memory, a, b, w, out = diamonds.memory, work.parts[0, 0], work.parts[1, 0], work.a, work.b
    last, r = 2 * (run.network.delay[diamonds.line[row]] // diamonds.cell[row]) - 2, w.size
    place = 1 if column == 0 or column == last else 0
    work.rest[0] = memory.rest[row, place]
    for c in range(memory.first[row], memory.first[row + 1]):
        sign, n, across = memory.sign[c], memory.modes[c], 1 if memory.sign[c] > 0 else 0
        direct = memory.at[c, place]
        read, write, decay = direct + r * r, direct + r * r + r * n, direct + r * r + 2 * r * n
        state = memory.state_at[c] + column * n
        for i in range(r):
            w[i] = a[i] + sign * b[i] - diamonds.steady[row, across]
        for i in range(r):
            out[i] = 0.0
            for j in range(r):
                out[i] += memory.maps[direct + i * r + j] * w[j]
            for k in range(n):
                out[i] += memory.maps[read + i * n + k] * states[state + k]
        for k in range(n):
            x = memory.maps[decay + k] * states[state + k]
            for j in range(r):
                x += memory.maps[write + k * r + j] * w[j]
            states[state + k] = 0.0 if abs(x) < TINY else x
        for i in range(r):
            a[i] -= out[i]
            b[i] -= sign * out[i]
    return 0
