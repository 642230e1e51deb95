"""The loop over blocks of slabs: lines carry waves, nodes scatter them.

Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once (`tline.solver.kernel.scatter`).
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.network import Run
from tline.solver.kernel.scatter import FAR, NEAR


@function
def rotate(network, state, lines, count):
    """Let so many slabs pass on some lines."""
    delay, slots = network.delay, state.slot
    for line in lines:
        slots[line] += count
        if slots[line] >= delay[line]:
            slots[line] -= delay[line]
            state.side[line] = 1 - state.side[line]


@function
def until_due(run, rows, most):
    """Slabs until friction is due in the cells of some lines, at most so many."""
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
