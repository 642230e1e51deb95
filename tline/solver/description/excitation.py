"""Waveforms on slabs: sampled at the points, piece by piece in slabs that hold a jump or a corner."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.description.given import Constant, Shape
from tline.solver.radau import Basis

MEANS = 8  # instants of a slab
EDGE = 1e-9  # slabs; a break, an instant, or the end of a run nearer than this to a slab's edge counts as on it


class Waveform(Protocol):
    """Smooth pieces between breaks: a shape of the scene, or a part of one."""

    def breaks(self, t_end: float) -> NDArray:
        """Instants of jumps and corners, s."""
        ...

    def value(self, t: NDArray, inside: NDArray) -> NDArray:
        """Value at t of the smooth piece that contains `inside`, continued; shapes broadcast."""
        ...

    def fastest(self) -> float:
        """Shortest time scale of the smooth pieces, s; infinite if all are straight."""
        ...


def sampled(waveform: Waveform, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """Values at the Radau points of n slabs from number `first` on, shape (n, s); without meaning in broken ones."""
    start = (first + np.arange(n)) * h
    return waveform.value(start + h * basis.c[:, None], start + h / 2).T  # loops over slabs are longer than over points


def projected(waveform: Waveform, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """Values at the Radau points of n slabs from number `first` on, shape (n, s); broken ones hold L2 projections."""
    found = sampled(waveform, basis, h, first, n)
    if not len(waveform.breaks((first + n) * h)):
        return found
    places = places_of([(waveform, 1.0)], (first + n) * h, h)
    inside = places[places != np.floor(places)]
    if len(inside):
        cut = broken([(waveform, 1.0)], inside, basis, h, first, n)
        found[cut.slab - first] = 0.0
        slabs = np.repeat(cut.slab - first, cut.parts)
        for slab, start, stop, coef in zip(slabs, cut.start, cut.stop, cut.coef, strict=True):
            found[slab] += basis.projection(float(start), float(stop)) @ (basis.to_points @ coef)
    return found


def averaged(waveform: Waveform, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """Means over n slabs from number `first` on, of some instants in each, at all their points, shape (n, s)."""
    t = (first + np.arange(n) + (np.arange(MEANS)[:, None] + 0.5) / MEANS) * h
    return np.repeat(waveform.value(t, t).mean(axis=0)[:, None], basis.s, axis=1)


class Broken(NamedTuple):
    """The part of one Thévenin wave in the slabs in which a source jumps or has a corner."""

    slab: NDArray  # (slabs,) their numbers
    anew: NDArray  # (slabs,) whether there is a front at the slab's start
    parts: NDArray  # (slabs,) number of pieces
    start: NDArray  # (pieces,) in slab time
    stop: NDArray
    coef: NDArray  # (pieces, s) Legendre coefficients


def places_of(parts: Sequence[tuple[Waveform, float]], t_end: float, h: float) -> NDArray:
    """Instants in slabs, sorted, at which the waveforms of one excitation row jump or bend; t = 0 is always one."""
    places = np.concatenate([[0.0], *(waveform.breaks(t_end) for waveform, _ in parts)]) / h
    near = np.round(places)
    places = np.where(np.abs(places - near) < EDGE, near, places)
    return distinct(places[(places >= 0) & (places < t_end / h)])


def jumps_of(parts: Sequence[tuple[Waveform, float]], places: NDArray, t_end: float, h: float, steady: bool) -> NDArray:
    """Select the places that piecewise constants must follow: jumps, and corners less than a slab apart.

    In a run from rest t = 0 is always among them.
    """
    edges, t = np.append(places, t_end / h), h * places
    middle, near = h * (edges[:-1] + edges[1:]) / 2, np.diff(places) < 1
    before, after = np.zeros(len(places)), np.zeros(len(places))
    for waveform, share in parts:
        before += share * np.append(just_before(waveform), waveform.value(t[1:], middle[:-1]))
        after += share * waveform.value(t, middle)
    kept = np.abs(after - before) > EDGE * np.maximum(np.abs(before), np.abs(after))
    kept[0] |= not steady
    near[:1] &= kept[0] or any((np.abs(waveform.breaks(h)) < EDGE * h).any() for waveform, _ in parts)
    kept[1:] |= near
    kept[:-1] |= near
    return places[kept]


def broken(parts: list[tuple[Waveform, float]], places: NDArray, basis: Basis, h: float, first: int, n: int) -> Broken:
    """Sampled piece by piece in those of n slabs, from number `first` on, that hold one of the places."""
    places = places[(places >= first) & (places < first + n)]
    cut = distinct(np.floor(places))
    edges = distinct(np.concatenate([cut, places, cut + 1]))
    start, stop = edges[:-1], edges[1:]
    slab = np.floor((start + stop) / 2)
    of_cut = cut[np.searchsorted(cut, slab, "right") - 1] == slab  # the others lie between cut slabs
    start, stop, slab = start[of_cut], stop[of_cut], slab[of_cut]
    t, inside = h * (start[:, None] + (stop - start)[:, None] * basis.c), h * (start + stop)[:, None] / 2
    values = sum((share * waveform.value(t, inside) for waveform, share in parts), np.zeros(t.shape))
    count, anew = np.diff(np.searchsorted(slab, cut), append=len(slab)), places[np.searchsorted(places, cut)] == cut
    return Broken(cut.astype(int), anew, count, start - slab, stop - slab, values @ basis.to_legendre.T)


def just_before(waveform: Waveform) -> float:
    """Value immediately before t = 0."""
    past = waveform.breaks(0.0)
    past = past[past < 0]
    return float(waveform.value(np.array(0.0), np.array(past[-1] / 2 if past.size else -1.0)))


def varies(waveform: Shape | None) -> bool:
    """Whether it is not one value for ever."""
    return waveform is not None and not isinstance(waveform, Constant)
