"""Envelope of a run: lowest and highest effort at every node and their instants, without a full record."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.assembly.assemble import Assembly
from tline.solver.description.given import Height
from tline.solver.kernel.finished import TIE, extremes, find_extremes
from tline.solver.loop.march import Noted, concatenated
from tline.solver.loop.slabs import Slabs, cut_at_end
from tline.solver.radau import basis


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes at nodes, at any instant; at slab ends in scenes with cavities or air valves, which blur fronts."""

    nodes: tuple[str, ...]  # nodes with an end of a line that is not lumped
    # (nodes,) effort before t = 0, Pa or V; in a scene with elevations the piezometric pressure, as the next
    start: NDArray
    lowest: NDArray  # (nodes,) Pa or V
    lowest_at: NDArray  # (nodes,) instant when it is first reached, s
    # (nodes,) Pa or V: 1.5 to 3 times the difference from the next finer run; NaN if there is none
    lowest_error: NDArray
    highest: NDArray  # (nodes,)
    highest_at: NDArray  # (nodes,)
    highest_error: NDArray
    weight: NDArray  # (nodes,) density·g·elevation, Pa, by which the piezometric pressure exceeds the gauge pressure
    per_metre: NDArray  # (nodes,) density·g, Pa/m
    # effort before t = 0, lowest effort and its instant, highest and its instant, of nodes without such a line end
    alone: Mapping[str, tuple[float, float, float, float, float]] = field(default_factory=dict)

    def of(self, node: str) -> dict[str, float]:
        """Start, extremes, their instants and errors of one node."""
        if node not in self.nodes:
            raise InputError("node", "has no envelope", "a node at which a line ends that is not lumped", repr(node))
        k = self.nodes.index(node)
        return {name: float(getattr(self, name)[k]) for name in COLUMNS}

    def compared(self, other: "Envelope", caution: float) -> "Envelope":
        """Set the errors to `caution` times the differences from another envelope, where known ones are not larger."""
        low, high = (caution * np.abs(getattr(self, key) - getattr(other, key)) for key in ("lowest", "highest"))
        errors = np.fmax(self.lowest_error, low), np.fmax(self.highest_error, high)
        return replace(self, lowest_error=errors[0], highest_error=errors[1])


COLUMNS = ("start", "lowest", "lowest_at", "lowest_error", "highest", "highest_at", "highest_error")


class Extremes:
    """Recorder of extremes during a run of an assembled scene, whose nodes it lets be recorded."""

    def __init__(self, assembly: Assembly, slabs: Slabs):
        network, nodes = assembly.network, list(assembly.nodes)
        ends = np.diff(network.first)
        there = np.flatnonzero(ends)
        inner = np.array([k for k in np.flatnonzero(ends == 0) if nodes[k] in assembly.description.nodes], int)
        one = network.ends[network.first[there]]
        assembly.watch(one, inner)
        before = assembly.u.ravel()
        self.nodes, self.alone = (tuple(nodes[k] for k in each) for each in (there, inner))
        self.start = np.append(before[one], [assembly.efforts[node] for node in self.alone])
        self.rows = np.append(network.record_row[one], network.effort_row[inner])
        self.order, self.slabs, self.at_ends = assembly.basis, slabs, assembly.description.blurred
        self.sought = basis(1) if self.at_ends else self.order
        self.top, self.at = np.zeros((2, 2, len(self.start)))  # largest fall and rise from the start, and when

    def see(self, record: NDArray, first: int, n: int, pieces: Noted) -> None:
        """Search n slabs from number `first` on, which begin at the first column of the record."""
        s, h, whole = self.order.s, self.slabs.width, self.slabs.whole - first
        node = np.full(len(record), -1)
        node[self.rows] = np.arange(len(self.rows))
        ours = node[pieces.row] >= 0
        pieces = Noted(node[pieces.row[ours]], *(part[ours] for part in pieces[1:]))
        u = (record[self.rows, 0, : n * s] + record[self.rows, 1, : n * s]) / 2 - self.start[:, None]
        u = u.reshape(-1, n, s).transpose(1, 2, 0)
        if self.at_ends:
            u, pieces = u[:, -1:], concatenated([], s)
        u = np.ascontiguousarray(u)
        u[pieces.slab - first, :, pieces.row] = 0.0
        if n > whole:
            u[whole:] = 0.0
            if not self.at_ends:
                values = record[self.rows, :, whole * s : (whole + 1) * s]
                pieces, _ = cut_at_end(self.slabs, values, pieces, self.order)
        every = np.arange(len(self.rows))
        for k, (found, at) in enumerate(self._highest(u)):
            self._note(k, every, found, (first + at + self.at_ends) * h)
        if not len(pieces.row):
            return
        values, (start, stop) = pieces.values.sum(axis=1) / 2 - self.start[pieces.row, None], pieces.span.T
        for k, (found, at) in enumerate(self._highest(np.ascontiguousarray(values.T[None]))):
            order, when = np.argsort(found), (pieces.slab + start + at * (stop - start)) * h
            self._note(k, pieces.row[order], found[order], when[order])

    def _highest(self, u: NDArray) -> Iterator[tuple[NDArray, NDArray]]:
        """Yield largest fall below zero and rise above it of polynomials (slabs, points, rows), and the slabs."""
        found, edges = np.empty((4, u.shape[2])), np.repeat([[0.0], [1.0]], u.shape[2], axis=1)
        find_extremes(pack(extremes(u, edges[1], edges, float(len(u)), self.sought.c, self.sought.to_powers, found)))
        yield -found[0], found[1]
        yield found[2], found[3]

    def _note(self, k: int, node: NDArray, found: NDArray, when: NDArray) -> None:
        """Keep higher values; of several at one node the last must be the highest."""
        top = self.top[k]
        new = found > top[node] * (1 + TIE)
        top[node[new]], self.at[k, node[new]] = found[new], np.minimum(when[new], self.slabs.end)

    def envelope(self, heights: Mapping[str, Height]) -> Envelope:
        """Envelope so far, with efforts counted from the levels of the nodes."""
        at = [heights.get(node, Height()) for node in (*self.nodes, *self.alone)]
        ours, level = len(self.nodes), np.array([height.level for height in at])
        start = self.start + level
        (low, high), (low_at, high_at), unknown = self.top[:, :ours], self.at[:, :ours], np.full(ours, np.nan)
        seen = start[:ours] - low, low_at, unknown, start[:ours] + high, high_at, unknown
        weight, per_metre = np.array([h.weight for h in at[:ours]]), np.array([h.per_metre for h in at[:ours]])
        columns = start, start - self.top[0], self.at[0], start + self.top[1], self.at[1]
        alone = dict(zip(self.alone, zip(*(each[ours:].tolist() for each in columns), strict=True), strict=True))
        return Envelope(self.nodes, start[:ours], *seen, weight, per_metre, alone)
