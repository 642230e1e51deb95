"""The lowest and highest effort at every node, and when, without a record of all that lies between."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.heights import Height
from tline.solver.assemble import Assembly

ROUNDING = 1e-12  # what tops an extreme by less, relatively, is the same one again


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes at nodes, at slab ends.

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
    weight, per_metre : ndarray, shape (nodes,)
        Density·g·elevation, Pa, by which the piezometric pressure exceeds the gauge pressure, and density·g, Pa/m.
    """

    nodes: tuple[str, ...]
    start: NDArray
    lowest: NDArray
    lowest_at: NDArray
    highest: NDArray
    highest_at: NDArray
    weight: NDArray
    per_metre: NDArray

    def of(self, node: str) -> dict[str, float]:
        """Start, extremes and their instants of one node.

        Raises
        ------
        InputError
            There is no such node, or only lumped lines end there.
        """
        if node not in self.nodes:
            raise InputError("node", "has no envelope", "a node at which a line ends that is not lumped", repr(node))
        k = self.nodes.index(node)
        return {name: float(getattr(self, name)[k]) for name in COLUMNS}


COLUMNS = ("start", "lowest", "lowest_at", "highest", "highest_at")


class Extremes:
    """An envelope that grows with a run."""

    def __init__(self, nodes: tuple[str, ...], rows: NDArray, start: NDArray):
        self.nodes, self.rows, self.start = nodes, rows, start
        self.top = np.stack([-start, start])  # two maxima: of the negative effort, and of the effort
        self.at = np.zeros_like(self.top)

    def see(self, record: NDArray, s: int, first: int, n: int, h: float) -> None:
        """Take note of n slabs from number `first` on, recorded from the first column of the record on."""
        u = (record[self.rows, 0, s - 1 : n * s : s] + record[self.rows, 1, s - 1 : n * s : s]) / 2
        for sign, top, at in zip((-1, 1), self.top, self.at, strict=True):
            k = (sign * u).argmax(axis=1)
            found = sign * u[np.arange(len(u)), k]
            new = found > top + ROUNDING * np.abs(top)
            top[new], at[new] = found[new], (first + 1 + k[new]) * h

    def envelope(self, heights: Mapping[str, Height]) -> Envelope:
        """What was seen at nodes of these heights, counted from their levels."""
        (low, high), (low_at, high_at), at = self.top, self.at, [heights.get(node, Height()) for node in self.nodes]
        level = np.array([height.level for height in at])
        extremes = (self.start + level, level - low, low_at, high + level, high_at)
        return Envelope(self.nodes, *extremes, np.array([h.weight for h in at]), np.array([h.per_metre for h in at]))


def watch(assembly: Assembly) -> Extremes:
    """Extremes of an assembled scene; one end at each node is recorded from now on, if none was."""
    network = assembly.network
    there = np.flatnonzero(np.diff(network.first))
    one = network.ends[network.first[there]]
    new = one[network.record_row[one] < 0]
    network.record_row[new] = 2 * len(assembly.recorded) + np.arange(len(new))
    before = np.array([assembly.start[name].reshape(2, 2).mean(axis=1) for name in assembly.lines]).ravel()
    return Extremes(tuple(assembly.nodes[k] for k in there), network.record_row[one], before[one])
