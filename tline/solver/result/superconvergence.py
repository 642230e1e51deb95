"""Superconvergent post-processing: waves between slab ends nearly as accurate as at slab ends.

At the end of a slab, and in its low moments, a wave is far more accurate than inside. Between two fronts, three
polynomials are available for a slab, each with its own end and moments:

- the computed one, of degree s - 1;
- one degree higher, with the end of the slab before as its start: order s + 1;
- of degree 2s - 2, shared with a neighbour, through the ends of both: order s + 2 at least.

Each is accepted if it is consistent with the one before it: a start that differs by no more than the highest
coefficients change from slab to slab, and a shared polynomial that changes less than the start did. A front at a slab's
edge fits neither; there the polynomial of the slabs behind it has no start.

References
----------
B. Cockburn, M. Luskin, C.-W. Shu, E. Süli: Enhanced accuracy by post-processing for finite element methods for
hyperbolic equations, Math. Comp. 72 (2003), doi:10.1090/S0025-5718-02-01464-3.
"""

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.kernel.finished import UNEQUAL, Joined, Shared, join, share
from tline.solver.radau import basis, gauss, thin_product

if TYPE_CHECKING:
    from tline.solver.result.wave import Wave

SHARED = 8  # highest order whose polynomials are shared; beyond, the error is rounding
SAME_WIDTH = 1e-12  # relative difference of widths that count as equal
CHUNK = 4096  # pairs of cells processed at a time
NONE = np.empty(0, int)


def degree(s: int) -> int:
    """Degree of the post-processed polynomials of order s ≥ 2."""
    return 2 * s - 2 if s <= SHARED else s


def superconvergent(a: "Wave", b: "Wave") -> "tuple[Wave, Wave]":
    """Post-process the two waves at an end of a line to a higher degree."""
    s, n, pieces = a.basis.s, len(a.values), a.pieces
    if s == 1:
        return a, b
    values, width = (a.values, b.values), np.ones(n)
    whole = order = NONE
    if len(pieces.slab):
        whole = np.delete(np.arange(n), pieces.slab)
        order = np.argsort(np.concatenate([whole, pieces.slab + pieces.span[:, 0]]), kind="stable")
        width = np.concatenate([np.ones(len(whole)), np.diff(pieces.span, axis=1)[:, 0]])[order]
        values = [np.concatenate([wave.values[whole], wave.pieces.values])[order] for wave in (a, b)]
    waves = np.empty((2, len(width) * s + 1))
    for row, wave, held in zip(waves, (a, b), values, strict=True):
        row[0], row[1:] = wave.before, held.reshape(-1)
    found = improved(width, waves, s)
    if found is None:
        return a, b
    new = basis(found.shape[2])
    if not len(pieces.slab):
        return replace(a, values=found[0], basis=new), replace(b, values=found[1], basis=new)
    back = np.empty(found.shape)
    back[:, order] = found
    spread, made = _matrices(s)[0], []
    for wave, each in zip((a, b), back, strict=True):
        held = thin_product(wave.values, spread)
        held[whole] = each[: len(whole)]
        made.append(replace(wave, values=held, basis=new, pieces=pieces._replace(values=each[len(whole) :])))
    return made[0], made[1]


def improved(width: NDArray, waves: NDArray, s: int) -> NDArray | None:
    """Post-processed values at the Radau points of order ``degree(s) + 1``, shape (2, cells, degree + 1), or None.

    Each of the two waves, shape (2, cells * s + 1), has the constant value before the first cell and then values at
    the Radau points of each cell, of these widths in slabs. None means that nothing changes.
    """
    n = width.size
    spread, told, start = _matrices(s)
    values = waves[:, 1:].reshape(2, n, s)
    room = np.empty(n), np.empty(n), np.empty(n, bool)
    at = Joined(s, width, waves, thin_product(values, told), start, thin_product(values, spread), *room)
    packed = pack(at)
    if not join(packed):
        return None
    if s <= SHARED:
        _share(at, packed)
    return at.values


def _share(at: Joined, packed: Any) -> None:
    """Replace the values of cells by those of polynomials shared with their neighbours."""
    s, pairs, (row, word) = at.s, at.width.size - 1, at.waves.strides
    change, changes = np.zeros((2, at.start.size)), np.zeros(1, bool)
    windows = np.ndarray((2, pairs, 2 * s + 1), buffer=at.waves, strides=(row, s * word, word))
    ratio = unequal = NONE  # of widths of neighbours; first cells of joined pairs of unequal width
    if at.width.min() != at.width.max():
        ratio = at.width[1:] / at.width[:-1]
        unequal = np.flatnonzero(at.joined[1:] & (np.abs(ratio - 1.0) > SAME_WIDTH) & (ratio < UNEQUAL))
    for first in range(0, pairs, CHUNK):
        last = min(first + CHUNK, pairs)
        given = np.ascontiguousarray(windows[:, first:last])
        shared = thin_product(given, _equal(s, True))
        alone = np.flatnonzero(~at.joined[first:last])
        if alone.size:
            shared[:, alone] = thin_product(given[:, alone], _equal(s, False))
        these = unequal[(unequal >= first) & (unequal < last)]
        for known in (True, False) if these.size else ():
            some = these[at.joined[these] == known]
            if some.size:
                here = some - first
                shared[:, here] = _pair(s, known, ratio[some], given[:, here].transpose(1, 2, 0)).transpose(2, 0, 1)
        share(pack(Shared(packed, first, shared, change, changes)))


def _moments(s: int, known: bool) -> tuple[int, int]:
    """Number of Legendre coefficients kept of each cell, for a degree of at most 2 s - 2."""
    return (s - 1 if s < 5 and not known else s - 2), s - 2


@lru_cache
def _equal(s: int, known: bool) -> NDArray:
    return np.ascontiguousarray(_pair(s, known, np.ones(1), np.eye(2 * s + 1)[None])[0].T)


def _pair(s: int, known: bool, ratio: NDArray, given: NDArray) -> NDArray:
    """`Shared.values` of cells of widths 1 and `ratio`, shape (pairs, 2 p, waves).

    Given are the end value of the cell before, and the values at the points of both, shape (pairs, 2 s + 1, waves).
    """
    q, m = _moments(s, known), sum(_moments(s, known)) + 2 + known
    places, test = _places(s, m)
    middle, inside = 1 / (1 + ratio), slice(2, 2 + m)
    first, second = (  # Legendre polynomials on the pair at places of a cell
        legvander(2 * (start + width[:, None] * places) - 1, m - 1)
        for start, width in ((0.0, middle), (middle[:, None], middle * ratio))
    )
    rows = test[: q[0]] @ first[:, inside], test[: q[1]] @ second[:, inside], first[:, not known : 2], second[:, 1:2]
    shared = np.concatenate([first[:, 2 + m :], second[:, 2 + m :]], axis=1)
    return shared @ np.linalg.solve(np.concatenate(rows, axis=1), _kept(s, known).T @ given)


@lru_cache
def _kept(s: int, known: bool) -> NDArray:
    """Matrix from the input of `_pair` to the kept Legendre coefficients of both cells and values at their ends."""
    series, ends, q = basis(s).to_legendre.T, np.eye(2 * s + 1)[:, (not known) * s :: s], _moments(s, known)
    kept = np.zeros((2 * s + 1, sum(q)))
    kept[1 : s + 1, : q[0]], kept[s + 1 :, q[0] :] = series[:, : q[0]], series[:, : q[1]]
    return np.concatenate([kept, ends], axis=1)


@lru_cache
def _places(s: int, m: int) -> tuple[NDArray, NDArray]:
    """Ends, Gauss points and higher-order points of a cell; matrix from values at Gauss points to coefficients."""
    x, weights = gauss(m)
    test = legvander(2 * x - 1, s - 1) * (2 * np.arange(s) + 1) * weights[:, None]
    return np.concatenate([[0.0, 1.0], x, basis(degree(s) + 1).c]), test.T


@lru_cache
def _matrices(s: int) -> tuple[NDArray, NDArray, NDArray]:
    """Matrices of order s from values at its points to those at more points, and to `Joined.told`.

    The third holds, at more points, the polynomial that is 1 at the start and vanishes at the points of order s.
    """
    order, x = basis(s), basis(degree(s) + 1).c
    start = np.prod((order.c[:, None] - x) / order.c[:, None], axis=0)
    told = np.concatenate([order.to_legendre[[s - 1]], order.evaluation([0.0])])
    return np.ascontiguousarray(order.evaluation(x).T), np.ascontiguousarray(told.T), start
