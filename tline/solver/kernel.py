"""The wave kernel: lines carry waves, nodes scatter them. It knows arrays and nothing else.

Symbols: w wave that arrives at an end, u effort of a node, 2u - w wave that leaves; s points per slab, x load state.
Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once; where a line's slot wraps, or the scratch is full, the block is cut into tiles that are contiguous in memory.

Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise. Arrays are indexed whole: a slice costs a reference count per tile.
"""

import numpy as np
from numba import njit, uint64

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway
SCRATCH = 512  # samples per tile
OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}


@njit(inline="always", **OPTIONS)
def locate(network, state, node, ahead, m, position):
    """Find where each end's due slabs lie in the buffers; returns how many of m slabs lie together at all ends."""
    s = state.before.shape[1]
    for e in range(network.first[node], network.first[node + 1]):
        line = network.ends[e] >> 1
        delay, slot, side = (
            network.delay[line],
            state.slot[line] + ahead,
            state.side[line] ^ (network.ends[e] & 1),
        )
        if slot >= delay:
            slot, side = slot - delay, 1 - side
        m = min(m, delay - slot)
        position[e] = network.offset[line] + (side * delay + slot) * s
    return m


@njit(inline="always", **OPTIONS)
def thevenin(network, state, node, m, drive, here, position, u, row, history):
    """Gather the node's Thévenin wave: the sources' part and a share of each arriving wave."""
    samples = m * state.before.shape[1]
    source, start = network.drive_row[node], here * state.before.shape[1]
    for i in range(samples):
        u[i] = drive[source, start + i] if source >= 0 else 0.0
    for e in range(network.first[node], network.first[node + 1]):
        if network.shift_row[network.ends[e] >> 1] >= 0:
            shift(network, state, network.ends[e], m, position[e], row, history)
        share, o = network.weight[e], position[e]
        for i in range(samples):
            u[i] += share * state.waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def shift(network, state, end, m, o, row, history):
    """Apply the fractional rest of a delay to m arriving slabs, in place."""
    s = state.before.shape[1]
    r = network.shift_row[end >> 1]
    for j in range(s):
        history[j, 0] = state.before[end, j]
        for k in range(m):
            history[j, k + 1] = state.waves[o + uint64(k * s + j)]
        state.before[end, j] = history[j, m]
    for i in range(s):
        for k in range(m):
            row[k] = 0.0
        for j in range(s):
            now, before = network.shift[r, 0, i, j], network.shift[r, 1, i, j]
            for k in range(m):
                row[k] += now * history[j, k + 1] + before * history[j, k]
        for k in range(m):
            state.waves[o + uint64(k * s + i)] = row[k]


@njit(inline="always", **OPTIONS)
def load(network, state, node, m, u, row):
    """Turn the Thévenin wave of m slabs into the node's effort, through the load's state."""
    s, n = state.before.shape[1], state.load.shape[1]
    x, step = network.load_row[node], network.step_row[node]
    for k in range(m):
        for i in range(s + n):
            total = 0.0
            for j in range(s):
                total += network.step[step, i, j] * u[k * s + j]
            for j in range(n):
                total += network.step[step, i, s + j] * state.load[x, j]
            row[i] = total
        for i in range(s):
            u[k * s + i] = row[i]
        for j in range(n):
            state.load[x, j] = row[s + j] if abs(row[s + j]) > TINY else 0.0


@njit(inline="always", **OPTIONS)
def scatter(network, state, node, m, u, position, record, column):
    """Send back from each end what the node's effort leaves of the arriving wave; record both where asked."""
    s = state.before.shape[1]
    for e in range(network.first[node], network.first[node + 1]):
        o, r = position[e], network.record_row[network.ends[e]]
        if r >= 0:
            for i in range(m * s):
                w = state.waves[o + uint64(i)]
                record[r, 0, column * s + i] = w
                record[r, 1, column * s + i] = 2.0 * u[i] - w
        for i in range(m * s):
            back = 2.0 * u[i] - state.waves[o + uint64(i)]
            state.waves[o + uint64(i)] = back if abs(back) > TINY else 0.0


@njit(**OPTIONS)
def advance(network, state, n_slabs, drive, record, column):
    """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

    Returns -1, or the number of a node whose effort is no longer finite.
    """
    s = state.before.shape[1]
    tile = max(SCRATCH // s, 1)
    u, row, history = np.empty(tile * s), np.empty(max(tile, network.step.shape[1])), np.empty((s, tile + 1))
    position = np.empty(network.ends.size, np.uint64)
    shortest = network.delay.min()
    done = 0
    while done < n_slabs:
        block = min(shortest, n_slabs - done)
        for node in range(network.first.size - 1):
            ahead = 0
            while ahead < block:
                m = locate(network, state, node, ahead, min(block - ahead, tile), position)
                here = done + ahead
                thevenin(network, state, node, m, drive, here, position, u, row, history)
                if network.load_row[node] >= 0:
                    load(network, state, node, m, u, row)
                scatter(network, state, node, m, u, position, record, column + here)
                if not np.isfinite(u[m * s - 1]):
                    return node
                ahead += m
        for line in range(network.delay.size):
            state.slot[line] += block
            if state.slot[line] >= network.delay[line]:
                state.slot[line] -= network.delay[line]
                state.side[line] = 1 - state.side[line]
        done += block
    return -1
