"""Cells of friction where some of their slabs are in pieces: these are parts of a wave like whole slabs."""

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, copy, project, series, times
from tline.solver.kernel.diamonds.cells import PARTS, as_one, find_change, pass_line, put_back, take_wave
from tline.solver.kernel.diamonds.full import flushed
from tline.solver.kernel.fronts.structures import FrontRun


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
