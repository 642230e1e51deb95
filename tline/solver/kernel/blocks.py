"""The loop over blocks of slabs: lines carry waves, nodes scatter them.

Nodes do not affect each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once (`tline.solver.kernel.scatter`).

The fractional rest of a delay: a slab that arrives is the projection of parts of the last two that were sent.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.network import Run
from tline.solver.kernel.scatter import FAR, NEAR


@function
def rotate(network, state, lines, count):
    """Rotate the buffers of some lines by `count` slabs."""
    delay, slots = network.delay, state.slot
    for line in lines:
        slots[line] += count
        if slots[line] >= delay[line]:
            slots[line] -= delay[line]
            state.side[line] = 1 - state.side[line]


@function
def until_due(run, rows, most):
    """Slabs until friction is due in the cells of some lines, at most `most`."""
    for r in rows:
        if run.network.diamonds.cell[r] > 0:
            most = min(most, run.network.diamonds.cell[r] - run.state.since[r])
    return most


@function
def node_at(network, end):
    """Node at which a line ends."""
    node = np.int64(0)
    for i in range(network.ends.size):
        if network.ends[i] == end:
            while network.first[node + 1] <= i:
                node += 1
    return node


@unit
def advance(run: Run, k: int, n_slabs: int, column: int) -> int:
    """Advance all nodes by n_slabs, from slab k of the excitation and of the record that begins in the column.

    Far nodes go a stride. Then the others follow in steps; near lines pass on meanwhile, and far lines wait.
    Returns -1, or the number of a node whose effort is no longer finite.
    """
    network, state, blocks, units = run.network, run.state, run.network.blocks, run.units
    done = np.int64(0)
    while done < n_slabs:
        block = until_due(run, blocks.far_cells, min(blocks.stride, n_slabs - done))
        begun, far = np.int64(0), True
        while begun < block:
            count = block if far else until_due(run, blocks.near_cells, min(blocks.step, block - begun))
            groups = FAR if far else NEAR
            node = invoke(units.scatter, (run, np.int64(groups), k + done + begun, begun, count, column))
            if node >= 0:
                return node
            if not far:
                rotate(network, state, blocks.near_lines, count)
                line = invoke(units.diamonds, (run, np.int64(NEAR), count)) if blocks.near_cells.size else -1
                if line >= 0:
                    return node_at(network, 2 * line)
                begun += count
            far = False
        rotate(network, state, blocks.far_lines, block)
        line = invoke(units.diamonds, (run, np.int64(FAR), block)) if blocks.far_cells.size else -1
        if line >= 0:
            return node_at(network, 2 * line)
        done += block
    return -1


@function
def add_one(row, m, shift, i, j, history):
    """Add to m samples the contribution of one point of the slabs that were sent."""
    now, then = shift[0, i, j], shift[1, i, j]
    for k in range(m):
        row[k] += now * history[j, k + 1] + then * history[j, k]


@function
def add_two(row, m, shift, i, j, history):
    """Add to m samples the contribution of two points, with fewer loads and stores than one by one."""
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
