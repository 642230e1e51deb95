"""Diamonds of slabs in pieces: each piece of the one meets each of the other in a rectangle."""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, copy, project, times
from tline.solver.kernel.diamonds.full import flushed, meet_apart
from tline.solver.kernel.fronts.merge import release
from tline.solver.kernel.fronts.structures import MERGE, SCALE, FrontRun

WEAK = 8.0  # times the allowed size of a breakpoint: weaker fronts are left out of friction


@function
def take_up(fronts, row, wave, side):
    """Hold a slab by values at the points of pieces, as needed for friction. Returns the number of pieces.

    Pieces beside a weak front are one: each loses the polynomial that their projection loses, so no energy is made, and
    the front itself stays as it is.
    """
    pieces, tools, whole = fronts.pieces, fronts.tools, fronts.work.whole
    edges, values, n = fronts.work.pair_edges[side], fronts.work.pair[side], np.int64(0)
    if row < 0:
        edges[0], edges[1] = 0.0, 1.0
        copy(wave, values[0])
        return np.int64(1)
    weak = WEAK * fronts.same * fronts.sizes[SCALE]
    for j in range(pieces.number[row]):
        if j == 0 or pieces.size[row, j] > weak:
            edges[n], n = pieces.start[row, j], n + 1
    edges[n], j = 1.0, np.int64(0)
    for k in range(n):
        clear(whole)
        while j < pieces.number[row] and pieces.start[row, j] < edges[k + 1]:
            start, stop = pieces.start[row, j], pieces.start[row, j + 1]
            project(pieces.coef[row, j], start, stop, edges[k], edges[k + 1], tools.gauss, whole)
            j += 1
        times(tools.to_points, whole, 0, values[k])
        copy(values[k], fronts.work.pair[side + 2, k])
    return n


@function
def put_back(fronts, row, wave, side, n):
    """Write back the n pieces that friction has changed."""
    pieces, tools, whole, part = fronts.pieces, fronts.tools, fronts.work.whole, fronts.work.part
    edges, values, before, j = fronts.work.pair_edges[side], fronts.work.pair[side], fronts.work.pair[side + 2], 0
    if row < 0:
        for i in range(wave.size):
            wave[i] = flushed(values[0, i])
        return
    for k in range(n):
        for i in range(wave.size):
            before[k, i] = values[k, i] - before[k, i]
        times(tools.to_legendre, before[k], 0, whole)
        while j < pieces.number[row] and pieces.start[row, j] < edges[k + 1]:
            clear(part)
            start, stop = pieces.start[row, j], pieces.start[row, j + 1]
            project(whole, edges[k], edges[k + 1], start, stop, tools.gauss, part)
            for i in range(wave.size):
                pieces.coef[row, j, i] = flushed(pieces.coef[row, j, i] + part[i])
            j += 1


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
    put_back(fronts, row_a, a, 0, n)
    put_back(fronts, row_b, b, 1, m)
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
