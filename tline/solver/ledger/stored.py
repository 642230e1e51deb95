"""Energy stored in the waves on lines."""

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.assemble import Assembly
from tline.solver.assembly.fronts import Fronts
from tline.solver.radau import gauss


def stored(assembly: Assembly, fronts: Fronts | None) -> NDArray:
    """Integral of (a² + b²)/(4 z0) over what was sent and has not arrived, J; of lossless lines, shape (lines,).

    The part of the slab that arrived last which a fractional delay still holds back is among it.
    """
    network, state, basis = assembly.network, assembly.state, assembly.basis
    s, h, weights = basis.s, assembly.resolution.h, basis.A[-1]
    lines = list(assembly.lines.values())
    z0 = np.array([line.z0 for line in lines])
    rest = np.array([line.delay for line in lines]) / h - network.delay
    total = np.add.reduceat(state.waves**2 * np.tile(weights, state.waves.size // s), network.offset)
    for k in np.flatnonzero(network.shift_row >= 0):
        held = state.before[2 * k : 2 * k + 2] @ basis.restriction(1 - rest[k], 1.0).T
        total[k] += rest[k] * (held**2 @ weights).sum()
    if fronts is not None:
        pieces = fronts.pieces
        slab, end = np.flatnonzero(pieces.of_slab >= 0), np.flatnonzero(pieces.before >= 0)
        line = np.searchsorted(network.offset, slab * s, side="right") - 1
        np.add.at(total, line, _squares(fronts, pieces.of_slab[slab], np.zeros(len(slab))))
        np.add.at(total, end // 2, _squares(fronts, pieces.before[end], 1.0 - fronts.rest[end // 2]))
    return h * total / (4 * z0)


def _squares(fronts: Fronts, rows: NDArray, after: NDArray) -> NDArray:
    """Integral of the square of slabs in pieces from an instant of each on, in slab time."""
    pieces, (x, weights) = fronts.pieces, gauss(fronts.pieces.coef.shape[2])
    start, stop = pieces.start[rows, :-1], pieces.start[rows, 1:]
    there = np.arange(start.shape[1]) < pieces.number[rows][:, None]
    start, stop = np.where(there, start, 1.0), np.where(there, stop, 1.0)
    cut = np.clip(after[:, None], start, stop)
    places = 2 * (cut[..., None] + (stop - cut)[..., None] * x - start[..., None])
    y = places / np.where(stop > start, stop - start, 1.0)[..., None] - 1
    coef = np.where(there[..., None], pieces.coef[rows], 0.0)
    values = np.einsum("rpxk,rpk->rpx", np.polynomial.legendre.legvander(y, len(x) - 1), coef)
    return ((stop - cut) * (values**2 @ weights)).sum(axis=1)
