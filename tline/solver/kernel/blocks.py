"""The loop over blocks of slabs: lines carry waves, nodes scatter them.

Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once; where a line's slot wraps, or the workspace is full, the block is cut into tiles that are contiguous in memory.
"""

import numpy as np

from tline.solver.kernel.network import Run
from tline.solver.kernel.scatter import scatter_group
from tline.unit import function, invoke, unit


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
def lose(run, rows, m):
    """Let rows of loss elements take what they dissipate of m slabs, no more than the gaps between them."""
    for r in rows:
        invoke(run.units.loss[r], (run, np.int64(r), m))


@function
def place_tile(run, g, begun, ahead, most):
    """Places where the ends of a group work from slab `ahead` of a block on; returns for how many slabs they hold."""
    network, state, position = run.network, run.state, run.work.position
    delay, offset, ends, waits = network.delay, network.offset, network.ends, network.blocks.waits
    slots, sides, s, m = state.slot, state.side, state.before.shape[1], most
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = ends[i]
        line = e >> 1
        slot, side = slots[line] + ahead, sides[line] ^ (e & 1)
        if waits[line]:
            slot += begun
        if slot >= delay[line]:
            slot, side = slot - delay[line], 1 - side
        m = min(m, delay[line] - slot)
        position[e] = offset[line] + (side * delay[line] + slot) * s
    return m


@unit
def advance(run: Run, k: int, n_slabs: int, column: int) -> int:
    """Advance all nodes by n_slabs, from slab k of the excitation and of the record that begins in the column.

    Far nodes go a stride. Then the others follow in steps; near lines pass on meanwhile, and far lines wait.
    Returns -1, or the number of a node whose effort is no longer finite.
    """
    network, state, blocks, units = run.network, run.state, run.network.blocks, run.units
    s, tile, done = state.before.shape[1], run.work.tile, np.int64(0)
    while done < n_slabs:
        block, begun, far = min(blocks.stride, n_slabs - done), np.int64(0), True
        while begun < block:
            groups = blocks.far_groups if far else blocks.near_groups
            count = block if far else min(blocks.step, block - begun)
            for g in groups:
                ahead = np.int64(0)
                while ahead < count:
                    most = np.int64(1) if network.laws.governed[g] else tile
                    m = place_tile(run, g, begun, ahead, min(count - ahead, most))
                    node = scatter_group(run, g, (k + done + begun + ahead) * s, m, column * s)
                    if node >= 0:
                        return node
                    ahead += m
            if not far:
                lose(run, blocks.near_rows, count)
                if units.segments != 0:
                    invoke(units.segments, (run,))
                rotate(network, state, blocks.near_lines, count)
                begun += count
            far = False
        lose(run, blocks.far_rows, block)
        rotate(network, state, blocks.far_lines, block)
        done += block
    return -1
