"""The lowest and highest effort at every node, and when, without a record of all that lies between."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.assembly.assemble import Assembly
from tline.solver.description.given import Height
from tline.solver.kernel.extremes import CANDIDATES, ROUNDING, Seen, find_extremes
from tline.solver.loop.march import Noted, concatenated
from tline.solver.loop.slabs import Slabs, cut_at_end
from tline.solver.radau import Basis, chebyshev

SEARCHED = np.linspace(0.0, 1.0, 129)  # places of a slab where its extreme is looked for


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes at nodes, at any instant; in scenes with cavities or air valves, whose fronts are blurred, at slab ends.

    Attributes
    ----------
    nodes : tuple of str
        Those that a line ends at which is not lumped.
    start : ndarray, shape (nodes,)
        Effort before t = 0, Pa or V; in a scene with elevations the piezometric pressure, as the next.
    lowest, highest : ndarray, shape (nodes,)
        Pa or V.
    lowest_at, highest_at : ndarray, shape (nodes,)
        When they are first reached, s.
    lowest_error, highest_error : ndarray, shape (nodes,)
        Estimated, Pa or V: 1.5 to 3 times their difference to those of the next finer run (of scenes with loss elements
        that difference); not a number if there is none.
    weight, per_metre : ndarray, shape (nodes,)
        Density·g·elevation, Pa, by which the piezometric pressure exceeds the gauge pressure, and density·g, Pa/m.
    """

    nodes: tuple[str, ...]
    start: NDArray
    lowest: NDArray
    lowest_at: NDArray
    lowest_error: NDArray
    highest: NDArray
    highest_at: NDArray
    highest_error: NDArray
    weight: NDArray
    per_metre: NDArray

    def of(self, node: str) -> dict[str, float]:
        """Start, extremes, their instants and errors of one node.

        Raises
        ------
        InputError
            There is no such node, or only lumped lines end there.
        """
        if node not in self.nodes:
            raise InputError("node", "has no envelope", "a node at which a line ends that is not lumped", repr(node))
        k = self.nodes.index(node)
        return {name: float(getattr(self, name)[k]) for name in COLUMNS}

    def compared(self, other: "Envelope", caution: float) -> "Envelope":
        """The same with its differences to the envelope of another run, so many times, as errors."""
        return replace(
            self,
            lowest_error=caution * np.abs(self.lowest - other.lowest),
            highest_error=caution * np.abs(self.highest - other.highest),
        )


COLUMNS = ("start", "lowest", "lowest_at", "lowest_error", "highest", "highest_at", "highest_error")


class Extremes:
    """An envelope that grows with a run."""

    def __init__(
        self, nodes: tuple[str, ...], rows: NDArray, start: NDArray, order: Basis, slabs: Slabs, at_ends: bool
    ):
        self.nodes, self.rows, self.start, self.order, self.slabs = nodes, rows, start, order, slabs
        self.top = np.stack([-start, start])  # two maxima: of the negative effort, and of the effort
        self.at = np.zeros_like(self.top)
        self.at_ends = at_ends
        self.places = order.evaluation([1.0] if at_ends or order.s == 1 else [*chebyshev(order.s), 1.0])
        self.searched = order.evaluation(SEARCHED)
        self._heights, self._best = np.empty((2, 0, 0)), np.empty((2, len(rows), CANDIDATES + 1), int)

    def see(self, record: NDArray, first: int, n: int, pieces: Noted) -> None:
        """Take note of n slabs from number `first` on, recorded from the first column of the record on."""
        s, h, rows = self.order.s, self.slabs.width, np.arange(len(self.rows))
        node = np.full(len(record), -1)
        node[self.rows] = rows
        ours = node[pieces.row] >= 0
        pieces = Noted(node[pieces.row[ours]], *(part[ours] for part in pieces[1:]))
        if self.at_ends:
            pieces = concatenated([], s)
        left_out = np.column_stack([pieces.row, pieces.slab - first])
        if first + n > self.slabs.whole:
            last = self.slabs.whole - first
            left_out = np.concatenate([left_out, np.column_stack([rows, np.full(len(rows), last)])])
            if not self.at_ends:
                values = record[self.rows, :, last * s : (last + 1) * s]
                pieces, _ = cut_at_end(self.slabs, values, pieces, self.order)
        if self._heights.shape[2] < n:
            self._heights = np.empty((2, len(rows), n))
        seen = Seen(record, self.rows, self.places, left_out, self._heights, self._best)
        find_extremes(pack(seen), n)
        for k, sign in enumerate((-1, 1)):
            for best in np.sort(self._best[k], axis=1).T:
                found, late = self._heights[k, rows, best], np.full(len(rows), float(self.at_ends))
                if not self.at_ends and s > 1:
                    points = best[:, None] * s + np.arange(s)
                    u = (record[self.rows[:, None], 0, points] + record[self.rows[:, None], 1, points]) / 2
                    higher, late = _searched(sign * u @ self.searched.T)
                    found = np.where(np.isinf(found), -np.inf, higher)
                self._note(k, rows, found, (first + best + late) * h)
            if len(pieces.row):
                found, late = _searched(sign * pieces.values.sum(axis=1) / 2 @ self.searched.T)
                order, (start, stop) = np.argsort(found), pieces.span.T
                when = (pieces.slab + start + late * (stop - start)) * h
                self._note(k, pieces.row[order], found[order], when[order])

    def _note(self, k: int, node: NDArray, found: NDArray, when: NDArray) -> None:
        """Keep what is higher; of several at one node the last is the highest."""
        top = self.top[k]
        new = found > top[node] + ROUNDING * np.abs(top[node])
        top[node[new]], self.at[k, node[new]] = found[new], np.minimum(when[new], self.slabs.end)

    def envelope(self, heights: Mapping[str, Height]) -> Envelope:
        """What was seen at nodes of these heights, counted from their levels."""
        (low, high), (low_at, high_at), at = self.top, self.at, [heights.get(node, Height()) for node in self.nodes]
        level, unknown = np.array([height.level for height in at]), np.full(len(low), np.nan)
        extremes = (level - low, low_at, unknown, high + level, high_at, unknown)
        weight, per_metre = np.array([h.weight for h in at]), np.array([h.per_metre for h in at])
        return Envelope(self.nodes, self.start + level, *extremes, weight, per_metre)


def _searched(values: NDArray) -> tuple[NDArray, NDArray]:
    """The highest of each row, on a parabola through three neighbours, and its place in the slab."""
    rows, k = np.arange(len(values)), values.argmax(axis=1)
    middle = np.clip(k, 1, values.shape[1] - 2)
    before, here, after = (values[rows, middle + j] for j in (-1, 0, 1))
    bend = 2 * here - before - after
    off = (after - before) / np.where(bend > 0, 2 * bend, np.inf)
    inside = (bend > 0) & (np.abs(off) <= 1)
    top = np.where(inside, here + off * (after - before) / 4, values[rows, k])
    return top, np.where(inside, SEARCHED[middle] + off * SEARCHED[1], SEARCHED[k])


def watch(assembly: Assembly, slabs: Slabs) -> Extremes:
    """Extremes of an assembled scene on slabs; one end at each node is recorded from now on, if none was."""
    network = assembly.network
    there = np.flatnonzero(np.diff(network.first))
    one = network.ends[network.first[there]]
    new = one[network.record_row[one] < 0]
    network.record_row[new] = assembly.kept + np.arange(len(new))
    before = np.array([assembly.start[name].reshape(2, 2).mean(axis=1) for name in assembly.lines]).ravel()
    at_ends = assembly.description.blurred
    nodes = list(assembly.nodes)
    names = tuple(nodes[k] for k in there)
    return Extremes(names, network.record_row[one], before[one], assembly.basis, slabs, at_ends)
