"""Waves between slab ends nearly as accurate as at these, from what of a run is superconvergent.

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
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from tline.solver.kernel.share import Neighbours, share
from tline.solver.radau import basis, gauss
from tline.structure import pack

if TYPE_CHECKING:
    from tline.solver.result.result import Wave

SHARED = 8  # order up to which polynomials are shared; beyond, rounding is all that is left
EXPECTED = 4.0  # times what the change of the highest coefficient lets expect, that a start may be off
FALLS = 0.1  # of a change of the start, that a shared polynomial may change at most
FIRST = 10.0  # the same in a slab without a start
UNEQUAL = 16.0  # widths of neighbours beyond this ratio are not compared
SAME = 1e-12  # widths that near to each other, relatively, are equal
ROUNDING = 4e-15  # of the largest value


class Cells(NamedTuple):
    """Polynomials of the two waves at an end of a line, in order of time."""

    width: NDArray  # (cells,) slabs
    values: NDArray  # (2, cells, s) at the Radau points of each
    before: NDArray  # (2,) what was constant before the first


def degree(s: int) -> int:
    """Degree of the polynomials that are made of those of order s, from 2 on."""
    return 2 * s - 2 if s <= SHARED else s


def superconvergent(a: "Wave", b: "Wave") -> "tuple[Wave, Wave]":
    """The two waves at an end of a line, of higher degree."""
    s, n, pieces = a.basis.s, len(a.values), a.pieces
    if s == 1:
        return a, b
    values, width = np.stack([a.values, b.values]), np.ones(n)
    whole = order = np.arange(n)
    if len(pieces.slab):
        whole = np.setdiff1d(whole, pieces.slab)
        order = np.argsort(np.concatenate([whole, pieces.slab + pieces.span[:, 0]]), kind="stable")
        width = np.concatenate([np.ones(len(whole)), np.diff(pieces.span, axis=1)[:, 0]])[order]
        in_pieces = np.stack([a.pieces.values, b.pieces.values])
        values = np.ascontiguousarray(np.concatenate([values[:, whole], in_pieces], axis=1)[:, order])
    found = improved(Cells(width, values, np.array([a.before, b.before])))
    if found is None:
        return a, b
    new = basis(found.shape[2])
    if not len(pieces.slab):
        return replace(a, values=found[0], basis=new), replace(b, values=found[1], basis=new)
    back = np.empty(found.shape)
    back[:, order] = found
    spread, made = _matrices(s)[0], []
    for wave, each in zip((a, b), back, strict=True):
        held = wave.values @ spread
        held[whole] = each[: len(whole)]
        made.append(replace(wave, values=held, basis=new, pieces=pieces._replace(values=each[len(whole) :])))
    return made[0], made[1]


def improved(cells: Cells) -> NDArray | None:
    """Values at the Radau points of order ``degree(s) + 1``, shape (2, cells, degree + 1); None if nothing changes."""
    s = cells.values.shape[2]
    spread, at_start, start = _matrices(s)
    ends = np.empty((2, cells.width.size + 1))
    ends[:, 0], ends[:, 1:] = cells.before, cells.values[:, :, -1]
    coefficients = cells.values @ basis(s).to_legendre.T
    off = cells.values @ at_start - ends[:, :-1]
    joined = _joined(cells, coefficients[:, :, -1], off)
    off = np.where(joined, off, 0.0)
    if np.abs(off).max() <= ROUNDING * np.abs(ends).max():
        return None
    values = cells.values @ spread - off[:, :, None] * start
    if s <= SHARED:
        _share(cells, coefficients, ends, values, np.abs(off).max(axis=0), joined)
    return values


def _joined(cells: Cells, highest: NDArray, off: NDArray) -> NDArray:
    """Whether each cell goes on where the one before it ends.

    The error of one wave may come from the other, so both together tell what is to be expected; behind a far narrower
    cell, the edge after it.
    """
    s = cells.values.shape[2]
    ratio = _ratio(cells)
    near = (ratio < UNEQUAL) & (ratio > 1 / UNEQUAL)
    bends = np.abs(highest)
    bends[:, 1:] = np.abs(highest[:, 1:] - highest[:, :-1] * np.where(near, ratio, 1.0)[1:] ** (s - 1))
    bend = bends.max(axis=0)
    bend = np.where(near, bend, np.append(bend[1:], 0.0))
    least = ROUNDING * np.abs(cells.values[:, :, -1]).max()
    expected = np.maximum(EXPECTED / (2 * s - 1) * _about(bend), least)
    return (ratio > 1 / UNEQUAL) & (np.abs(off).max(axis=0) <= expected)


def _ratio(cells: Cells) -> NDArray:
    """Width of each cell over that of the one before."""
    return cells.width / np.append(cells.width[0], cells.width[:-1])


def _about(sizes: NDArray) -> NDArray:
    """Each, or the smaller one of its neighbours: one alone may vanish by chance."""
    if len(sizes) < 3:
        return sizes
    about = sizes.copy()
    about[1:-1] = np.maximum(sizes[1:-1], np.minimum(sizes[2:], sizes[:-2]))
    return about


def _share(cells: Cells, coefficients: NDArray, ends: NDArray, values: NDArray, off: NDArray, joined: NDArray) -> None:
    """Change the values of cells to those of polynomials that they share with their neighbours."""
    s, points = cells.values.shape[2], values.shape[2]
    ratio, expected = _ratio(cells)[1:], _about(off)[1:]
    known = joined[:-1]
    first = np.flatnonzero(joined[1:] & (ratio < UNEQUAL) & (expected > 0.0) & ~(known & (s == 2)))
    if not len(first):
        return
    known, ratio, expected = known[first], ratio[first], expected[first]
    unequal = np.abs(ratio - 1.0) > SAME
    matrix = np.where(known, 0, 1)
    matrix[unequal] = 2 + np.arange(unequal.sum())
    matrices = np.empty((2 + unequal.sum(), 2 * s + 3, 2 * points))
    matrices[0], matrices[1] = _equal(s)
    for kind in (True, False):
        these = unequal & (known == kind)
        if these.any():
            matrices[matrix[these]] = _pair(s, kind, ratio[these])
    most = np.stack([np.where(known, FALLS, FIRST) * expected, FALLS * expected], axis=1)
    share(
        pack(
            Neighbours(
                coefficients,
                ends,
                values,
                first,
                matrix,
                most,
                matrices,
                np.empty((2, 2 * points)),
                np.empty(values.shape),
                np.empty(len(joined), np.int64),
            )
        )
    )


def _moments(s: int, known: bool) -> tuple[int, int]:
    """Legendre coefficients that are kept of both cells: as many as make a degree of at most 2 s - 2."""
    return (s - 1 if s < 5 and not known else s - 2), s - 2


@lru_cache
def _equal(s: int) -> tuple[NDArray, NDArray]:
    """Matrices of cells of equal width, with a start and without one."""
    known = _pair(s, True, np.ones(1))[0] if s > 2 else np.zeros((2 * s + 3, 2 * degree(s) + 2))
    return known, _pair(s, False, np.ones(1))[0]


def _pair(s: int, known: bool, ratio: NDArray) -> NDArray:
    """Matrices of cells of widths 1 and `ratio`, see `Neighbours`; shape (pairs, 2 s + 3, 2 p)."""
    q, n = _moments(s, known), len(ratio)
    kept = [*range(q[0]), *range(s, s + q[1]), *range(2 * s + (not known), 2 * s + 3)]
    x, weights = gauss(len(kept))
    points = basis(degree(s) + 1).c
    start, width = (np.zeros(n), np.ones(n)), (np.ones(n), ratio)
    test = legvander(2 * x - 1, s - 1) * (2 * np.arange(s) + 1) * weights[:, None]

    def at(x: NDArray, k: int) -> NDArray:
        """Legendre polynomials on the pair at places of a cell, shape (pairs, places, kept)."""
        place = (start[k][:, None] + width[k][:, None] * x) / (1 + ratio)[:, None]
        return legvander(2 * place - 1, len(kept) - 1)

    rows = [np.einsum("xq,pxk->pqk", test[:, : q[k]], at(x, k)) for k in (0, 1)]
    rows += [at(np.zeros(1), 0)] * known + [at(np.ones(1), 0), at(np.ones(1), 1)]
    matrices = np.zeros((n, 2 * s + 3, 2 * len(points)))
    shared = np.concatenate([at(points, k) for k in (0, 1)], axis=1)
    matrices[:, kept] = (shared @ np.linalg.inv(np.concatenate(rows, axis=1))).swapaxes(1, 2)
    return matrices


@lru_cache
def _matrices(s: int) -> tuple[NDArray, NDArray, NDArray]:
    """Of order s: from values at its points to those at more points, and to the start of a cell.

    And what the polynomial that is 1 at the start and vanishes at the points of order s is at more points.
    """
    order, x = basis(s), basis(degree(s) + 1).c
    start = np.prod((order.c[:, None] - x) / order.c[:, None], axis=0)
    return np.ascontiguousarray(order.evaluation(x).T), order.evaluation([0.0])[0], start
