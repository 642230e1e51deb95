"""Fronts of waveforms in families, by their places in slabs; and the sum of the responses to all families.

A waveform is its value before t = 0 plus its changes at each of its fronts. So it is a sum of waveforms with a family
of fronts each; and on a clock that began earlier these lie on the edges of slabs.
"""

from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.description.excitation import EDGE, Waveform, just_before
from tline.solver.description.given import Straight
from tline.solver.loop.march import Noted
from tline.solver.radau import Basis, thin_product

MOST_FAMILIES = 128  # families that are worth a run each
SAME_FAMILY = EDGE / 2  # slabs; fronts whose places differ by less are of one family
ROUNDED = (
    1e-14  # of the largest wave of a record, of sources, or of a waveform: smaller waves, jumps and bends are none
)
STEP = 1e-6  # of the time scale of a curved waveform, by which its slope at a front is seen
SEEN = np.array([[0.0], [0.1382], [0.4142], [0.7321], [1.0]])  # of a piece: where it is compared with the value before


class Changes(NamedTuple):
    """A waveform by its fronts."""

    waveform: Waveform
    before: float  # value before t = 0
    at: NDArray  # (fronts,) instants, s
    jump: NDArray  # (fronts,) changes of value
    bend: NDArray  # (fronts,) changes of slope
    curved: bool

    def part(self, chosen: NDArray, ahead: float) -> Waveform:
        """Return the changes at chosen fronts, all of a curved waveform's; on a clock `ahead` of the scene's, s."""
        at = self.at[chosen]
        if not len(at):
            return Straight(np.zeros(1), *np.zeros((2, 2)))
        if self.curved:
            return Late(self.waveform, at + ahead, ahead, self.before)
        slope, level = np.cumsum(self.bend[chosen]), np.cumsum(self.jump[chosen])
        level[1:] += np.cumsum(slope[:-1] * np.diff(at))
        return Straight(at + ahead, np.append(0.0, level), np.append(0.0, slope))


def changes_of(waveform: Waveform, steady: bool, t_end: float) -> Changes:
    """The fronts of a waveform from t = 0 to the end of a run.

    Before t = 0 it has the value that it has immediately before, if that is steady; else it is zero till then.
    """
    before = just_before(waveform) if steady else 0.0
    breaks = waveform.breaks(t_end)
    knots = distinct(np.concatenate([[0.0], breaks[(breaks > 0) & (breaks < t_end)], [t_end]]))
    width = np.diff(knots)
    pieces = waveform.value(knots[:-1] + width * SEEN, (knots[:-1] + knots[1:]) / 2)  # (places, pieces)
    jump, curved = pieces[0] - np.append(before, pieces[-1, :-1]), bool(np.isfinite(waveform.fastest()))
    begin = end = (pieces[-1] - pieces[0]) / width
    if curved:
        step, middle = STEP * np.minimum(width, waveform.fastest()), (knots[:-1] + knots[1:]) / 2
        begin = (waveform.value(knots[:-1] + step, middle) - pieces[0]) / step
        end = (pieces[-1] - waveform.value(knots[1:] - step, middle)) / step
    bend = begin - np.append(0.0, end[:-1])
    least = ROUNDED * max(float(np.abs(pieces).max()), abs(before))
    jump[np.abs(jump) <= least] = 0.0
    real = (np.abs(jump) > least) | (np.abs(bend) * width > least) | curved
    real[0] &= bool((np.abs(pieces[:, 0] - before) > least).any())
    return Changes(waveform, before, knots[:-1][real], jump[real], bend[real], curved)


def leads(instants: NDArray) -> NDArray:
    """Leads by which slabs begin earlier, in slabs; with one of them each instant, in slabs, is at an edge."""
    found: list[float] = []
    for ahead in distinct(-instants % 1.0).tolist():
        if not found or ahead - found[-1] > SAME_FAMILY:
            found.append(ahead)
    if found and found[-1] > 1.0 - SAME_FAMILY:
        found[-1] -= 1.0
    return distinct([ahead if ahead > SAME_FAMILY else 0.0 for ahead in found])


def family_of(instants: NDArray, ahead: NDArray) -> NDArray:
    """Number of the lead that puts each instant, in slabs, at an edge."""
    apart = np.abs(-instants[:, None] % 1.0 - ahead)
    return np.minimum(apart, 1.0 - apart).argmin(axis=1)


class Late(NamedTuple):
    """A waveform on a clock that is ahead of the scene's, less its value before t = 0."""

    waveform: Waveform
    at: NDArray  # (fronts,) s
    ahead: float  # s
    before: float

    def breaks(self, t_end: float) -> NDArray:
        """Instants of the fronts, s."""
        return self.at[self.at < t_end]

    def value(self, t: NDArray, inside: NDArray) -> NDArray:
        """Value at t of the smooth piece that contains `inside`, continued."""
        seen = self.waveform.value(t - self.ahead, inside - self.ahead)
        return np.where(inside < self.ahead, 0.0, seen - self.before)

    def fastest(self) -> float:
        """Shortest time scale, s."""
        return self.waveform.fastest()


def summed(
    records: Iterable[NDArray], ahead: NDArray, n: int, order: Basis, least: float = 0.0
) -> tuple[NDArray, Noted]:
    """Sum records, on slabs that begin `ahead` slabs earlier each, on n slabs from t = 0 on.

    Records have the shape (rows, 2, slabs * s), one for each of `ahead`. Where one polynomial a slab misses a record by
    `least` of its largest value at most it is added as that; elsewhere the sum has pieces between the places at which
    slabs begin.
    """
    edges = np.append(distinct([0.0, *(1.0 - ahead[ahead > 0.0])]), 1.0)
    whole, kept = np.zeros((1, 1, n, order.s)), []
    for record, slabs in zip(records, ahead.tolist(), strict=True):
        waves = record.reshape(len(record), 2, -1, order.s)
        if not slabs:
            whole = whole + waves[:, :, :n]
            continue
        mean, off = _projected(waves, slabs, n, order)
        bent = np.flatnonzero(off > max(least, ROUNDED) * float(np.abs(record).max()))
        kept.append((bent, _pieces(waves, bent, slabs, edges, order)))
        mean[:, :, bent] = 0.0
        whole = whole + mean
    slab = distinct(np.concatenate([np.empty(0, int), *(bent for bent, _ in kept)]))
    spans = list(pairwise(edges.tolist()))
    values = np.stack([whole[:, :, slab] @ order.restriction(*span).T for span in spans], axis=3)
    for bent, pieces in kept:
        values[:, :, np.searchsorted(slab, bent)] += pieces
    rows, _, _, m, s = values.shape
    places = np.minimum(np.searchsorted(edges[1:], order.c), m - 1)
    local = (order.c - edges[places]) / np.diff(edges)[places]
    whole[:, :, slab] = np.einsum("rdnis,is->rdni", values[:, :, :, places], order.evaluation(local))
    pieces = Noted(
        np.repeat(np.arange(rows), len(slab) * m),
        np.tile(np.repeat(slab, m), rows),
        np.tile(np.array(spans), (rows * len(slab), 1)),
        values.transpose(0, 2, 3, 1, 4).reshape(-1, 2, s),
    )
    return whole.reshape(rows, 2, n * s), pieces


def _projected(waves: NDArray, ahead: float, n: int, order: Basis) -> tuple[NDArray, NDArray]:
    """Waves projected on n slabs of the scene, (rows, 2, n, s), and the largest that this misses in each, (n,)."""
    later, sooner = order.shift(1.0 - ahead)
    first, second = order.restriction(0.0, 1.0 - ahead), order.restriction(1.0 - ahead, 1.0)
    before = np.concatenate([sooner, first @ sooner - order.restriction(ahead, 1.0), second @ sooner])
    behind = np.concatenate([later, first @ later, second @ later - order.restriction(0.0, ahead)])
    found = thin_product(waves[:, :, :n], before.T) + thin_product(waves[:, :, 1 : n + 1], behind.T)
    return found[..., : order.s].copy(), np.abs(found[..., order.s :]).max(axis=(0, 1, 3))


def _pieces(waves: NDArray, slab: NDArray, ahead: float, edges: NDArray, order: Basis) -> NDArray:
    """Waves, on slabs that begin `ahead` earlier, in pieces of some of the scene's; (rows, 2, slabs, pieces, s)."""
    start, stop = edges[:-1] + ahead, edges[1:] + ahead
    later = ((start + stop) / 2 >= 1.0).astype(int)
    return np.stack(
        [
            waves[:, :, slab + k] @ order.restriction(a - k, b - k).T
            for a, b, k in zip(start, stop, later.tolist(), strict=True)
        ],
        axis=3,
    )
