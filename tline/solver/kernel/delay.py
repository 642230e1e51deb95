"""The fractional rest of a delay: a slab that arrives is the projection of parts of the last two that were sent."""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.network import Run


@function
def add_one(row, m, shift, i, j, history):
    """Add to m samples what a point of the slabs that were sent has in them."""
    now, then = shift[0, i, j], shift[1, i, j]
    for k in range(m):
        row[k] += now * history[j, k + 1] + then * history[j, k]


@function
def add_two(row, m, shift, i, j, history):
    """The same of two points: sums are fetched and put back less often."""
    now, then, now_next, then_next = shift[0, i, j], shift[1, i, j], shift[0, i, j + 1], shift[1, i, j + 1]
    for k in range(m):
        here = now * history[j, k + 1] + then * history[j, k]
        row[k] += here + (now_next * history[j + 1, k + 1] + then_next * history[j + 1, k])


@unit
def delay_rest(run: Run, end: int, o: int, m: int) -> int:
    """Delay m slabs that arrive at an end from place o of the buffers on by the rest of the line's delay, in place.

    w(t) is replaced by S0 w(t) + S1 w(t - 1): the matrices of the line's row of `shift`.
    """
    waves, before, history, row = run.state.waves, run.state.before, run.work.history, run.work.row
    shift, s = run.network.shift[run.network.shift_row[end >> 1]], before.shape[1]
    place = np.uint64(o)
    for j in range(s):
        history[j, 0] = before[end, j]
        for k in range(m):
            history[j, k + 1] = waves[place + np.uint64(k * s + j)]
        before[end, j] = history[j, m]
    for i in range(s):
        for k in range(m):
            row[k] = 0.0
        for j in range(0, s - 1, 2):
            add_two(row, m, shift, i, j, history)
        if s % 2 == 1:
            add_one(row, m, shift, i, s - 1, history)
        for k in range(m):
            waves[place + np.uint64(k * s + i)] = row[k]
    return 0
