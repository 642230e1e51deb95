"""Diamonds of slabs in pieces: each piece of the one meets each of the other in a rectangle."""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, copy, project, times
from tline.solver.kernel.diamonds.full import meet_apart
from tline.solver.kernel.fronts.merge import release
from tline.solver.kernel.fronts.structures import MERGE, FrontRun


@function
def take_up(fronts, row, wave, side):
    """Hold a slab by values at the points of its pieces, as needed for friction. Returns the number of pieces."""
    pieces, edges, values = fronts.pieces, fronts.work.pair_edges[side], fronts.work.pair[side]
    if row < 0:
        edges[0], edges[1] = 0.0, 1.0
        copy(wave, values[0])
        return np.int64(1)
    for j in range(pieces.number[row]):
        edges[j] = pieces.start[row, j]
        times(fronts.tools.to_points, pieces.coef[row, j], 0, values[j])
    edges[pieces.number[row]] = 1.0
    return pieces.number[row]


@function
def put_back(fronts, row, wave, side):
    """Write back the pieces that friction has changed."""
    pieces, values = fronts.pieces, fronts.work.pair[side]
    if row < 0:
        copy(values[0], wave)
        return
    for j in range(pieces.number[row]):
        times(fronts.tools.to_legendre, values[j], 0, pieces.coef[row, j])


@function
def meet_in_pieces(job, line, row_a, a, row_b, b, wide, high):
    """Advance a slab of a past one of b, or parts of slabs `wide` and `high`, in pieces or not, as `meet` does."""
    fronts, done = job.fronts, True
    pair, edges = fronts.work.pair, fronts.work.pair_edges
    n, m, zero = take_up(fronts, row_a, a, 0), take_up(fronts, row_b, b, 1), np.int64(0)
    for i in range(n):
        for j in range(m):
            x, y = wide * (edges[0, i + 1] - edges[0, i]), high * (edges[1, j + 1] - edges[1, j])
            done &= meet_apart(job.run, line, pair[0, i], zero, pair[1, j], zero, x, y)
    put_back(fronts, row_a, a, 0)
    put_back(fronts, row_b, b, 1)
    return done


@function
def cut_tail(job, e):
    """Keep the rest of a slab that is yet to arrive at an end, in place of the slab."""
    fronts, network, before = job.fronts, job.run.network, job.run.state.before
    pieces, tools, whole = fronts.pieces, fronts.tools, fronts.work.whole
    row, f, n, anew = pieces.before[e], fronts.rest[e >> 1], np.int64(0), 0.0
    if row < 0:
        times(network.diamonds.ends[network.shift_row[e >> 1], 1], before[e], 0, whole)
        copy(whole, before[e])
        return
    for j in range(pieces.number[row]):
        start, stop, size = pieces.start[row, j], pieces.start[row, j + 1], pieces.size[row, j]
        low = max(start, 1.0 - f)
        if stop - low > MERGE:
            if j > 0 and n == 0 and start > low - MERGE:
                anew = size
            clear(whole)
            project(pieces.coef[row, j], start, stop, low, stop, tools.gauss, whole)
            copy(whole, pieces.coef[row, n])
            pieces.start[row, n], pieces.size[row, n] = (low - 1.0 + f) / f if n > 0 else 0.0, size
            n += 1
    pieces.start[row, n], pieces.number[row], pieces.anew[row] = 1.0, n, anew
    if n == 1 and anew == 0.0:
        times(tools.to_points, pieces.coef[row, 0], 0, before[e])
        release(pieces, row, fronts.counts)
        pieces.before[e] = -1


@unit
def pass_diamonds_in_pieces(job: FrontRun, count: int) -> int:
    """Advance all lines with losses as `pass_diamonds` does, where some slabs are in pieces."""
    run, pieces = job.run, job.fronts.pieces
    network, state, diamonds = run.network, run.state, run.network.diamonds
    waves, s = state.waves, state.before.shape[1]
    for row in range(diamonds.line.size):
        line = diamonds.line[row]
        D, o = network.delay[line], network.offset[line]
        t = state.side[line] * D + state.slot[line] - 1
        for later in range(2):
            for k in range(1 - later, D):
                a, b = t - k, t + k + later
                a, b = o + s * (a + 2 * D if a < 0 else a), o + s * (b - 2 * D if b >= 2 * D else b)
                in_a, in_b = pieces.of_slab[a // s], pieces.of_slab[b // s]
                if in_a < 0 and in_b < 0:
                    done = meet_apart(run, row, waves, a, waves, b, 1.0, 1.0)
                else:
                    done = meet_in_pieces(job, row, in_a, waves[a : a + s], in_b, waves[b : b + s], 1.0, 1.0)
                if not done:
                    return line
    return -1
