"""What is recorded of copies in batches: at common instants, and its extremes."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tline.solver.radau import Basis
from tline.solver.result import NEAR

Floats = NDArray[np.floating]
NEWTON = 3  # steps from the best point of a slab to the extreme of its polynomial
PEAKS = 32  # slabs that are searched for it, at most
SAME = 1e-12  # what is larger by less, relatively, is the same extreme
NARROWEST = 1e-18  # of a period: slabs of no width count as so wide


class Extremes(NamedTuple):
    """Smallest and largest values, and when they are reached, s."""

    lowest: Floats
    lowest_at: Floats
    highest: Floats
    highest_at: Floats


class Track:
    """The slabs of B copies in each of several batches, K in each of n periods.

    Parameters
    ----------
    order : Basis
    unit : ndarray, shape (batches, B)
        Period, s.
    edges : ndarray, shape (batches, K + 1, B)
        Of slabs in a period, as shares of it.
    periods : int
    t_end : float
        End of the run, s.
    """

    def __init__(self, order: Basis, unit: Floats, edges: Floats, periods: int, t_end: float):
        self.order, self.unit, self.edges, self.periods, self.t_end = order, unit, edges, periods, t_end
        self.width, self.slabs = np.maximum(np.diff(edges, axis=1), NARROWEST), edges.shape[1] - 1
        self._batch, self._copy = np.ogrid[: len(unit), : unit.shape[1]]

    @cached_property
    def _slope(self) -> Floats:
        """From values at the points to slopes there."""
        degrees = np.eye(self.order.s)
        rising = [legendre.legval(2 * self.order.c - 1, 2 * legendre.legder(degree)) for degree in degrees]
        return np.array(rising).T @ self.order.to_legendre

    def at(self, t: Floats, *waves: Floats) -> list[Floats]:
        """Waves (batches, n K s, B) at common instants, shape (batches, B, instants); at a jump the value before it."""
        place = t / self.unit[..., None]
        period = np.clip(np.ceil(place - NEAR) - 1, 0, self.periods - 1).astype(int)
        phase = place - period
        slab = (self.edges[:, 1:-1, :, None] < (phase - NEAR)[:, None]).sum(axis=1)
        batch, copy = self._batch[..., None], self._copy[..., None]
        local = np.clip((phase - self.edges[batch, slab, copy]) / self.width[batch, slab, copy], 0.0, 1.0)
        weights = self.order.evaluation(local.ravel()).reshape(*local.shape, self.order.s)
        column = ((period * self.slabs + slab) * self.order.s)[..., None] + np.arange(self.order.s)
        found = [(wave[batch[..., None], column, copy[..., None]] * weights).sum(axis=-1) for wave in waves]
        return [np.where(t > 0, values, 0.0) for values in found]

    def extremes(self, wave: Floats) -> Extremes:
        """Of a wave (batches, n K s, B), zero at t = 0, to the end of the run: of its polynomials, between points too.

        Shapes are (batches, B).
        """
        s, first = self.order.s, self.order.evaluation([0.0])
        values = wave.reshape(len(wave), -1, s, wave.shape[2])
        starts = (first @ values)[:, :, 0]
        last = int(self.t_end / self.unit.max() * (1 - NEAR))  # periods that end within the run in all copies
        begin = (np.arange(last, self.periods)[:, None, None] + self.edges[:, None, :-1]) * self.unit[:, None, None]
        begin = begin.reshape(len(wave), -1, wave.shape[2])
        width = np.tile(self.width * self.unit[:, None], (1, self.periods - last, 1))
        t = begin[:, :, None] + width[:, :, None] * self.order.c[:, None]
        whole, tail = values[:, : last * self.slabs], values[:, last * self.slabs :]
        tail = np.where(t <= self.t_end, tail, 0.0)
        starts[:, last * self.slabs :] *= begin <= self.t_end
        (at_end,) = self.at(np.array([self.t_end]), wave)
        found = []
        for pick, sign in ((np.minimum, -1), (np.maximum, 1)):
            best = np.concatenate([pick.reduce(whole, axis=2), pick.reduce(tail, axis=2)], axis=1)
            found += self._refined(values, sign * pick(best, starts), sign, at_end[..., 0])
        return Extremes(*found)

    def _refined(self, values: Floats, seen: Floats, sign: int, at_end: Floats) -> tuple[Floats, Floats]:
        """The extreme of the slabs' polynomials, and when; `seen` (batches, n K, B) is the best of each slab's points.

        Slabs are searched as long as their points are nearer to the best so far than a peak rises above its points.
        """
        best, best_at = np.where(sign * at_end > 0.0, (at_end, np.full(at_end.shape, self.t_end)), 0.0)
        margin = np.full(best.shape, np.inf)
        for _ in range(PEAKS):
            slab = seen.argmax(axis=1)
            top = seen[self._batch, slab, self._copy]
            batch, copy = np.nonzero(top + margin > sign * best + SAME * np.abs(best))
            if not len(batch):
                break
            slab = slab[batch, copy]
            value, value_at, rise = self._peak(values, batch, copy, slab, sign)
            margin[batch, copy], seen[batch, slab, copy] = rise, -np.inf
            better = sign * (value - best[batch, copy]) > 0.0
            batch, copy = batch[better], copy[better]
            best[batch, copy], best_at[batch, copy] = value[better], value_at[better]
        return best, best_at

    def _peak(
        self, values: Floats, batch: NDArray, copy: NDArray, slab: NDArray, sign: int
    ) -> tuple[Floats, Floats, Floats]:
        """Of some copies the extreme in one slab by Newton's method, when, and by how much a peak may rise at most."""
        period, k = divmod(slab, self.slabs)
        start, width, unit = self.edges[batch, k, copy], self.width[batch, k, copy], self.unit[batch, copy]
        furthest = np.clip((self.t_end / unit - period - start) / width, 0.0, 1.0)
        here = values[batch, slab, :, copy]
        slope = here @ self._slope.T
        curve = slope @ self._slope.T
        points = np.concatenate([[0.0], self.order.c])
        sampled = np.where(points <= furthest[:, None], sign * here @ self.order.evaluation(points).T, -np.inf)
        x = points[sampled.argmax(axis=1)]
        best, best_at, bend = np.full(x.shape, -np.inf), x, x
        for step in range(NEWTON + 1):
            rows = self.order.evaluation(x)
            value = sign * (here * rows).sum(axis=1)
            best, best_at = np.where(value > best, (value, x), (best, best_at))
            if step < NEWTON:
                rise, bend = (slope * rows).sum(axis=1), (curve * rows).sum(axis=1)
                x = np.clip(x - np.divide(rise, bend, out=np.zeros_like(x), where=sign * bend < 0.0), 0.0, furthest)
        return sign * best, (period + start + best_at * width) * unit, np.abs(bend) * np.diff(points).max() ** 2 / 4
