"""What is recorded of copies in batches: at common instants, and its extremes."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tline.solver.radau import Basis
from tline.solver.result import NEAR

Floats = NDArray[np.float64]
NEWTON = 4  # steps from the best point of a slab to the extreme of its polynomial
NARROWEST = 1e-18  # of a period; slabs of no width count as so wide


class Extremes(NamedTuple):
    """Smallest and largest values, and when they are first reached, s."""

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
        for pick, sign in ((np.min, -1), (np.max, 1)):
            best = pick([np.concatenate([pick(whole, axis=2), pick(tail, axis=2)], axis=1), starts], axis=0)
            slab = (sign * best).argmax(axis=1)
            found += self._refined(values, slab, sign, at_end[..., 0])
        return Extremes(*found)

    def _refined(self, values: Floats, slab: NDArray, sign: int, at_end: Floats) -> tuple[Floats, Floats]:
        """The extreme of a slab's polynomial, by Newton's method from the best of its points; and of the run's ends."""
        period, k = divmod(slab, self.slabs)
        start, width = self.edges[self._batch, k, self._copy], self.width[self._batch, k, self._copy]
        furthest = np.clip((self.t_end / self.unit - period - start) / width, 0.0, 1.0)
        here = values[self._batch, slab, :, self._copy]  # (batches, B, s)
        slope = here @ self._slope.T
        curve = slope @ self._slope.T
        points = np.concatenate([[0.0], self.order.c])
        seen = np.where(points <= furthest[..., None], sign * here @ self.order.evaluation(points).T, -np.inf)
        x = points[seen.argmax(axis=-1)]
        best, best_at = np.where(sign * at_end > 0.0, (at_end, np.full(x.shape, self.t_end)), 0.0)
        for _ in range(NEWTON + 1):
            rows = self.order.evaluation(x.ravel()).reshape(here.shape)
            value, rise, bend = ((part * rows).sum(axis=-1) for part in (here, slope, curve))
            better = sign * (value - best) > 0.0
            best = np.where(better, value, best)
            best_at = np.where(better, (period + start + x * width) * self.unit, best_at)
            x = np.clip(x - np.divide(rise, bend, out=np.zeros_like(x), where=sign * bend < 0.0), 0.0, furthest)
        return best, best_at
