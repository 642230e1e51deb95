"""What a result gives out at the ends of lines, at instants of the witness's own, and how far off it may be."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.result.result import Result
from tline.solver.witness.equations import Flow
from tline.solver.witness.nodes import Balance, Term

INSTANTS, WINDOWS = 64, 4  # drawn at random, one in each part of the run
SLABS = 100  # of a window, at most: the longer, the less does it matter how far off an effort may be
POINTS = leggauss(5)  # of a piece of a window
MARGIN = 3.0  # times the tolerance, that efforts and flows may be off
ROUNDING = 1e-10  # of what a node sees, for flows are small differences of waves
FAINT = 1e-6  # of the largest effort of all, below which nothing is told


class Window:
    """A part of the run over which is integrated: where it lies among the instants, and the weights of these."""

    def __init__(self, first: int, edges: NDArray):
        x, w = POINTS
        half, middle = np.diff(edges)[:, None] / 2, (edges[1:] + edges[:-1])[:, None] / 2
        self.begin, self.width = float(edges[0]), float(edges[-1] - edges[0])
        self.t, self.weight = (middle + half * x).ravel(), (half * w).ravel()
        self.at = slice(first, first + self.t.size)

    @property
    def share(self) -> NDArray:
        """Instants as shares of the window."""
        return (self.t - self.begin) / self.width


class Seen:
    """Efforts and flows of a result at `t`: at random, and then those of windows if these are wanted."""

    def __init__(self, result: Result, description: Description, tol: float, windows: bool):
        self.result, self.description, self.tol = result, description, tol
        self.instants = _one_in_each(description.t_end, INSTANTS)
        self.windows: list[Window] = []
        self._ends: dict[tuple[str, int], tuple[NDArray, NDArray]] = {}
        self.at_node = {
            node: (name, end)
            for name in result.lines
            if name in description.lines
            for end, node in enumerate(description.lines[name].nodes)
        }
        first = INSTANTS
        for edges in self._edges() if windows else ():
            self.windows.append(Window(first, edges))
            first += self.windows[-1].t.size
        self.t = np.concatenate([self.instants, *(window.t for window in self.windows)])

    def _edges(self) -> Iterator[NDArray]:
        """Edges of the pieces of each window: those of slabs and fronts."""
        t_end, h = self.description.t_end, self.result.resolution.h
        width = min(t_end / WINDOWS, SLABS * h)
        lines = self.result.lines.values()
        fronts = [wave.breakpoints() for line in lines for wave in (line.a1, line.b1, line.a2, line.b2)]
        known = np.concatenate([np.empty(0), *fronts])
        for begin in _one_in_each(t_end, WINDOWS) * (1 - width * WINDOWS / t_end):
            end = begin + width
            slabs = np.arange(np.ceil(begin / h), np.floor(end / h) + 1) * h
            inside = known[(known > begin) & (known < end)]
            yield np.unique(np.clip(np.concatenate([[begin, end], slabs, inside]), begin, end))

    def end(self, name: str, end: int) -> tuple[NDArray, NDArray]:
        """Effort at an end of a line, and the flow out of the line there."""
        if (name, end) not in self._ends:
            record = self.result.lines[name]
            a, b = (wave(self.t) for wave in (record.at_end2 if end else record.at_end1))
            self._ends[name, end] = (a + b) / 2, (a - b) / (2 * record.z0) * (1.0 if end else -1.0)
        return self._ends[name, end]

    def reads(self, one: Balance) -> bool:
        """Whether all is recorded that the balance of a node needs."""
        beyond = {term.beyond for term in (*one.flows, *one.stores)} - {None}
        return all(name in self.result.lines for name, _ in one.ends) and beyond <= self.at_node.keys()

    @cached_property
    def largest(self) -> float:
        """The largest effort or wave of all lines."""
        return max((float(np.abs(self.end(*at)[0]).max()) for at in self.at_node.values()), default=0.0)

    def conducts(self, one: Balance) -> float:
        """Sum of 1/z0 of the line ends at a node."""
        return sum(1 / self.result.lines[name].z0 for name, _ in one.ends)

    def efforts(self, one: Balance) -> NDArray:
        """At a node, as each line end there has them: shape (ends, instants)."""
        return np.array([self.end(*at)[0] for at in one.ends])

    def out(self, one: Balance) -> NDArray:
        """Flow out of the lines at a node."""
        return np.sum([self.end(*at)[1] for at in one.ends], axis=0)

    def allowed(self, one: Balance) -> tuple[float, float]:
        """How far the effort at a node, and the flow out of the lines, may be off."""
        gauge = next((term.weight for term in (*one.flows, *one.stores) if term.weight), 0.0)
        flows = sum(float(np.abs(self.end(*at)[1]).max()) for at in one.ends)
        conducts = self.conducts(one)
        size = max(float(np.abs(self.efforts(one) - gauge).max()), flows / conducts, FAINT * self.largest)
        share = MARGIN * self.tol + ROUNDING
        return share * size + 1e-15 * abs(gauge), share * (size * conducts + flows)

    def across(self, term: Term, u: NDArray) -> tuple[NDArray, float]:
        """Effort across an element at a node of effort u, as it counts it, and the sign of its flow out of the node."""
        if term.beyond is None:
            return u - term.weight, 1.0
        beyond = self.end(*self.at_node[term.beyond])[0]
        return (beyond - u, -1.0) if term.reversed else (u - beyond, 1.0)

    def passed(self, one: Balance) -> tuple[NDArray, NDArray]:
        """Least and largest flow into what keeps nothing: efforts may be off, between two nodes by twice as much."""
        u, off = self.efforts(one)[0], self.allowed(one)[0]
        low, high = np.zeros_like(self.t), np.zeros_like(self.t)
        for term in one.flows:
            assert isinstance(term.equation, Flow)
            e, sign = self.across(term, u)
            width = off if term.beyond is None else 2 * off
            flows = np.array([sign * term.equation.at(self.t, e + d) for d in (-width, 0.0, width)])
            low, high = low + flows.min(axis=0), high + flows.max(axis=0)
        return low, high


def _one_in_each(t_end: float, parts: int) -> NDArray:
    """Drawn at random, one in each part of the run, in order."""
    rng = np.random.default_rng(parts)
    return (np.arange(parts) + rng.uniform(0.0, 1.0, parts)) / parts * t_end
