"""Rays: responses to each front of a source at each of its arrivals, on slabs ever narrower towards it.

Beside an arrival a line with a memory answers on all time scales at once, which slabs of one width cannot follow. With
exp(-sT) taken out, a path from a source to a node is a transfer function F(s) without delay. So its response to a step
and to a ramp is known on few slabs of any width: on the scene's own, where it is subtracted exactly as it is part of
the run, and on slabs half, a quarter, … as wide as long as these change it, which take its place.
"""

from heapq import heappop, heappush
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.convolution.families import changes_of
from tline.solver.convolution.fronts import Tangents
from tline.solver.convolution.nodal import LinearRest
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.description.switches import switches_of

MOST_RAYS = 100  # rays of one source
SAME_ARRIVAL = 1e-9  # of the shortest delay; nearer arrivals, of rays by paths that are moved alike, are one
DIGITS, STEEPEST = 3, -0.9995  # of the share of a small wave that a law sends back: digits, and least
MOST_ARRIVALS = 10_000  # arrivals


class Ray(NamedTuple):
    """Waves at a group of nodes that arrive a fixed time after a front of a source."""

    delay: float  # s
    moved: int  # whole slabs of the delay by which waves are moved
    rest: float  # slabs of the delay that are a part of exp(-sT)
    rows: NDArray  # (rows,) of the record
    waves: NDArray  # (points, rows, 2) waves that arrive there and that leave, without the delay


class Passed(NamedTuple):
    """How a front passes a line."""

    delay: float  # s
    moved: int  # whole slabs of the delay by which waves are moved
    rest: float  # slabs of it besides


class Way(NamedTuple):
    """A way of waves from the sending ends of a line, or of conductors that mix, to the receiving ones."""

    front: Passed
    there: list[int]  # ends
    into: NDArray  # (points, ends) of the wave on this way, from those of the sending ends
    out_of: NDArray  # (points, ends) of the receiving ends


class Rays:
    """Paths through a linear rest, along lines that move waves by whole slabs.

    Points are 1/s; `moved` are delays of fronts in lines and whole slabs, of width h, by which waves are moved; rows
    are pairs of a node and a line end, or -1.
    """

    def __init__(
        self,
        network: LinearRest,
        points: NDArray,
        h: float,
        moved: tuple[NDArray, NDArray],
        rows: list[tuple[int, int]],
        tangents: Tangents | None = None,
    ):
        self.network, self.fast, self.h, self.tangents = network, np.abs(points) * h > 1, h, tangents
        each = zip(*(part.tolist() for part in moved), strict=True)
        self.passed = [Passed(delay, int(slabs), delay / h - slabs) for delay, slabs in each]
        self._carry(points)
        matrix, p = network.system(points * network.second, (self.admittance, np.zeros(self.admittance.shape)))
        unknown, known_by = p.shape[1], network.known_by
        held = known_by @ np.linalg.inv(matrix)[:, :unknown, :unknown]
        answers = held @ (p[:, :, None] * known_by.T)
        self.groups = [at for at, _ in network.groups]
        self.group_of, self.local = np.empty(len(network.names), int), np.empty(len(network.names), int)
        for group, at in enumerate(self.groups):
            self.group_of[at], self.local[at] = group, np.arange(len(at))
        self.laws = [np.flatnonzero(network.ports[:, at].any(axis=1)) for at in self.groups]
        self.answers: dict[tuple[float, ...], tuple[NDArray, NDArray]] = {
            (group, *(0.0 for _ in laws)): (held[:, at][:, :, network.place[at]], answers[:, at][:, :, at])
            for group, (at, laws) in enumerate(zip(self.groups, self.laws, strict=True))
        }  # efforts in a group under one that is held, and under flows, by the shares that its laws send back
        self.leaving: list[list[tuple[list[int], Way]]] = [[] for _ in self.groups]
        for here, ways in self.ways:
            self.leaving[self.group_of[network.node_of[here[0]]]] += [(here, way) for way in ways]
        self.rows: list[list[tuple[int, int, int]]] = [[] for _ in self.groups]
        for row, (node, end) in enumerate(rows):
            self.rows[self.group_of[node]].append((row, node, end))

    def _carry(self, points: NDArray) -> None:
        """Ways from the ends of all lines, and admittances of all pairs of lines."""
        network, one = self.network, np.ones((len(points), 1))
        total, impedance = network.propagation(points * network.second)
        beyond = total - np.outer(points * network.second, network.delays)
        for k, line in network.lossy.items():
            if line.constant:  # the difference would be rounding
                beyond[:, k] = line.beyond_delay(points, total[:, k])
        admittances, self.ways = [1 / impedance[:, network.alone]], []
        for k in network.alone.tolist():
            passed = np.exp(-beyond[:, [k]])
            self.ways += [([end], [Way(self.passed[k], [end ^ 1], passed, one)]) for end in (2 * k, 2 * k + 1)]
        for bundle in network.bundles.values():
            fronts = np.array([self.passed[k].delay for k in bundle.lines])
            modes = bundle.modes(points, fronts)
            admittances.append((modes.flow @ modes.inverse).reshape(len(points), -1))
            passed = np.exp(np.outer(points, fronts) - modes.gamma * bundle.length)
            for side in (0, 1):
                here, there = ((2 * bundle.lines + end).tolist() for end in (side, 1 - side))
                each = [
                    Way(self.passed[line], there, modes.inverse[:, k] * passed[:, [k]], modes.vectors[:, :, k])
                    for k, line in enumerate(bundle.lines)
                ]
                self.ways.append((here, each))
        self.admittance = np.concatenate(admittances, axis=1)
        self.beside = [np.flatnonzero(network.pairs[:, 0] == end // 2) for end in range(network.size)]

    def _sent_back(self, group: int, t: float) -> tuple[float, ...]:
        """Shares of small waves that the laws of a group send back at an instant, about."""
        laws = self.laws[group]
        if self.tangents is None:
            return (0.0,) * len(laws)
        slab = min(int(t / self.h + EDGE), len(self.tangents.conductance) - 1)
        seen = self.network.impedances[laws] * self.tangents.conductance[slab, -1, laws]
        return tuple(np.maximum(np.round((1 - seen) / (1 + seen), DIGITS), STEEPEST).tolist())

    def _answers(self, group: int, t: float) -> tuple[NDArray, NDArray]:
        back = self._sent_back(group, t)
        if (group, *back) not in self.answers:
            held, flows = self.answers[(group, *(0.0 for _ in back))]
            laws, share = self.laws[group], np.array(back)
            ports = self.network.ports[laws][:, self.groups[group]]
            more = (-2 * share / (1 + share) / self.network.impedances[laws])[:, None] * ports
            less = flows @ ports.T @ np.linalg.solve(np.eye(len(laws)) + more @ flows @ ports.T, more + 0j)
            self.answers[(group, *back)] = held - less @ held, flows - less @ flows
        return self.answers[(group, *back)]

    def alike(self, path: list[tuple[int, float]], one: float, other: float) -> bool:
        """Whether fronts at two instants meet the same laws on a path, of groups and delays."""
        return all(self._sent_back(g, one + delay) == self._sent_back(g, other + delay) for g, delay in path)

    def of(
        self, source: list[tuple[int, float]], held: bool, t: float, t_end: float, least: float
    ) -> tuple[list[Ray], list[tuple[int, float]]]:
        """The fast-changing rays of a front at t, and its path, by groups and delays.

        The effort at a node is held, or flows are driven into nodes. A wave goes on where |s| > 1/h if it is `least`
        there: else the scene's own slabs follow it.
        """
        same, start = SAME_ARRIVAL * min(line.delay for line in self.passed), int(self.group_of[source[0][0]])
        heap: list[tuple[float, float, int, int]] = [(0.0, 0.0, 0, start)]
        due: dict[tuple[int, int, int], dict[int, NDArray]] = {}
        found: list[Ray] = []
        path: list[tuple[int, float]] = []
        while heap and len(path) < MOST_RAYS:
            delay, rest, moved, group = heappop(heap)
            into = due.pop((group, round(delay / same), round(rest / SAME_ARRIVAL)), {})
            answers = self._answers(group, t + delay)
            if path:
                each = [2 * answers[1][:, :, self._local(end)] * self._flow(end, into)[:, None] for end in into]
            else:
                each = [weight * answers[not held][:, :, self.local[node]] for node, weight in source]
            u = np.sum(each, axis=0)
            path.append((group, delay))
            if self.rows[group]:
                rows = np.array([row for row, _, _ in self.rows[group]])
                seen = [self._seen(u, node, end, into) for _, node, end in self.rows[group]]
                found.append(Ray(delay, moved, rest, rows, np.stack(seen, axis=1)))
            for here, way in self.leaving[group]:
                more, whole, part = way.front
                if part > 1 or t + delay + more >= t_end:
                    continue
                sent = np.stack([u[:, self._local(end)] - into.get(end, 0.0) for end in here], axis=1)
                wave = (way.into * sent).sum(axis=1)
                if np.abs(wave[self.fast]).max() <= least:
                    continue
                there = int(self.group_of[self.network.node_of[way.there[0]]])
                later = delay + more, rest + part, moved + whole, there
                key = there, round(later[0] / same), round(later[1] / SAME_ARRIVAL)
                if key not in due:
                    heappush(heap, later)
                waves = due.setdefault(key, {})
                for end, share in zip(way.there, way.out_of.T, strict=True):
                    waves[end] = waves.get(end, 0.0) + wave * share
        return found, path

    def _local(self, end: int) -> int:
        return int(self.local[self.network.node_of[end]])

    def _flow(self, end: int, waves: dict[int, NDArray]) -> NDArray:
        """Flow of waves, by end, in the direction in which they travel."""
        beside = self.beside[end]
        ends = 2 * self.network.pairs[beside, 1] + end % 2
        each = [self.admittance[:, k] * waves[j] for k, j in zip(beside, ends.tolist(), strict=True) if j in waves]
        return np.sum(each, axis=0)

    def _seen(self, u: NDArray, node: int, end: int, into: dict[int, NDArray]) -> NDArray:
        """Waves of the scene's z0 that arrive at a row and leave it, shape (points, 2), under efforts of its group."""
        if end < 0:
            return np.stack(2 * [u[:, self.local[node]]], axis=1)
        ends = (2 * self.network.pairs[self.beside[end], 1] + end % 2).tolist()
        sums = {j: u[:, self._local(j)] - 2 * into.get(j, 0.0) for j in ends}
        flow = self._flow(end, sums) * self.network.z0[end // 2]
        here = u[:, self.local[node]]
        return np.stack([here - flow, here + flow], axis=1)


def arrivals(description: Description) -> dict[str, NDArray]:
    """Instants until the end of the run at which each node meets a jump, s; none anywhere if they are too many.

    Jumps are those of sources and switches, and all that they become at other nodes, however small.
    """
    groups, nodes = description.grouped()
    names = list(nodes)
    edges = np.cumsum([0, *(len(group.nodes) for group in groups)])
    group_of = {name: g for g, (low, high) in enumerate(pairwise(edges)) for name in names[low:high]}
    ways: list[list[tuple[int, float]]] = [[] for _ in groups]
    for line in description.lines.values():
        near, far = (group_of[name] for name in line.nodes)
        ways[near].append((far, line.delay))
        ways[far].append((near, line.delay))
    heap: list[tuple[float, int]] = []
    for name, node in nodes.items():
        for waveform in (*([] if node.held is None else [node.held]), *(flow for flow, _ in node.flows)):
            changes = changes_of(waveform, description.steady, description.t_end)
            heap += [(float(t), group_of[name]) for t in changes.at[np.abs(changes.jump) > 0.0]]
    for switch in switches_of(description):
        moves = np.empty(0) if switch.law.factor is None else switch.law.factor.breaks(description.t_end)
        heap += [(float(t), group_of[switch.nodes[0]]) for t in moves[moves >= 0]]
    same = SAME_ARRIVAL * min(line.delay for line in description.lines.values())
    heap, found = sorted(heap), [[-np.inf] for _ in groups]
    while heap:
        t, group = heappop(heap)
        if t - found[group][-1] <= same:
            continue
        found[group].append(t)
        if sum(map(len, found)) > MOST_ARRIVALS:
            return dict.fromkeys(names, np.empty(0))
        for far, delay in ways[group]:
            if t + delay < description.t_end:
                heappush(heap, (t + delay, far))
    return {name: np.array(found[group][1:]) for name, group in group_of.items()}
