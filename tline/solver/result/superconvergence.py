"""Waves between slab ends as accurate as nearly at these, from what of a run is superconvergent.

At the end of a slab, and in its low moments, a wave is far more accurate than anywhere inside. Between two fronts three
polynomials are at hand for a slab, each with its own end and moments:

- its own, of degree s - 1;
- one degree higher, with the end of the slab before as its start: order s + 1;
- of degree 2s - 2, shared with a neighbour, through the ends of both: order s + 2 at least.

Each is taken as long as it fits what the one before it lets expect: a start that is off by no more than the highest
coefficients change from slab to slab, and a shared polynomial that changes less than the start did. A front at a slab's
edge fits neither; there the polynomial of the slabs behind it has no start.

References
----------
B. Cockburn, M. Luskin, C.-W. Shu, E. Süli: Enhanced accuracy by post-processing for finite element methods for
hyperbolic equations, Math. Comp. 72 (2003), doi:10.1090/S0025-5718-02-01464-3.
"""

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import basis, gauss

if TYPE_CHECKING:
    from tline.solver.result.result import Wave

SHARED = 8  # order up to which polynomials are shared; beyond, rounding is all that is left
EXPECTED = 4.0  # times what the change of the highest coefficient lets expect, that a start may be off
FALLS = 0.1  # of a change of the start, that a shared polynomial may change at most
FIRST = 10.0  # the same in a slab without a start
UNEQUAL = 16.0  # widths of neighbours beyond this ratio are not compared
ROUNDING = 1e-15  # of the largest value


class Cells(NamedTuple):
    """Polynomials of the two waves at an end of a line, in order of time."""

    width: NDArray  # (cells,) slabs
    values: NDArray  # (2, cells, s) at the Radau points of each
    before: NDArray  # (2,) what was constant before the first


def degree(s: int) -> int:
    """Degree of the polynomials that are made of those of order s."""
    return s - 1 if s == 1 else (2 * s - 2 if s <= SHARED else s)


def superconvergent(a: "Wave", b: "Wave") -> "tuple[Wave, Wave]":
    """The two waves at an end of a line, of higher degree."""
    s, n, pieces = a.basis.s, len(a.values), a.pieces
    values, width, order = np.stack([a.values, b.values]), np.ones(n), np.arange(n)
    if len(pieces.slab):
        whole = np.setdiff1d(order, pieces.slab, assume_unique=False)
        order = np.argsort(np.concatenate([whole, pieces.slab + pieces.span[:, 0]]), kind="stable")
        width = np.concatenate([np.ones(len(whole)), np.diff(pieces.span, axis=1)[:, 0]])[order]
        in_pieces = np.stack([a.pieces.values, b.pieces.values])
        values = np.concatenate([values[:, whole], in_pieces], axis=1)[:, order]
    found = improved(Cells(width, values, np.array([a.before, b.before])))
    new = basis(found.shape[2])
    if not len(pieces.slab):
        return replace(a, values=found[0], basis=new), replace(b, values=found[1], basis=new)
    back = np.empty_like(found)
    back[:, order] = found
    spread = basis(s).evaluation(new.c)
    made = []
    for wave, each in zip((a, b), back, strict=True):
        held = wave.values @ spread.T
        held[whole] = each[: len(whole)]
        made.append(replace(wave, values=held, basis=new, pieces=pieces._replace(values=each[len(whole) :])))
    return made[0], made[1]


def improved(cells: Cells) -> NDArray:
    """Values at the Radau points of order ``degree(s) + 1``, shape (2, cells, degree + 1)."""
    s = cells.values.shape[2]
    order, fine = basis(s), basis(degree(s) + 1)
    values = cells.values @ order.evaluation(fine.c).T
    if s == 1:
        return values
    ends = np.concatenate([cells.before[:, None], cells.values[:, :, -1]], axis=1)
    off = cells.values @ order.evaluation([0.0])[0] - ends[:, :-1]
    joined = _joined(cells, off)
    off = np.where(joined, off, 0.0)
    values -= off[:, :, None] * _start(s)
    if s <= SHARED and values.shape[1] > 1:
        _share(cells, values, ends, np.abs(off).max(axis=0), joined)
    return values


def _joined(cells: Cells, off: NDArray) -> NDArray:
    """Whether each cell goes on where the one before it ends.

    The error of one wave may come from the other, so both together tell what is to be expected; behind a far narrower
    cell, the edge after it.
    """
    s = cells.values.shape[2]
    highest = np.pad(cells.values @ basis(s).to_legendre[-1], ((0, 0), (1, 0)))
    ratio = _ratio(cells)
    near = (ratio < UNEQUAL) & (ratio > 1 / UNEQUAL)
    bend = np.abs(highest[:, 1:] - highest[:, :-1] * np.where(near, ratio, 1.0) ** (s - 1)).max(axis=0)
    bend = np.where(near, bend, np.append(bend[1:], 0.0))
    least = ROUNDING * np.abs(cells.values[:, :, -1]).max()
    expected = np.maximum(EXPECTED / (2 * s - 1) * _about(bend), least)
    return (ratio > 1 / UNEQUAL) & (np.abs(off).max(axis=0) <= expected)


def _ratio(cells: Cells) -> NDArray:
    """Width of each cell over that of the one before."""
    return cells.width / np.append(cells.width[0], cells.width[:-1])


def _about(sizes: NDArray) -> NDArray:
    """Each, or the smaller one of its neighbours: one alone may vanish by chance."""
    more = np.pad(sizes, 1)
    return np.maximum(sizes, np.minimum(more[2:], more[:-2]))


def _share(cells: Cells, values: NDArray, ends: NDArray, off: NDArray, joined: NDArray) -> None:
    """Replace polynomials by those shared with one neighbour, or by the mean of those shared with both.

    Errors of the two waves may cancel in effort or flow, so both are replaced or none.
    """
    s = cells.values.shape[2]
    total, count, off = np.zeros_like(values), np.zeros(values.shape[1]), _about(off)
    pairs = np.flatnonzero(joined[1:] & (_ratio(cells)[1:] < UNEQUAL))
    for known in (True, False):
        here = pairs[joined[pairs] == known]
        if not len(here) or (known and s == 2):
            continue
        change = [_shared(cells, ends, here, known, k) - values[:, here + k] for k in (0, 1)]
        before, after = (np.abs(each).max(axis=(0, 2)) for each in change)
        expected = off[here + 1]
        fits = (after <= FALLS * expected) & (before <= (FALLS if known else FIRST) * expected)
        for k in (0, 1):
            total[:, here + k] += change[k] * fits[:, None]
            count[here + k] += fits
    values += total / np.maximum(count, 1)[:, None]


def _shared(cells: Cells, ends: NDArray, first: NDArray, known: bool, which: int) -> NDArray:
    """Values that the polynomials shared by cells and the next ones have at the points of one or the other."""
    s = cells.values.shape[2]
    legendre = basis(s).to_legendre
    q = _moments(s, known)
    data = [cells.values[:, first + k] @ legendre[: q[k]].T for k in (0, 1)]
    data += [ends[:, first + k, None] for k in ((0, 1, 2) if known else (1, 2))]
    given = np.concatenate(data, axis=2)
    ratio = cells.width[first + 1] / cells.width[first]
    found = given @ _equal(s, known)[which].T
    unequal = np.flatnonzero(np.abs(ratio - 1) > 1e-12)
    if len(unequal):
        found[:, unequal] = np.einsum("pij,wpj->wpi", _pair(s, known, ratio[unequal])[which], given[:, unequal])
    return found


def _moments(s: int, known: bool) -> tuple[int, int]:
    """Legendre coefficients that are kept of both cells: as many as make a degree of at most 2 s - 2."""
    return (s - 1 if s < 5 and not known else s - 2), s - 2


@lru_cache
def _equal(s: int, known: bool) -> NDArray:
    return _pair(s, known, np.ones(1))[:, 0]


def _pair(s: int, known: bool, ratio: NDArray) -> NDArray:
    """Matrices from what is kept of two cells, widths 1 and `ratio`, to values at the points of both.

    Shape (2, pairs, points, kept).
    """
    q, n = _moments(s, known), len(ratio)
    kept = sum(q) + 2 + known
    x, weights = gauss(kept)
    points = basis(degree(s) + 1).c
    start, width = (np.zeros(n), np.ones(n)), (np.ones(n), ratio)
    test = np.polynomial.legendre.legvander(2 * x - 1, s - 1) * (2 * np.arange(s) + 1) * weights[:, None]

    def at(x: NDArray, k: int) -> NDArray:
        """Legendre polynomials on the pair at places of a cell, shape (pairs, places, kept)."""
        place = (start[k][:, None] + width[k][:, None] * x) / (1 + ratio)[:, None]
        return np.polynomial.legendre.legvander(2 * place - 1, kept - 1)

    rows = [np.einsum("xq,pxk->pqk", test[:, : q[k]], at(x, k)) for k in (0, 1)]
    rows += [at(np.zeros(1), 0)] * known + [at(np.ones(1), 0), at(np.ones(1), 1)]
    inverse = np.linalg.inv(np.concatenate(rows, axis=1))
    return np.stack([at(points, k) @ inverse for k in (0, 1)])


@lru_cache
def _start(s: int) -> NDArray:
    """Values of the polynomial of degree s that is 1 at the start and vanishes at the Radau points of order s."""
    x, c = basis(degree(s) + 1).c, basis(s).c
    return np.prod((c[:, None] - x) / c[:, None], axis=0)
