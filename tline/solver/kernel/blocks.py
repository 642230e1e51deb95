"""The loop over blocks of slabs: lines carry waves, nodes scatter them: w arrives, u is the effort, 2u - w leaves.

Nodes do not affect each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once. Where a line's slot wraps, or the workspace is full, a block is cut into tiles that are contiguous in memory.
Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise. A group with a map and without laws takes one matrix product a slab.

The fractional rest of a delay: a slab that arrives is the projection of parts of the last two that were sent.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit, unit_of_long_loops
from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.laws.crossing import is_watched
from tline.solver.kernel.network import Run

FAR, NEAR = -1, -2  # groups of a block


@function
def load(run, g, n, step, at):
    """Turn the Thévenin waves of n samples at a group into the nodes' efforts, through the group's state.

    The map from (k Thévenin waves at q points, states) to (k efforts, the next states) begins at a place of `step`.
    """
    network, states, u, row, s = run.network, run.state.load, run.work.u, run.work.row, run.state.before.shape[1]
    r, x = network.step_row[g], network.load_at[g]
    k, count = network.group[g + 1] - network.group[g], network.step_states[r]
    q = s if network.step_whole[r] else np.int64(1)
    width = np.uint64(k * q + count)
    for block in range(n // q):
        for p in range(k):
            for i in range(q):
                row[np.uint64(p * q + i)] = u[np.uint64(p * n + block * q + i)]
        for i in range(count):
            row[np.uint64(k * q + i)] = states[np.uint64(x + i)]
        place = np.uint64(at)
        for p in range(k):
            for i in range(q):
                total = 0.0
                for j in range(width):
                    total += step[place + j] * row[j]
                place += width
                u[np.uint64(p * n + block * q + i)] = total
        for i in range(count):
            total = 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            place += width
            states[np.uint64(x + i)] = 0.0 if abs(total) < TINY else total


@function
def begin(u, q, n, excitation, row, start):
    """Start the Thévenin wave of a node, at place q of u, with the sources' part."""
    if row < 0:
        for i in range(n):
            u[q + np.uint64(i)] = 0.0
    else:
        for i in range(n):
            u[q + np.uint64(i)] = excitation[row, start + i]


@function
def arrived(network, e, waves, o, n):
    """Attenuate an arriving wave, or subtract the loss of a steady flow under way."""
    share, more = network.passed[e >> 1], network.moved[e]
    if share != 1.0 or more != 0.0:
        for i in range(n):
            waves[o + np.uint64(i)] = share * waves[o + np.uint64(i)] + more


@function
def gather(u, q, n, waves, o, share):
    """Add an end's share of its arriving wave."""
    for i in range(n):
        u[q + np.uint64(i)] += share * waves[o + np.uint64(i)]


@function
def scatter(u, q, n, waves, o):
    """Send the wave 2u - w back from an end."""
    for i in range(n):
        back = 2.0 * u[q + np.uint64(i)] - waves[o + np.uint64(i)]
        waves[o + np.uint64(i)] = 0.0 if abs(back) < TINY else back


@function
def note(u, q, n, waves, o, record, row, column):
    """Record the waves that arrive at an end and leave it; both are the effort where that is in place of a wave."""
    for i in range(n):
        record[row, 0, column + i] = waves[o + np.uint64(i)]
        record[row, 1, column + i] = 2.0 * u[q + np.uint64(i)] - waves[o + np.uint64(i)]


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


@function
def scatter_group(run, g, here, m, column):
    """Scatter m slabs at a group, from sample `here` of the excitation on. Returns a node that is not finite, or -1."""
    network, state, units, u, position = run.network, run.state, run.units, run.work.u, run.work.position
    ends, weight, record_row, waves, record = network.ends, network.weight, network.record_row, state.waves, run.record
    excitation, shift_row, first = run.excitation, network.shift_row, network.first
    s, one, after = state.before.shape[1], network.group[g], network.group[g + 1]
    n = m * s
    for node in range(one, after):
        q = np.uint64((node - one) * n)
        begin(u, q, n, excitation, network.excitation_row[node], here)
        for i in range(first[node], first[node + 1]):
            e = ends[i]
            if shift_row[e >> 1] >= 0:
                invoke(units.delay, (run, e, position[e], m))
            arrived(network, e, waves, np.uint64(position[e]), n)
            gather(u, q, n, waves, np.uint64(position[e]), weight[i])
    if network.laws.first[g] < network.laws.first[g + 1]:
        invoke(units.laws, (run, g, here, n, column))
    elif network.load_at[g] >= 0:
        load(run, g, n, network.step, network.step_at[network.step_row[g]])
    for node in range(one, after):
        q = np.uint64((node - one) * n)
        for i in range(first[node], first[node + 1]):
            e = ends[i]
            o = np.uint64(position[e])
            if record_row[e] >= 0:
                note(u, q, n, waves, o, record, record_row[e], column + here)
            scatter(u, q, n, waves, o)
        if network.effort_row[node] >= 0:
            note(u, q, n, u, q, record, network.effort_row[node], column + here)
        if not np.isfinite(u[q + np.uint64(n - 1)]):
            return node
    return -1


@function
def is_plain(run, g):
    """Whether a group is a node at which whole delays of lines end, and that has neither a law nor a circuit."""
    network = run.network
    one = network.group[g + 1] - network.group[g] == 1 and network.load_at[g] < 0
    return one and network.laws.first[g] == network.laws.first[g + 1] and network.shift.shape[0] == 0


@function
def scatter_one(run, node, here, begun, ahead, column):
    """Scatter a single sample at a node without a circuit. Returns whether its effort is finite."""
    network, state, waves, position = run.network, run.state, run.state.waves, run.work.position
    row, record_row, begin, end = (
        network.excitation_row[node],
        network.record_row,
        network.first[node],
        network.first[node + 1],
    )
    u = run.excitation[row, here] if row >= 0 else 0.0
    for i in range(begin, end):
        e = np.uint64(network.ends[i])
        line = e >> np.uint64(1)
        delay, slot = network.delay[line], state.slot[line] + ahead + (begun if network.blocks.waits[line] else 0)
        side = state.side[line] ^ np.int64(e & np.uint64(1))
        at = network.offset[line] + (side * delay + slot if slot < delay else (1 - side) * delay + slot - delay)
        w = network.passed[line] * waves[np.uint64(at)] + network.moved[e]
        waves[np.uint64(at)], position[e] = w, at
        u += network.weight[i] * w
    for i in range(begin, end):
        e = np.uint64(network.ends[i])
        at = np.uint64(position[e])
        if record_row[e] >= 0:
            run.record[record_row[e], 0, column + here] = waves[at]
            run.record[record_row[e], 1, column + here] = 2.0 * u - waves[at]
        back = 2.0 * u - waves[at]
        waves[at] = 0.0 if abs(back) < TINY else back
    if network.effort_row[node] >= 0:
        run.record[network.effort_row[node], :, column + here] = u
    return np.isfinite(u)


@unit_of_long_loops
def scatter_block(run: Run, chosen: int, k: int, begun: int, count: int, column: int) -> int:
    """Scatter the slabs of a block from slab k on, some of them already begun, at a group, or at FAR or NEAR ones.

    Returns -1, or the number of a node whose effort is no longer finite.
    """
    network, blocks, s = run.network, run.network.blocks, run.state.before.shape[1]
    groups = blocks.far_groups if chosen == FAR else blocks.near_groups
    for i in range(1 if chosen >= 0 else groups.size):
        g, ahead = chosen if chosen >= 0 else groups[i], np.int64(0)
        half = run.units.halves != 0 and run.network.diamonds.at_group[g]
        alone = half or run.network.laws.governed[g] or is_watched(run.network.laws, g)
        most = np.int64(1) if alone else run.work.tile
        if count == 1 and s == 1 and is_plain(run, g) and not half:
            if not scatter_one(run, network.group[g], k, begun, ahead, column):
                return network.group[g]
            continue
        while ahead < count:
            m = place_tile(run, g, begun, ahead, min(count - ahead, most))
            if half:
                node = invoke(run.units.halves, (run, g, (k + ahead) * s, column * s))
            else:
                node = scatter_group(run, g, (k + ahead) * s, m, column * s)
            if node >= 0:
                return node
            ahead += m
    return -1


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


@unit_of_long_loops
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
        for j in range(0, s - 1, 2):  # two points at once, with fewer loads and stores than one by one
            now, then, now_next, then_next = shift[0, i, j], shift[1, i, j], shift[0, i, j + 1], shift[1, i, j + 1]
            for k in range(m):
                here = now * history[j, k + 1] + then * history[j, k]
                row[k] += here + (now_next * history[j + 1, k + 1] + then_next * history[j + 1, k])
        if s % 2 == 1:
            now, then = shift[0, i, s - 1], shift[1, i, s - 1]
            for k in range(m):
                row[k] += now * history[s - 1, k + 1] + then * history[s - 1, k]
        for k in range(m):
            waves[place + np.uint64(k * s + i)] = row[k]
    return 0
