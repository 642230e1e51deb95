"""Polynomials of neighbouring slabs or pieces: their continuity, and polynomials shared by two."""

from typing import NamedTuple

from tline.compiled.structure import Flags, Floats, Floats2, Floats3
from tline.compiled.unit import function, unit

EXPECTED = 4.0  # largest mismatch of a start, over the change of the highest coefficient
FALLS = 0.1  # largest change by a shared polynomial, over that by the start
FIRST = 10.0  # largest change by a shared polynomial in a cell without a start
UNEQUAL = 16.0  # widths of neighbours beyond this ratio are not compared
VALUE_ROUNDING = 4e-15  # of the largest value


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
