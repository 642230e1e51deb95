"""What slabs of one width miss beside fronts and their arrivals, put right in pieces that are ever narrower there."""

from collections import defaultdict
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature
from tline.solver.convolution.rays import Ray, Rays
from tline.solver.description.excitation import EDGE, projected
from tline.solver.description.families import Changes, Straight
from tline.solver.loop.march import Noted, concatenated
from tline.solver.radau import Basis

NEAR = 12  # slabs of each width, behind which those of twice the width follow a front
POINTS = 250  # of slabs of one width, about
LEVELS = 14  # times that slabs are halved, at most
MOST = 3e6  # answers of the rest at all points
MOST_LAYERS = 2000  # rays of all fronts


def affordable(network: LinearRest) -> bool:
    """Whether the answers of all nodes to each other fit in memory at all points."""
    return len(network.names) ** 2 * (LEVELS + 1) * POINTS <= MOST


class Source(NamedTuple):
    """A waveform at a node, which holds the effort there or drives a flow."""

    node: int
    held: bool
    share: float
    changes: Changes


class Answer(NamedTuple):
    """What a ray is at rows of the record, to a step and to a ramp: on slabs of each width from the front on."""

    ray: Ray
    values: NDArray  # (levels, kinds, n, s, rows, 2)
    levels: int  # that are needed


class Layers:
    """Rays of all sources of a scene, on grids of slabs of a width and of its parts.

    Parameters
    ----------
    network : LinearRest
    sources : list of Source
    rows : list of pair of int
        Of the record: node, and line end, or -1.
    order : Basis
    h : float
        s.
    slabs : ndarray, shape (lines,)
        Whole ones by which lines move waves.
    """

    def __init__(
        self,
        network: LinearRest,
        sources: list[Source],
        rows: list[tuple[int, int]],
        order: Basis,
        h: float,
        slabs: NDArray,
    ):
        self.sources, self.rows, self.order, self.h = sources, rows, order, h
        self.rule = Quadrature(order, h, 2 * NEAR + 4)
        self.shape = len(self.rule.points) // order.s, order.s
        points = (self.rule.points[:, None] * 2.0 ** np.arange(LEVELS + 1)).T
        self.rays = Rays(network, points.ravel(), h, slabs, rows)

    def corrected(self, record: NDArray, n: int, t_end: float, least: float) -> tuple[NDArray, Noted]:
        """A record (rows, 2, n s) on whole slabs, of sources as they are projected there, and its pieces beside fronts.

        Parameters
        ----------
        record : ndarray
        n : int
        t_end : float
        least : float
            Of the largest value: what narrower slabs change no more.
        """
        record, least = record.copy(), least * float(np.abs(record).max())
        most = MOST_LAYERS // max(sum(len(source.changes.at) for source in self.sources), 1)
        layers: dict[int, list[tuple[float, Answer, NDArray]]] = defaultdict(list)
        for source in self.sources:
            changes = source.changes
            scale = abs(source.share) * max(
                np.abs(changes.jump).max(initial=0), np.abs(changes.bend).max(initial=0) * self.h
            )
            if not scale:
                continue
            for ray in islice(self.rays.of(source.node, source.held, t_end, least / scale), most):
                answer = self._answer(ray, source, least)
                if answer is None:
                    continue
                for t, *weights in zip(changes.at, changes.jump, changes.bend, strict=True):
                    if t + ray.delay < t_end:
                        each = source.share * np.array(weights)
                        self._take(record, answer, t, each, n)
                        layers[tuple(ray.rows)].append((t, answer, each))
        pieces = [self._pieces(record, rows, layers[rows], n) for rows in layers]
        return record, concatenated(pieces, self.order.s)

    def _answer(self, ray: Ray, source: Source, least: float) -> Answer | None:
        """On slabs of all widths; None where it begins so smoothly that the scene's own slabs follow it."""
        rule, (places, s) = self.rule, self.shape
        ramp = (np.arange(rule.n)[:, None] + self.order.c) * self.h
        into = rule.forward(np.stack([np.ones((rule.n, s)), ramp], axis=2))  # (points, kinds)
        waves = ray.waves.reshape(LEVELS + 1, places * s, 1, -1)
        out = waves * into[:, :, None] * np.stack([np.ones(LEVELS + 1), 0.5 ** np.arange(LEVELS + 1)], 1)[:, None, :, None]
        out = rule.backward(out.transpose(1, 0, 2, 3).reshape(places * s, -1))
        values = out.reshape(rule.n, s, LEVELS + 1, 2, len(ray.rows), 2).transpose(2, 3, 0, 1, 4, 5)
        halves = np.stack([self.order.restriction(0.0, 0.5), self.order.restriction(0.5, 1.0)])
        narrow = values[1:, :, : 2 * NEAR].reshape(LEVELS, 2, NEAR, 2, s, -1)
        wide = np.einsum("hij,lknjr->lknhir", halves, values[:-1, :, :NEAR].reshape(LEVELS, 2, NEAR, s, -1))
        off = np.abs(narrow - wide).max(axis=(2, 3, 4, 5))  # (levels, kinds)
        jump, bend = (abs(source.share) * np.abs(x).max(initial=0) for x in (source.changes.jump, source.changes.bend))
        late = np.flatnonzero(off @ [jump, bend] > least)
        first = np.abs(values[0, :, 0]).max(axis=(1, 2, 3)) @ [jump, bend]
        return None if not len(late) and first <= least else Answer(ray, values, int(late.max(initial=-1)) + 1)

    def _take(self, record: NDArray, answer: Answer, t: float, weights: NDArray, n: int) -> None:
        """Take away what a ray of one front is on whole slabs."""
        ray, rule, (places, s) = answer.ray, self.rule, self.shape
        first = self._first(t)
        begin = first + ray.moved
        m = min(n - begin, rule.n)
        if m <= 0:
            return
        front = Straight(np.array([t - first * self.h]), np.array([0.0, weights[0]]), np.array([0.0, weights[1]]))
        into = rule.forward(projected(front, self.order, self.h, rule.n)[:, :, None])
        waves = ray.waves.reshape(LEVELS + 1, places * s, -1)[0]
        late = np.exp(-rule.points * self.h * ray.rest)[:, None]
        out = rule.backward(waves * into * late).reshape(rule.n, s, -1, 2)[:m]
        into = record.reshape(*record.shape[:2], -1, s)
        into[ray.rows, :, begin : begin + m] -= out.transpose(2, 3, 0, 1)

    def _pieces(
        self, record: NDArray, rows: tuple[int, ...], layers: list[tuple[float, Answer, NDArray]], n: int
    ) -> Noted:
        """Pieces of slabs at one group of nodes: what is left of the record, and all layers there."""
        s, h, order = self.order.s, self.h, self.order
        meshes = [self._edges(t, answer) for t, answer, _ in layers]
        touched = np.zeros(n, bool)
        for edges, end in meshes:
            touched[int(edges[0] + EDGE) : int(end)] = True
        slabs = np.flatnonzero(touched)
        cuts = np.concatenate([slabs, slabs + 1.0, *(edges[edges < end] for edges, end in meshes)])
        cuts = np.unique(np.where(np.abs(cuts - np.round(cuts)) < EDGE, np.round(cuts), cuts))
        cuts = cuts[np.diff(cuts, prepend=-1.0) > 4e-16 * cuts]
        cuts = cuts[(cuts >= 0) & (cuts <= n)]
        start, stop = cuts[:-1], cuts[1:]
        slab = np.floor((start + stop) / 2).astype(int)
        start, stop, slab = (x[touched[slab]] for x in (start, stop, slab))
        x = start[:, None] + (stop - start)[:, None] * order.c  # (pieces, s) in slabs
        left = record.reshape(*record.shape[:2], -1, s)[list(rows)][:, :, slab]  # (rows, 2, pieces, s)
        values = np.einsum("rdpi,pji->rdpj", left, _values(order, x - slab[:, None]))
        for (edges, end), (_, answer, weights) in zip(meshes, layers, strict=True):
            low, high = np.searchsorted(start, edges[0] - EDGE), np.searchsorted(stop, end + EDGE)
            table = _joined(answer, weights)  # (pieces, s, rows, 2)
            k = np.clip(np.searchsorted(edges, (start[low:high] + stop[low:high]) / 2) - 1, 0, len(edges) - 2)
            local = (x[low:high] - edges[k, None]) / (edges[k + 1] - edges[k])[:, None]
            values[:, :, low:high] += np.einsum("pird,pji->rdpj", table[k], _values(order, local))
        count, span = len(slab), np.column_stack([start, stop]) - slab[:, None]
        return Noted(
            np.repeat(np.array(rows), count), np.tile(slab, len(rows)), np.tile(span, (len(rows), 1)),
            values.transpose(0, 2, 1, 3).reshape(-1, 2, s),
        )  # fmt: skip

    def _edges(self, t: float, answer: Answer) -> tuple[NDArray, float]:
        """Edges of a layer's slabs, and where it ends, for there what was taken away does; in slabs of the scene."""
        at, end = (t + answer.ray.delay) / self.h, self._first(t) + answer.ray.moved + self.rule.n
        widths = [0.5**answer.levels * np.arange(NEAR)]
        widths += [0.5**level * np.arange(NEAR, 2 * NEAR) for level in range(answer.levels, 0, -1)]
        return at + np.concatenate([*widths, np.arange(NEAR, int(np.ceil(end - at - EDGE)) + 1)]), float(end)

    def _first(self, t: float) -> int:
        return int(np.floor(t / self.h + EDGE))


def _values(order: Basis, x: NDArray) -> NDArray:
    """Matrices from values at the points to values at places of each piece, (pieces, places, s)."""
    return order.evaluation(x.ravel()).reshape(*x.shape, order.s)


def _joined(answer: Answer, weights: NDArray) -> NDArray:
    """A layer on its slabs, (slabs, s, rows, 2)."""
    values, last = np.einsum("lknsrd,k->lnsrd", answer.values[: answer.levels + 1], weights), answer.levels
    return np.concatenate([values[last, :NEAR], *(values[k, NEAR : 2 * NEAR] for k in range(last, 0, -1)), values[0, NEAR:]])
