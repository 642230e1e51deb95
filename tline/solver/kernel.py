"""The wave kernel: lines carry waves, nodes scatter them. It knows arrays and nothing else.

Symbols: w wave that arrives at an end, u effort of a node, 2u - w wave that leaves; s points per slab, x load state.
Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once; where a line's slot wraps, or the scratch is full, the block is cut into tiles that are contiguous in memory.

Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise. Helpers are inlined as source: as calls they would count references to their arrays at every tile,
which costs up to five times the arithmetic.
"""

import numpy as np
from numba import njit, uint64

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway
SCRATCH = 512  # samples per tile
OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}


@njit(inline="always", **OPTIONS)
def begin(u, n, drive, row, start):
    """Start the node's Thévenin wave with the sources' part."""
    if row < 0:
        for i in range(n):
            u[i] = 0.0
    else:
        for i in range(n):
            u[i] = drive[row, start + i]


@njit(inline="always", **OPTIONS)
def gather(u, n, waves, o, share):
    """Add an end's share of its arriving wave."""
    for i in range(n):
        u[i] += share * waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def scatter(u, n, waves, o):
    """Send back from an end what the node's effort leaves of the arriving wave."""
    for i in range(n):
        back = 2.0 * u[i] - waves[o + uint64(i)]
        waves[o + uint64(i)] = 0.0 if abs(back) < TINY else back


@njit(inline="always", **OPTIONS)
def note(u, n, waves, o, record, row, column):
    """Keep the waves that arrive at an end and leave it."""
    for i in range(n):
        record[row, 0, column + i] = waves[o + uint64(i)]
        record[row, 1, column + i] = 2.0 * u[i] - waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def shift(waves, o, m, before, end, shifts, r, history, row):
    """Apply the fractional rest of a delay to m arriving slabs, in place."""
    s = before.shape[1]
    for j in range(s):
        history[j, 0] = before[end, j]
        for k in range(m):
            history[j, k + 1] = waves[o + uint64(k * s + j)]
        before[end, j] = history[j, m]
    for i in range(s):
        for k in range(m):
            row[k] = 0.0
        for j in range(s):
            now, then = shifts[r, 0, i, j], shifts[r, 1, i, j]
            for k in range(m):
                row[k] += now * history[j, k + 1] + then * history[j, k]
        for k in range(m):
            waves[o + uint64(k * s + i)] = row[k]


@njit(inline="always", **OPTIONS)
def load(u, m, s, steps, r, states, x, row):
    """Turn the Thévenin wave of m slabs into the node's effort, through the load's state."""
    n = states.shape[1]
    for k in range(m):
        for i in range(s + n):
            total = 0.0
            for j in range(s):
                total += steps[r, i, j] * u[k * s + j]
            for j in range(n):
                total += steps[r, i, s + j] * states[x, j]
            row[i] = total
        for i in range(s):
            u[k * s + i] = row[i]
        for j in range(n):
            states[x, j] = 0.0 if abs(row[s + j]) < TINY else row[s + j]


@njit(**OPTIONS)
def advance(network, state, n_slabs, drive, record, column):
    """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

    Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
    under way is not.
    """
    (delay, offset, shift_row, shifts, first, ends, weight, drive_row, load_row, step_row, steps, record_row) = network
    waves, slots, sides, before, states = state
    s = before.shape[1]
    tile = max(SCRATCH // s, 1)
    u, scratch, history = np.empty(tile * s), np.empty(max(tile, steps.shape[1])), np.empty((s, tile + 1))
    position = np.empty(ends.size, np.uint64)
    shortest, done = n_slabs, 0
    for line in range(delay.size):
        shortest = min(shortest, delay[line])
    while done < n_slabs:
        block = min(shortest, n_slabs - done)
        for node in range(first.size - 1):
            low, high, ahead = first[node], first[node + 1], 0
            while ahead < block:
                m = min(block - ahead, tile)
                for e in range(low, high):
                    line = ends[e] >> 1
                    slot, side = slots[line] + ahead, sides[line] ^ (ends[e] & 1)
                    if slot >= delay[line]:
                        slot, side = slot - delay[line], 1 - side
                    m = min(m, delay[line] - slot)
                    position[e] = offset[line] + (side * delay[line] + slot) * s
                here = (done + ahead) * s
                begin(u, m * s, drive, drive_row[node], here)
                for e in range(low, high):
                    row = shift_row[ends[e] >> 1]
                    if row >= 0:
                        shift(waves, position[e], m, before, ends[e], shifts, row, history, scratch)
                    gather(u, m * s, waves, position[e], weight[e])
                if load_row[node] >= 0:
                    load(u, m, s, steps, step_row[node], states, load_row[node], scratch)
                for e in range(low, high):
                    if record_row[ends[e]] >= 0:
                        note(u, m * s, waves, position[e], record, record_row[ends[e]], column * s + here)
                    scatter(u, m * s, waves, position[e])
                if not np.isfinite(u[m * s - 1]):
                    return node
                ahead += m
        for line in range(delay.size):
            slots[line] += block
            if slots[line] >= delay[line]:
                slots[line] -= delay[line]
                sides[line] = 1 - sides[line]
        done += block
    for w in waves:
        if not np.isfinite(w):
            return first.size - 1
    return -1
