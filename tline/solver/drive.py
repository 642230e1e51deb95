"""Waveforms on slabs: sampled where they are smooth, L2-projected in slabs that hold a jump or a corner."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.scene.waveform import Shape
from tline.solver.radau import Basis, gauss

EDGE = 1e-9  # slabs; a break nearer than this to a slab's edge counts as on it


def on_slabs(waveform: Shape, breaks: NDArray, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """Values at the Radau points of n slabs from number `first` on, shape (n, s).

    Sampling keeps the order of Radau IIA at slab ends; projection keeps the moments across a jump, so that what passes
    it is right again at the slab's end.
    """
    start = (first + np.arange(n)) * h
    values = waveform.value(start[:, None] + h * basis.c, np.asarray(start[:, None] + h / 2))
    place = breaks[(breaks > start[0]) & (breaks < start[-1] + h)] / h - first
    slab = np.floor(place).astype(int)
    inside = (place - slab > EDGE) & (place - slab < 1 - EDGE)
    x, weights = gauss(basis.s + 4)
    for k in np.unique(slab[inside]):
        edges = np.concatenate([[0.0], place[inside & (slab == k)] - k, [1.0]])
        values[k] = 0.0
        for p, q in pairwise(edges):
            t = p + (q - p) * x
            piece = waveform.value(start[k] + h * t, np.array(start[k] + h * (p + q) / 2))
            values[k] += basis.moments(t, (q - p) * weights) @ piece
    return values


def just_before(waveform: Shape) -> float:
    """Value immediately before t = 0."""
    return float(waveform.value(np.array(0.0), np.array(-np.finfo(float).tiny)))
