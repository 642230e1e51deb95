"""Corrections to slabs of one width beside fronts and their arrivals, in pieces ever narrower towards them.

Corners in time at which a law kinks: two polynomials within a slab, continued from the slabs on either side.
"""

from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.convolution.laws import Fronts, Tangents
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature
from tline.solver.convolution.rays import Ray, Rays
from tline.solver.description.excitation import EDGE, projected
from tline.solver.description.given import Straight
from tline.solver.loop.march import Noted, concatenated
from tline.solver.radau import Basis, thin_product

POINTS = 200  # of slabs of one width, about
LEVELS = 14  # times that slabs are halved, at most
AT_ONCE = 3  # such times that are looked at together
MOST_ANSWERS = 3e6  # answers of the rest at all points
MOST_LAYERS = 600  # rays of all fronts
GRID = np.linspace(0.0, 1.0, 33)  # places in a slab between which two polynomials cross
FIT = 0.2  # of the change by a corner: largest misfit at the points of the slab, and between the two at the corner
NARROWEST_PIECE = 4e-16  # of an instant: narrower pieces are dropped


def affordable(network: LinearRest) -> bool:
    """Whether the answers of all nodes to each other fit in memory at all points."""
    return len(network.names) ** 2 * (LEVELS + 1) * POINTS <= MOST_ANSWERS


class Layer(NamedTuple):
    """Response to a front at an arrival: polynomials on slabs of its own; in slabs of the scene."""

    edges: NDArray  # (slabs + 1,)
    values: NDArray  # (slabs, s, rows, 2)
    end: int  # slab from which on the scene's own have it

    def sampled(self, first: int, n: int, order: Basis) -> NDArray:
        """Values at the points of n slabs of the scene, (rows, 2, n, s), where the layer's own are as wide."""
        k = np.clip(np.searchsorted(self.edges, first + order.c - EDGE) - 1, 0, len(self.edges) - 2)  # in the first
        local = order.evaluation(first + order.c - self.edges[k])
        slabs = np.minimum(np.arange(n)[:, None] + k, len(self.values) - 1)
        return np.einsum("xi,nxird->rdnx", local, self.values[slabs])


class Corners(NamedTuple):
    """Corners of waves, one in each of some slabs: place in slab, and polynomials before and behind it."""

    slab: NDArray  # (m,)
    at: NDArray  # (m,) in slab time
    before: NDArray  # (..., m, s) continued over the whole slab
    behind: NDArray


class Layers:
    """Rays of all fronts of a scene, on grids of slabs of a width and of its parts.

    Rows of the record are pairs of a node and a line end, or -1; `moved` are delays of lines and their whole slabs, by
    which waves are moved.
    Behind `near` slabs of each width those of twice the width follow a front; slabs are halved `halvings` times at
    most, and transforms are `padded` times as long as the slabs. Where laws have `kinks`, waves may have corners.
    """

    def __init__(
        self,
        network: LinearRest,
        fronts: list[Fronts],
        rows: list[tuple[int, int]],
        order: Basis,
        h: float,
        moved: tuple[NDArray, NDArray],
        near: int,
        padded: int,
        halvings: int = LEVELS,
        kinks: bool = False,
        tangents: Tangents | None = None,
    ):
        self.fronts = [each for each in fronts if each.sizes(h).any()]
        self.order, self.h, self.rule = order, h, Quadrature(order, h, 2 * near + 4, padded)
        self.near, self.halvings, self.kinks = near, halvings, kinks
        self.halves = np.stack([order.restriction(0.0, 0.5), order.restriction(0.5, 1.0)])
        points = 2.0 ** np.arange(self.halvings + 1)[:, None] * self.rule.points
        self.rays = Rays(network, points.ravel(), h, moved, rows, tangents)

    def corrected(self, record: NDArray, n: int, t_end: float, least: float) -> tuple[NDArray, Noted]:
        """A record (rows, 2, n s) on whole slabs, of sources as they are projected there, and its pieces beside fronts.

        Changes by narrower slabs of less than `least` of the largest value are left out.
        """
        s, least = self.order.s, least * float(np.abs(record).max())
        left = record.reshape(len(record), 2, -1, s).copy()
        layers: dict[tuple[int, ...], list[Layer]] = defaultdict(list)
        for fronts in self.fronts:
            for some, rays in self._traced(fronts, t_end, least / float(fronts.sizes(self.h).max())):
                for rows, found in rays.items():
                    layers[rows] += self._layers(left, some, found, t_end, least)
        kinks = least if self.kinks else np.inf
        pieces = [
            self._pieces(left, rows, layers[rows], corners_of(left[list(rows)], kinks, self.order))
            for rows in (tuple(row for row, *_ in each) for each in self.rays.rows if each)
            if self.kinks or layers[rows]
        ]
        return left.reshape(record.shape), concatenated(pieces, s)

    def _traced(
        self, fronts: Fronts, t_end: float, least: float
    ) -> Iterator[tuple[Fronts, dict[tuple[int, ...], list[Ray]]]]:
        """Yield rays by rows, each with fronts for which they are the same."""
        most, left = MOST_LAYERS // max(sum(len(each.at) for each in self.fronts), 1), list(range(len(fronts.at)))
        while left:
            t = float(fronts.at[left[0]])
            found, path = self.rays.of(fronts.into, fronts.held, t, t_end, least)
            alike = [k for k in left if self.rays.alike(path, t, float(fronts.at[k]))]
            rays: dict[tuple[int, ...], list[Ray]] = defaultdict(list)
            for ray in found[:most]:
                rays[tuple(ray.rows)].append(ray)
            yield fronts.some(alike), rays
            left = [k for k in left if k not in alike]

    def _layers(self, left: NDArray, source: Fronts, rays: list[Ray], t_end: float, least: float) -> Iterator[Layer]:
        """Yield layers of one source at one group of nodes, and subtract their part on whole slabs from `left`."""
        waves = np.stack([ray.waves.reshape(self.halvings + 1, len(self.rule.points), -1) for ray in rays], axis=2)
        answers, levels = self._followed(waves, source.sizes(1.0), least)
        kept = np.flatnonzero(levels >= 0)
        if not len(kept):
            return
        firsts = np.floor(source.at / self.h + EDGE).astype(int)
        fronts = [self._front(source, k, first) for k, first in enumerate(firsts.tolist())]
        late = np.exp(-self.rule.points[:, None] * self.h * np.array([rays[k].rest for k in kept]))
        alone = waves[0][:, kept] * late[:, :, None]
        for (front, weights), t, first in zip(fronts, source.at, firsts, strict=True):
            coarse = self._backward(alone * front[:, None, None])
            for k, values in zip(kept, coarse, strict=True):
                ray, begin = rays[k], int(first) + rays[k].moved
                if t + ray.delay >= t_end:
                    continue
                taken = left[ray.rows, :, begin : begin + self.rule.n]
                values = values.reshape(*values.shape[:2], -1, 2).transpose(2, 3, 0, 1)
                left[ray.rows, :, begin : begin + self.rule.n] = taken - values[:, :, : taken.shape[2]]
                at = (t + ray.delay) / self.h
                end = begin + self.rule.n
                until = max(int(np.ceil(at + self.near * (levels[k] > 0) - EDGE)), int(at + EDGE) + 1)
                values = self._joined(answers[k], levels[k], weights)
                layer = Layer(at + self._edges(levels[k], at, end), values, min(until, end))
                n = left[ray.rows, :, layer.end : end].shape[2]
                left[ray.rows, :, layer.end : end] += layer.sampled(layer.end, n, self.order)
                yield layer

    def _front(self, source: Fronts, k: int, first: int) -> tuple[NDArray, NDArray]:
        """Transform of a front on whole slabs, from its own slab on; and its jump and bend."""
        weights = np.array([source.jump[k], source.bend[k]])
        front = Straight(source.at[k : k + 1] - first * self.h, *np.pad(weights[:, None], ((0, 0), (1, 0))))
        return self.rule.forward(projected(front, self.order, self.h, 0, self.rule.n)[:, :, None])[:, 0], weights

    def _followed(self, waves: NDArray, sizes: NDArray, least: float) -> tuple[list[NDArray], NDArray]:
        """Responses of each ray to step and ramp by width, (levels, 2, n, s, 2 rows), and halvings that it needs.

        `waves` have the shape (levels, points, rays, 2 rows). -1: the scene's own slabs follow.
        """
        every = np.arange(waves.shape[2])
        answers = self._answers(waves, range(min(AT_ONCE, self.halvings) + 1))
        begins = np.abs(answers[:, 0, :, 0]).max(axis=(2, 3)) @ sizes > least
        found, levels = list(answers), begins - 1
        while len(every):
            level = len(found[every[0]])
            late = self._changes(answers) @ sizes > least  # (rays, levels)
            last = level - 1 - np.argmax(late[:, ::-1], axis=1)
            levels[every] = np.where(late.any(axis=1), last, levels[every])
            every = every[late[:, -1]] if level <= self.halvings else every[:0]
            if len(every):
                more = range(level, min(level + AT_ONCE, self.halvings + 1))
                narrower = self._answers(waves[:, :, every], more)
                answers = np.concatenate([np.stack([found[k][-1:] for k in every]), narrower], axis=1)
                for k, each in zip(every.tolist(), narrower, strict=True):
                    found[k] = np.concatenate([found[k], each])
        return found, levels

    def _answers(self, waves: NDArray, levels: range) -> NDArray:
        """Responses to step and ramp on slabs of some widths, (rays, levels, 2, n, s, 2 rows)."""
        ramp = (np.arange(self.rule.n)[:, None] + self.order.c) * self.h
        step, ramp = self.rule.forward(np.stack([np.ones_like(ramp), ramp], axis=2)).T
        into = np.stack([np.stack([step, ramp * 0.5**level]) for level in levels])  # (levels, 2, points)
        found = self._backward(
            (waves[levels.start : levels.stop, None] * into[..., None, None]).transpose(2, 3, 0, 1, 4)
        )
        return found.reshape(*found.shape[:3], len(levels), 2, -1).transpose(0, 3, 4, 1, 2, 5)

    def _backward(self, transforms: NDArray) -> NDArray:
        """Values (rays, n, s, …) of transforms (points, rays, …)."""
        found = self.rule.backward(transforms.reshape(len(transforms), -1))
        return np.moveaxis(found.reshape(self.rule.n, self.order.s, transforms.shape[1], -1), 2, 0)

    def _changes(self, answers: NDArray) -> NDArray:
        """Largest changes of responses from each width to the next, (rays, levels - 1, 2)."""
        (r, levels), s = answers.shape[:2], self.order.s
        narrow = answers[:, 1:, :, : 2 * self.near].reshape(r, levels - 1, 2, self.near, 2, s, -1)
        wide = np.einsum("hij,rlknjx->rlknhix", self.halves, answers[:, :-1, :, : self.near], optimize=True)
        return np.abs(narrow - wide).max(axis=(3, 4, 5, 6))

    def _pieces(self, left: NDArray, rows: tuple[int, ...], layers: list[Layer], corners: Corners) -> Noted:
        """Pieces of slabs at one group of nodes: the remaining record with its corners, plus all layers there."""
        order, n = self.order, left.shape[2]
        touched = np.zeros(n, bool)
        touched[corners.slab] = True
        for layer in layers:
            touched[int(layer.edges[0] + EDGE) : int(layer.end)] = True
        slabs = np.flatnonzero(touched)
        if not len(slabs):
            return concatenated([], order.s)
        cuts = np.concatenate(
            [slabs, slabs + 1.0, corners.slab + corners.at, *(layer.edges[layer.edges < layer.end] for layer in layers)]
        )
        cuts = distinct(np.where(np.abs(cuts - np.round(cuts)) < EDGE, np.round(cuts), cuts))
        cuts = cuts[(np.diff(cuts, prepend=-1.0) > NARROWEST_PIECE * cuts) & (cuts <= n)]
        start, stop = cuts[:-1], cuts[1:]
        slab = np.floor((start + stop) / 2).astype(int)
        start, stop, slab = (x[touched[slab]] for x in (start, stop, slab))
        x = start[:, None] + (stop - start)[:, None] * order.c  # (pieces, s), in slabs
        known = left[list(rows)][:, :, slab]
        for k, at, *both in zip(
            corners.slab, corners.at, *(np.moveaxis(each, 2, 0) for each in corners[2:]), strict=True
        ):
            here = np.flatnonzero(slab == k)
            for side, polynomial in zip((0, 1), both, strict=True):
                known[:, :, here[(start[here] + stop[here] > 2 * (k + at)) == side]] = polynomial[:, :, None]
        values = np.einsum("pji,rdpi->pjrd", _values(order, x - slab[:, None]), known)
        if not layers:
            return self._noted(rows, slab, start, stop, values)
        spans = [np.searchsorted(start, (layer.edges[0] - EDGE, layer.end - EDGE)) for layer in layers]
        middles = [(start[low:high] + stop[low:high]) / 2 for low, high in spans]
        which = [np.searchsorted(layer.edges, middle) - 1 for layer, middle in zip(layers, middles, strict=True)]
        which = [np.clip(k, 0, len(layer.values) - 1) for k, layer in zip(which, layers, strict=True)]
        begin, until = (
            np.concatenate([layer.edges[k + j] for k, layer in zip(which, layers, strict=True)]) for j in (0, 1)
        )
        seen = np.concatenate([x[low:high] for low, high in spans])
        local = _values(order, (seen - begin[:, None]) / (until - begin)[:, None])
        tables = np.concatenate([layer.values[k] for k, layer in zip(which, layers, strict=True)])
        added = np.matmul(local, tables.reshape(*tables.shape[:2], -1)).reshape(tables.shape)
        place = 0
        for low, high in spans:
            values[low:high] += added[place : place + high - low]
            place += high - low
        return self._noted(rows, slab, start, stop, values)

    def _noted(self, rows: tuple[int, ...], slab: NDArray, start: NDArray, stop: NDArray, values: NDArray) -> Noted:
        count, span = len(slab), np.column_stack([start, stop]) - slab[:, None]
        return Noted(
            np.repeat(np.array(rows), count), np.tile(slab, len(rows)), np.tile(span, (len(rows), 1)),
            values.transpose(2, 0, 3, 1).reshape(-1, 2, self.order.s),
        )  # fmt: skip

    def _edges(self, levels: int, at: float, end: float) -> NDArray:
        """Edges of a layer's slabs from its front on, which is at an instant, until the end; in slabs of the scene."""
        narrow = [0.5**levels * np.arange(self.near)]
        narrow += [0.5**level * np.arange(self.near, 2 * self.near) for level in range(levels, 0, -1)]
        return np.concatenate([*narrow, np.arange(self.near, max(int(np.ceil(end - at - EDGE)), self.near) + 1)])

    def _joined(self, answers: NDArray, levels: int, weights: NDArray) -> NDArray:
        """A layer on its slabs, (slabs, s, rows, 2), of (levels, 2, n, s, 2 rows)."""
        last = np.concatenate(
            [
                answers[levels, :, : self.near],
                *(answers[level, :, self.near : 2 * self.near] for level in range(levels, 0, -1)),
                answers[0, :, self.near :],
            ],
            axis=1,
        )
        found = np.tensordot(weights, last, 1)
        return found.reshape(*found.shape[:2], -1, 2)


def _values(order: Basis, x: NDArray) -> NDArray:
    """Matrices from values at the points to values at places of each piece, (pieces, places, s)."""
    return order.evaluation(x.ravel()).reshape(*x.shape, order.s)


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
