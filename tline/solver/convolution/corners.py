"""Corners in time at which a law kinks: two polynomials within a slab, continued from the slabs on either side."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import Basis, thin_product

GRID = np.linspace(0.0, 1.0, 33)  # places in a slab between which two polynomials cross
FIT = 0.2  # of the change by a corner: largest misfit at the points of the slab, and between the two at the corner


class Corners(NamedTuple):
    """Corners of waves, one in each of some slabs: place in slab, and polynomials before and behind it."""

    slab: NDArray  # (m,)
    at: NDArray  # (m,) in slab time
    before: NDArray  # (..., m, s) continued over the whole slab
    behind: NDArray


def corners_of(waves: NDArray, least: float, order: Basis) -> Corners:
    """Corners that change waves (..., n, s), all of which bend at one node, by more than `least`."""
    s = waves.shape[-1]
    every = waves.reshape(-1, *waves.shape[-2:])
    before = thin_product(every[:, :-2], order.evaluation(order.c + 1).T)
    behind = thin_product(every[:, 2:], order.evaluation(order.c - 1).T)
    off = [np.abs(each - every[:, 1:-1]).max(axis=(0, 2)) for each in (before, behind)]
    seen = np.flatnonzero(np.minimum(*off) > least)
    before, behind, here = before[:, seen], behind[:, seen], every[:, seen + 1]
    on_grid = order.evaluation(GRID)
    apart = (before - behind) @ on_grid.T  # (waves, m, places)
    first = np.abs(apart).max(axis=2).argmax(axis=0)
    most, m = apart[first, np.arange(len(seen))], np.arange(len(seen))
    crossing = most[:, :-1] * most[:, 1:] < 0
    k = crossing.argmax(axis=1)
    low, high = most[m, k], most[m, k + 1]
    at = GRID[k] + GRID[1] * low / np.where(low == high, 1.0, low - high)
    known = np.where(order.c < at[:, None], before, behind)
    changed = np.where(at[:, None] > GRID, before @ on_grid.T, behind @ on_grid.T) - here @ on_grid.T
    change = np.abs(changed).max(axis=(0, 2))
    torn = np.abs(((before - behind) * order.evaluation(at)).sum(axis=2)).max(axis=0, initial=0.0)
    misfit = np.maximum(np.abs(known - here).max(axis=(0, 2)), torn)
    real = (crossing.sum(axis=1) == 1) & (misfit < FIT * change) & (change > least)
    shape = *waves.shape[:-2], int(real.sum()), s
    return Corners(seen[real] + 1, at[real], before[:, real].reshape(shape), behind[:, real].reshape(shape))
