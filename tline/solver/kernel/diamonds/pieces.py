"""Diamonds and cells of slabs in pieces: each piece of the one meets each of the other in a rectangle.

In cells of friction pieces are parts of a wave like whole slabs.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, copy, project, series, times
from tline.solver.kernel.diamonds.cells import as_one, find_change, pass_line, put_back, take_wave
from tline.solver.kernel.diamonds.full import flushed, meet_apart, pass_all
from tline.solver.kernel.fronts.gather import release
from tline.solver.kernel.fronts.structures import MERGE, FrontRun
from tline.solver.kernel.network import PARTS


@function
def take_pair(fronts, row, wave, side):
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
def put_pair(fronts, row, wave, side):
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
    n, m, zero = take_pair(fronts, row_a, a, 0), take_pair(fronts, row_b, b, 1), np.int64(0)
    for i in range(n):
        for j in range(m):
            x, y = wide * (edges[0, i + 1] - edges[0, i]), high * (edges[1, j + 1] - edges[1, j])
            done &= meet_apart(job.run, line, pair[0, i], zero, pair[1, j], zero, x, y)
    put_pair(fronts, row_a, a, 0)
    put_pair(fronts, row_b, b, 1)
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


@function
def pass_one_in_pieces(job, run, row, a, b):
    """Advance a row as `pass_one` does, where some slabs are in pieces."""
    waves, of_slab, s = run.state.waves, job.fronts.pieces.of_slab, run.state.before.shape[1]
    in_a, in_b = of_slab[a // s], of_slab[b // s]
    if in_a < 0 and in_b < 0:
        return meet_apart(run, row, waves, a, waves, b, 1.0, 1.0)
    return meet_in_pieces(job, row, in_a, waves[a : a + s], in_b, waves[b : b + s], 1.0, 1.0)


@unit
def pass_diamonds_in_pieces(job: FrontRun, count: int) -> int:
    """Advance all lines with losses as `pass_diamonds` does, where some slabs are in pieces."""
    return pass_all(job, job.run, pass_one_in_pieces)


@function
def pieces_of(job, o):
    """Row of the pieces of the slab at a place of the buffers, or -1, and their number."""
    pieces = job.fronts.pieces
    row = pieces.of_slab[o // job.fronts.tools.c.size]
    return row, pieces.number[row] if row >= 0 else 1


@function
def piece(job, o, row, j):
    """Beginning and end of a piece in its slab, with its coefficients in the workspace."""
    pieces, coef = job.fronts.pieces, job.fronts.work.part
    if row < 0:
        times(job.fronts.tools.to_legendre, job.run.state.waves, o, coef)
        return 0.0, 1.0
    copy(pieces.coef[row, j], coef)
    return pieces.start[row, j], pieces.start[row, j + 1]


@function
def divide_pieces(job, k, o, at, ring, side):
    """Find the jumps between the pieces of a cell of k slabs. Returns the number of parts."""
    diamonds, edges, coef = job.run.network.diamonds, job.run.work.diamonds.edges[side], job.fronts.work.part
    s, size, n, last = coef.size, 0.0, 1, 0.0
    for i in range(k):
        p = o + (at + i) % ring * s
        row, number = pieces_of(job, p)
        for j in range(number):
            piece(job, p, row, j)
            size = max(size, abs(series(coef, 1.0)))
    edges[0] = 0.0
    for i in range(k):
        p = o + (at + i) % ring * s
        row, number = pieces_of(job, p)
        for j in range(number):
            start, _ = piece(job, p, row, j)
            if i + j > 0 and n < PARTS and abs(series(coef, -1.0) - last) > diamonds.jump * size:
                edges[n] = i + start
                n += 1
            last = series(coef, 1.0)
    edges[n] = k
    return n


@function
def take_up_pieces(job, k, o, at, ring, side, n):
    """Project the pieces of a cell on one polynomial in each of n parts."""
    work, tools, coef = job.run.work.diamonds, job.fronts.tools, job.fronts.work.part
    for part in range(n):
        clear(work.parts[side + 2, part])
    part = 0
    for i in range(k):
        p = o + (at + i) % ring * coef.size
        row, number = pieces_of(job, p)
        for j in range(number):
            start, stop = piece(job, p, row, j)
            while part < n - 1 and work.edges[side, part + 1] <= i + start:
                part += 1
            low, high = work.edges[side, part], work.edges[side, part + 1]
            project(coef, i + start, i + stop, low, high, tools.gauss, work.parts[side + 2, part])
    for part in range(n):
        times(job.run.network.diamonds.tools.to_points, work.parts[side + 2, part], 0, work.parts[side, part])


@function
def put_back_pieces(job, k, o, at, ring, side, n):
    """Add the changes to the pieces of a cell."""
    pieces, waves, work, tools = job.fronts.pieces, job.run.state.waves, job.run.work.diamonds, job.fronts.tools
    coef, more, i, s = job.fronts.work.part, job.fronts.work.whole, 0, job.fronts.work.whole.size
    for part in range(n):
        find_change(job.run, side, part)
        low, high = work.edges[side, part], work.edges[side, part + 1]
        i = int(low)
        while i < high:
            p = o + (at + i) % ring * s
            row, number = pieces_of(job, p)
            for j in range(number):
                start, stop = piece(job, p, row, j)
                if low <= i + start < high:
                    clear(more)
                    project(work.a, low, high, i + start, i + stop, tools.gauss, more)
                    for x in range(s):
                        coef[x] = work.rest[0] * coef[x] + more[x]
                    if row >= 0:
                        for x in range(s):
                            pieces.coef[row, j, x] = flushed(coef[x])
                    else:
                        times(tools.to_points, coef, 0, more)
                        for x in range(s):
                            waves[p + x] = flushed(more[x])
            i += 1


@function
def take_wave_in_pieces(job, row, o, at, ring, side, whole):
    """Divide and project a wave in a cell. Returns whether slabs of it are in pieces, and the number of parts."""
    k, s = job.run.network.diamonds.cell[row], job.fronts.tools.c.size
    for i in range(k):
        if job.fronts.pieces.of_slab[o // s + (at + i) % ring] >= 0:
            n = as_one(job.run, row, side) if whole else divide_pieces(job, k, o, at, ring, side)
            take_up_pieces(job, k, o, at, ring, side, n)
            return True, n
    return take_wave(job.run, row, o, at, ring, side, whole)


@function
def put_wave_in_pieces(job, row, o, at, ring, side, in_pieces, n):
    """Add the changes to a wave in a cell."""
    if in_pieces:
        put_back_pieces(job, job.run.network.diamonds.cell[row], o, at, ring, side, n)
    else:
        put_back(job.run, row, o, at, ring, side, n)


@unit
def pass_cells_in_pieces(job: FrontRun, count: int) -> int:
    """Advance all lines with losses as `pass_cells` does, where some slabs are in pieces."""
    for row in range(job.run.network.diamonds.line.size):
        if not pass_line(job, job.run, row, count, take_wave_in_pieces, put_wave_in_pieces):
            return job.run.network.diamonds.line[row]
    return -1
