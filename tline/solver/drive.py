"""Waveforms on slabs: sampled where they are smooth, L2-projected in slabs that hold a jump or a corner."""

from typing import NamedTuple

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
    values = waveform.value(start[:, None] + h * basis.c, start[:, None] + h / 2)
    place = breaks[(breaks > start[0]) & (breaks < start[-1] + h)] / h - first
    near = place - np.floor(place)
    place = place[(near > EDGE) & (near < 1 - EDGE)]
    if not place.size:
        return values
    cut = np.unique(np.floor(place))
    edges = np.unique(np.concatenate([cut, place, cut + 1]))
    slab = np.floor((edges[:-1] + edges[1:]) / 2)
    of_cut = np.isin(slab, cut)  # the others lie between cut slabs
    slab, p, width = slab[of_cut].astype(int), edges[:-1][of_cut], np.diff(edges)[of_cut]
    x, weights = gauss(basis.s + 4)
    t = (p - slab)[:, None] + width[:, None] * x  # in slab time, shape (pieces, nodes)
    seen = waveform.value(start[slab][:, None] + h * t, start[slab][:, None] + h * (p - slab + width / 2)[:, None])
    moments = basis.moments(t.ravel(), (width[:, None] * weights).ravel())
    values[cut.astype(int)] = 0.0
    np.add.at(values, slab, (moments * seen.ravel()).reshape(basis.s, *t.shape).sum(axis=2).T)
    return values


class Broken(NamedTuple):
    """The part of one Thévenin wave in the slabs in which a source jumps or has a corner."""

    slab: NDArray  # (slabs,) their numbers
    anew: NDArray  # (slabs,) whether there is a front at the slab's start
    parts: NDArray  # (slabs,) number of pieces
    start: NDArray  # (pieces,) in slab time
    stop: NDArray
    coef: NDArray  # (pieces, s) Legendre coefficients


def places_of(parts: list[tuple[Shape, float]], t_end: float, h: float) -> NDArray:
    """Instants in slabs, sorted, at which the waveforms of one drive row jump or bend; t = 0 is always one."""
    places = np.concatenate([[0.0], *(waveform.breaks(t_end) for waveform, _ in parts)]) / h
    near = np.round(places)
    places = np.where(np.abs(places - near) < EDGE, near, places)
    return np.unique(places[(places >= 0) & (places < t_end / h)])


def broken(parts: list[tuple[Shape, float]], places: NDArray, basis: Basis, h: float, first: int, n: int) -> Broken:
    """Sampled piece by piece in those of n slabs, from number `first` on, that hold one of the places."""
    places = places[(places >= first) & (places < first + n)]
    cut = np.unique(np.floor(places))
    edges = np.unique(np.concatenate([cut, places, cut + 1]))
    start, stop = edges[:-1], edges[1:]
    slab = np.floor((start + stop) / 2)
    of_cut = np.isin(slab, cut)  # the others lie between cut slabs
    start, stop, slab = start[of_cut], stop[of_cut], slab[of_cut]
    t, inside = h * (start[:, None] + (stop - start)[:, None] * basis.c), h * (start + stop)[:, None] / 2
    values = sum((share * waveform.value(t, inside) for waveform, share in parts), np.zeros(t.shape))
    count = np.unique(slab, return_counts=True)[1]
    numbers = cut.astype(int)
    return Broken(numbers, np.isin(cut, places), count, start - slab, stop - slab, values @ basis.to_legendre.T)


def just_before(waveform: Shape) -> float:
    """Value immediately before t = 0."""
    past = waveform.breaks(0.0)
    past = past[past < 0]
    return float(waveform.value(np.array(0.0), np.array(past[-1] / 2 if past.size else -1.0)))
