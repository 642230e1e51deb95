"""Extremes of finished waves, differences of two runs, and polynomials that neighbours share."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Flags, Floats, Floats2, Floats3
from tline.compiled.unit import function, unit, unit_of_long_loops
from tline.solver.kernel.arithmetic import ROUNDED, clear

BLOCK = 128  # slabs compared side by side
EXPECTED = 4.0  # largest mismatch of a start, over the change of the highest coefficient
FALLS = 0.1  # largest change by a shared polynomial, over that by the start
FIRST = 10.0  # largest change by a shared polynomial in a cell without a start
UNEQUAL = 16.0  # widths of neighbours beyond this ratio are not compared
VALUE_ROUNDING = 4e-15  # of the largest value
NEWTON = 3  # steps from the best point of a slab to the extreme of its polynomial
TIE = 1e-9  # relative difference below which extremes are the same: the first counts


class Compared(NamedTuple):
    """Waves a and b of two runs, matrices to their values at the same P places, and a workspace."""

    coarse_a: Floats2  # (n, s)
    coarse_b: Floats2
    fine_a: Floats2  # (n m, s) m fine slabs to a coarse one
    fine_b: Floats2
    in_coarse: Floats3  # (m, P, s) from the points of a coarse slab to the places of each fine one, the last its end
    in_fine: Floats2  # (P, s)
    twice: float  # the weight of the liquid, by which an effort exceeds a gauge pressure
    theirs: Floats3  # (2, s, BLOCK) at the points of a block of slabs
    ours: Floats3
    seen: Floats2  # (4, BLOCK) at a place
    most: Floats2  # (6, BLOCK) differences at ends, differences inside, values: of twice effort, of twice z0 times flow


@function
def transpose(wave, first, step, n, out):
    """Transpose the points of every `step`-th slab: one row a point."""
    for j in range(wave.shape[1]):
        for i in range(n):
            out[j, i] = wave[first + i * step, j]


@function
def evaluate(points, weights, out):
    """Evaluate polynomials at a place."""
    clear(out)
    for j in range(len(weights)):
        weight, row = weights[j], points[j]
        for i in range(len(out)):
            out[i] += weight * row[i]


@function
def raise_to(sums, differences, one, other, less):
    """Raise the largest values to the sum and the difference of two waves."""
    for i in range(len(one)):
        u, y = abs(one[i] + other[i] - less), abs(one[i] - other[i])
        sums[i], differences[i] = u if u > sums[i] else sums[i], y if y > differences[i] else differences[i]


@unit_of_long_loops
def find_difference(work: Compared) -> int:
    """Find the largest differences and values."""
    m, places, slabs, most = len(work.in_coarse), len(work.in_fine), len(work.coarse_a), work.most
    for first in range(0, slabs, BLOCK):
        n = min(BLOCK, slabs - first)
        a, b, apart_a, apart_b = work.seen[0, :n], work.seen[1, :n], work.seen[2, :n], work.seen[3, :n]
        transpose(work.coarse_a, first, 1, n, work.theirs[0])
        transpose(work.coarse_b, first, 1, n, work.theirs[1])
        for r in range(m):
            transpose(work.fine_a, first * m + r, m, n, work.ours[0])
            transpose(work.fine_b, first * m + r, m, n, work.ours[1])
            for p in range(places):
                evaluate(work.ours[0], work.in_fine[p], a)
                evaluate(work.ours[1], work.in_fine[p], b)
                evaluate(work.theirs[0], work.in_coarse[r, p], apart_a)
                evaluate(work.theirs[1], work.in_coarse[r, p], apart_b)
                raise_to(most[4], most[5], a, b, work.twice)
                for i in range(n):
                    apart_a[i], apart_b[i] = a[i] - apart_a[i], b[i] - apart_b[i]
                if p < places - 1:
                    raise_to(most[2], most[3], apart_a, apart_b, 0.0)
                elif r == m - 1:
                    raise_to(most[0], most[1], apart_a, apart_b, 0.0)
    return 0


class Joined(NamedTuple):
    """Polynomials of order s of W waves at an end of a line, in order of time, and the improved ones."""

    s: int
    width: Floats  # (cells,) slabs
    waves: Floats2  # (W, cells * s + 1) value before the first, and at the Radau points of each
    told: Floats3  # (W, cells, 2) highest Legendre coefficient, and the value at the start
    start: Floats  # (p,) the polynomial that is 1 at the start and vanishes at the points of order s
    values: Floats3  # (W, cells, p) of the improved polynomials
    bend: Floats  # (cells,) change of the highest coefficient
    off: Floats  # (cells,) mismatch of the start of each cell
    joined: Flags  # (cells,) whether it goes on where the one before it ends


class Shared(NamedTuple):
    """Polynomials that are shared by some pairs of cells, one after the other."""

    cells: Joined
    first: int  # cell of the first pair
    values: Floats3  # (W, pairs, 2 p) at the points of both cells
    change: Floats2  # (W, p) of the next cell by the last pair
    changes: Flags  # (1,) whether there is one


@function
def ratio_of(width, k):
    """Width of a cell over that of the one before."""
    return width[k] / width[k - 1] if k > 0 else 1.0


@function
def bend_of(at, k):
    """Change of the highest coefficient since the cell before; that itself if their widths are too unequal."""
    waves, s = len(at.told), at.s
    ratio, most = ratio_of(at.width, k), 0.0
    scale = ratio ** (s - 1) if 1.0 / UNEQUAL < ratio < UNEQUAL else 1.0
    for wave in range(waves):
        before = at.told[wave, k - 1, 0] if k > 0 else 0.0
        most = max(most, abs(at.told[wave, k, 0] - scale * before))
    return most


@function
def about(sizes, k):
    """A size, or the smaller one of its neighbours: one alone may vanish by chance."""
    if k == 0 or k == sizes.size - 1:
        return sizes[k]
    return max(sizes[k], min(sizes[k - 1], sizes[k + 1]))


@unit
def join(at: Joined) -> int:
    """Move the begin of each cell to the end of the one before, if it goes on there. Returns whether any changes.

    The error of one wave may come from the other, so the expected error is that of both together; behind a far narrower
    cell, that of the edge after it.
    """
    waves, cells, p = at.values.shape
    s, largest, worst = at.s, 0.0, 0.0
    for k in range(cells):
        at.bend[k] = bend_of(at, k)
        for wave in range(waves):
            largest = max(largest, abs(at.waves[wave, (k + 1) * s]))
    for k in range(cells):
        if not 1.0 / UNEQUAL < ratio_of(at.width, k) < UNEQUAL:
            at.bend[k] = at.bend[k + 1] if k < cells - 1 else 0.0
    for k in range(cells):
        off = 0.0
        for wave in range(waves):
            off = max(off, abs(at.told[wave, k, 1] - at.waves[wave, k * s]))
        expected = max(EXPECTED / (2 * s - 1) * about(at.bend, k), VALUE_ROUNDING * largest)
        at.joined[k] = ratio_of(at.width, k) > 1.0 / UNEQUAL and off <= expected
        at.off[k] = off if at.joined[k] else 0.0
        worst = max(worst, at.off[k])
        if at.joined[k]:
            for wave in range(waves):
                off = at.told[wave, k, 1] - at.waves[wave, k * s]
                for i in range(p):
                    at.values[wave, k, i] -= off * at.start[i]
    for wave in range(waves):
        largest = max(largest, abs(at.waves[wave, 0]))
    return 1 if worst > VALUE_ROUNDING * largest else 0


@function
def fits(at, pair):
    """Whether cells share a polynomial that changes neither of them, in any wave, by more than is expected.

    Errors of the waves may cancel in effort or flow, so all are changed or none.
    """
    cells, k = at.cells, at.first + pair
    s, points, most = cells.s, cells.start.size, about(cells.off, k + 1)
    ratio, known = ratio_of(cells.width, k + 1), cells.joined[k]
    if not cells.joined[k + 1] or ratio >= UNEQUAL or most == 0.0 or (known and s == 2):
        return False
    for side in range(2):
        limit = (FALLS if known or side == 1 else FIRST) * most
        for wave in range(len(cells.values)):
            for i in range(points):
                if not abs(at.values[wave, pair, side * points + i] - cells.values[wave, k + side, i]) <= limit:
                    return False
    return True


@unit
def share(at: Shared) -> int:
    """Change the values of cells to those that they share with one neighbour, or the mean of those with both."""
    values, change, points = at.cells.values, at.change, at.cells.start.size
    for pair in range(at.values.shape[1]):
        k, fit = at.first + pair, fits(at, pair)
        count = at.changes[0] + fit
        for wave in range(len(values) if count > 0 else 0):
            for i in range(points):
                total = change[wave, i] if at.changes[0] else 0.0
                if fit:
                    total += at.values[wave, pair, i] - values[wave, k, i]
                    change[wave, i] = at.values[wave, pair, points + i] - values[wave, k + 1, i]
                values[wave, k, i] += total / count
                if fit and k + 2 == at.cells.width.size:
                    values[wave, k + 1, i] += change[wave, i]
        at.changes[0] = fit
    return 0


class ExtremesOfCopies(NamedTuple):
    """Search of the extremes until t_end of a wave in B copies, in periods of K slabs of s points, zero at t = 0."""

    wave: Floats3  # (n K, s, B)
    period: Floats  # (B,) in s
    edges: Floats2  # (K + 1, B) of the slabs, as shares of a period
    t_end: float
    points: Floats  # (s,) of a slab
    to_powers: Floats2  # (s, s) from values there to coefficients of powers of 2 x - 1
    found: Floats2  # (4, B) smallest value, when, largest, when
    top: Floats3  # (2, n K, B) largest of minus the wave and of the wave at the start and the points of each slab
    coef: Floats  # (s,)
    begin: Floats  # (s,) from values at the points to that at the begin of a slab


def extremes(
    wave: Floats3, period: Floats, edges: Floats2, t_end: float, points: Floats, to_powers: Floats2, found: Floats2
) -> ExtremesOfCopies:
    """The search for a wave's extremes, with its workspace."""
    top = np.empty((2, len(wave), wave.shape[2]))
    begin = (-1.0) ** np.arange(len(points)) @ to_powers
    return ExtremesOfCopies(wave, period, edges, t_end, points, to_powers, found, top, np.empty(len(points)), begin)


@unit_of_long_loops
def find_extremes(search: ExtremesOfCopies) -> int:
    """Find the extremes in all copies.

    Slabs are searched whose points come near enough to the best: within twice the rise between points of a parabola
    with the bend of the first peak, and within the range of the slab's own points.
    """
    wave, edges, points, top, found = search.wave, search.edges, search.points, search.top, search.found
    slabs, s, copies = wave.shape
    parts, gap = edges.shape[0] - 1, points[0]
    for j in range(1, s):
        gap = max(gap, points[j] - points[j - 1])
    for slab in range(slabs):
        note_tops(wave[slab], search.begin, top[0, slab], top[1, slab])
    for c in range(copies):
        end = search.t_end / search.period[c]
        whole = min(int(end) * parts, slabs)  # slabs that end until then
        while whole < slabs and edges[whole % parts + 1, c] <= end - int(end):
            whole += 1
        for side in range(2):
            sign, first = 2.0 * side - 1.0, 0
            for slab in range(1, whole):
                if top[side, slab, c] > top[side, first, c]:
                    first = slab
            best, best_at, margin, at = 0.0, 0.0, 0.0, -1
            for k in range(-1, min(whole + 1, slabs)):
                slab = first if k < 0 else k
                reach = top[side, slab, c] + min(margin, top[0, slab, c] + top[1, slab, c])
                if k == first or (k >= 0 and reach <= (1.0 + ROUNDED if slab > at else 1.0 - TIE) * best):
                    continue
                begin = edges[slab % parts, c]
                width = edges[slab % parts + 1, c] - begin
                furthest = 1.0 if slab < whole else (end - int(end) - begin) / width
                value, x, bend = peak(wave[slab], c, sign, furthest, points, search.to_powers, search.coef)
                if k < 0:
                    margin = bend * gap**2 / 4.0
                if value > (1.0 + TIE) * best or (slab < at and value >= (1.0 - TIE) * best):
                    best_at, at = (slab // parts + begin + x * width) * search.period[c], slab
                best = max(best, value)
            found[2 * side, c], found[2 * side + 1, c] = sign * best, best_at
    return 0


@function
def note_tops(wave, begin, lowest, highest):
    """Largest value of -wave and of wave (s, B) at the begin of a slab and at its points, for all copies."""
    s, copies = wave.shape
    for c in range(copies):
        lowest[c] = 0.0
    for j in range(s):
        for c in range(copies):
            lowest[c] -= begin[j] * wave[j, c]
    for c in range(copies):
        highest[c] = -lowest[c]
    for j in range(s):
        for c in range(copies):
            lowest[c] = max(lowest[c], -wave[j, c])
            highest[c] = max(highest[c], wave[j, c])


@function
def peak(wave, c, sign, furthest, points, to_powers, coef):
    """Largest value of sign times a copy's polynomial from 0 to `furthest`, where, and how much it bends there.

    Newton's method goes there from the best of its begin, its points, and the end.
    """
    x, best = furthest, -np.inf
    fill(wave, c, sign, to_powers, coef)
    for j in range(-1, points.size):
        place = 0.0 if j < 0 else points[j]
        value = sign * wave[j, c] if j >= 0 else powers(coef, -1.0)[0]
        if place <= furthest and value > best:
            best, x = value, place
    if furthest < 1.0:
        value = powers(coef, 2.0 * furthest - 1.0)[0]
        if value > best:
            best, x = value, furthest
    at, bend = x, 0.0
    for step in range(NEWTON + 1):
        value, slope, bend = powers(coef, 2.0 * x - 1.0)
        if value > best:
            best, at = value, x
        if step < NEWTON and bend < 0.0:
            x = min(max(x - 0.5 * slope / bend, 0.0), furthest)
    return best, at, 4.0 * abs(bend)


@function
def fill(wave, c, sign, to_powers, coef):
    """Coefficients of a copy's polynomial in a slab, times a sign."""
    for k in range(coef.size):
        total = 0.0
        for j in range(coef.size):
            total += to_powers[k, j] * wave[j, c]
        coef[k] = sign * total


@function
def powers(coef, z):
    """A polynomial at z, its slope, and its second derivative."""
    value, slope, bend = 0.0, 0.0, 0.0
    for k in range(coef.size - 1, -1, -1):
        bend = bend * z + 2.0 * slope
        slope = slope * z + value
        value = value * z + coef[k]
    return value, slope, bend
