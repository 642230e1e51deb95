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
from tline.solver.convolution.laws import Tangents
from tline.solver.convolution.nodal import LinearRest
from tline.solver.description.bundle import Bundle
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.description.laws import switches_of

MOST_RAYS = 100  # rays of one source
SAME_ARRIVAL = 1e-9  # of the shortest delay; nearer arrivals, of rays by paths that are moved alike, are one
MOST_ARRIVALS = 10_000  # arrivals


class Ray(NamedTuple):
    """Waves at a group of nodes that arrive a fixed time after a front of a source."""

    delay: float  # s
    moved: int  # whole slabs of the delay by which waves are moved
    rest: float  # slabs of the delay that are a part of exp(-sT)
    rows: NDArray  # (rows,) of the record
    waves: NDArray  # (points, rows, 2) waves that arrive there and that leave, without the delay


class Side(NamedTuple):
    """Ends of a line, or of conductors that mix, at one group of nodes; k waves leave on k ways."""

    ends: NDArray  # (k,)
    group: int
    nodes: NDArray  # (k,) places in the group
    fronts: list[tuple[float, int, float]]  # in lines: delay, s, whole slabs by which waves are moved, and the rest
    admittance: NDArray  # (points, k, k)
    into: NDArray  # (points, k, k) waves on ways, of those that leave the ends
    out_of: NDArray  # (points, k, k) waves at the other ends, of those on ways


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
        self.passed = [(delay, int(slabs), delay / h - slabs) for delay, slabs in each]  # of each line, as of `Side`
        self.groups = [at for at, _ in network.groups]
        self.group_of, self.local = np.empty(len(network.names), int), np.empty(len(network.names), int)
        for group, at in enumerate(self.groups):
            self.group_of[at], self.local[at] = group, np.arange(len(at))
        self.sides: list[Side] = []  # the other side of one is beside it
        admittances = [self._of_lines(points), *(self._of_bundle(points, each) for each in network.bundles.values())]
        admittance = np.concatenate(admittances, axis=1)
        matrix, p = network.system(points * network.second, (admittance, np.zeros(admittance.shape)))
        unknown, known_by = p.shape[1], network.known_by
        held = known_by @ np.linalg.inv(matrix)[:, :unknown, :unknown]
        answers = held @ (p[:, :, None] * known_by.T)
        self.laws = [np.flatnonzero(network.ports[:, at].any(axis=1)) for at in self.groups]
        self.answers: dict[tuple[float, ...], tuple[NDArray, NDArray]] = {
            (group, *(0.0 for _ in laws)): (held[:, at][:, :, network.place[at]], answers[:, at][:, :, at])
            for group, (at, laws) in enumerate(zip(self.groups, self.laws, strict=True))
        }  # efforts in a group under one that is held, and under flows, by the shares that its laws send back
        self.leaving = [[k for k, side in enumerate(self.sides) if side.group == g] for g in range(len(self.groups))]
        place = {int(end): (k, j) for k, side in enumerate(self.sides) for j, end in enumerate(side.ends)}
        self.rows: list[list[tuple[int, int, tuple[int, int] | None]]] = [[] for _ in self.groups]
        for row, (node, end) in enumerate(rows):
            self.rows[self.group_of[node]].append((row, int(self.local[node]), place.get(end)))

    def _of_lines(self, points: NDArray) -> NDArray:
        """Admittances of single lines, (points, lines), whose sides are noted."""
        network = self.network
        total, impedance = network.propagation(points * network.second)
        beyond = total - np.outer(points * network.second, network.delays)
        for k, line in network.lossy.items():
            if line.constant:  # the difference would be rounding
                beyond[:, k] = line.beyond_delay(points, total[:, k])
        passed, one = np.exp(-beyond)[:, :, None, None], np.ones((len(points), 1, 1))
        for k in network.alone.tolist():
            self._note(np.array([k]), 1 / impedance[:, k, None, None], passed[:, k], one)
        return 1 / impedance[:, network.alone]

    def _of_bundle(self, points: NDArray, bundle: Bundle) -> NDArray:
        """Admittances of all pairs of conductors that mix, (points, pairs), whose sides are noted."""
        fronts = np.array([self.passed[k][0] for k in bundle.lines])
        modes = bundle.modes(points, fronts)
        passed = np.exp(np.outer(points, fronts) - modes.gamma * bundle.length)
        admittance = modes.flow @ modes.inverse
        self._note(bundle.lines, admittance, passed[:, :, None] * modes.inverse, modes.vectors)
        return admittance.reshape(len(points), -1)

    def _note(self, lines: NDArray, admittance: NDArray, into: NDArray, out_of: NDArray) -> None:
        for ends in (2 * lines, 2 * lines + 1):
            nodes = self.network.node_of[ends]
            where = ends, int(self.group_of[nodes[0]]), self.local[nodes]
            self.sides.append(Side(*where, [self.passed[k] for k in lines], admittance, into, out_of))

    def _sent_back(self, group: int, t: float) -> tuple[float, ...]:
        """Shares of small waves that the laws of a group send back at an instant, about."""
        laws = self.laws[group]
        if self.tangents is None:
            return (0.0,) * len(laws)
        slab = min(int(t / self.h + EDGE), len(self.tangents.conductance) - 1)
        seen = self.network.impedances[laws] * self.tangents.conductance[slab, -1, laws]
        return tuple(((1 - seen) / (1 + seen)).tolist())

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
        same, start = SAME_ARRIVAL * min(delay for delay, *_ in self.passed), int(self.group_of[source[0][0]])
        heap: list[tuple[float, float, int, int]] = [(0.0, 0.0, 0, start)]
        due: dict[tuple[int, int, int], dict[int, NDArray]] = {}  # waves, (points, k) at each side
        found: list[Ray] = []
        path: list[tuple[int, float]] = []
        while heap and len(path) < MOST_RAYS:
            delay, rest, moved, group = heappop(heap)
            into = due.pop((group, round(delay / same), round(rest / SAME_ARRIVAL)), {})
            answers = self._answers(group, t + delay)
            if path:
                sides = [(self.sides[k], wave) for k, wave in into.items()]
                each = [2 * _of(answers[1][:, :, side.nodes], _of(side.admittance, wave)) for side, wave in sides]
            else:
                each = [weight * answers[not held][:, :, self.local[node]] for node, weight in source]
            u = np.sum(each, axis=0)
            path.append((group, delay))
            if self.rows[group]:
                rows = np.array([row for row, _, _ in self.rows[group]])
                found.append(Ray(delay, moved, rest, rows, self._seen(u, group, into)))
            for k in self.leaving[group]:
                side = self.sides[k]
                waves = _of(side.into, u[:, side.nodes] - into.get(k, 0.0))
                strong = np.abs(waves[self.fast]).max(axis=0) > least
                for way in np.flatnonzero(strong).tolist():
                    more, whole, part = side.fronts[way]
                    if part > 1 or t + delay + more >= t_end:
                        continue
                    later = delay + more, rest + part, moved + whole, self.sides[k ^ 1].group
                    key = later[3], round(later[0] / same), round(later[1] / SAME_ARRIVAL)
                    if key not in due:
                        heappush(heap, later)
                    there = due.setdefault(key, {})
                    there[k ^ 1] = there.get(k ^ 1, 0.0) + waves[:, [way]] * side.out_of[:, :, way]
        return found, path

    def _seen(self, u: NDArray, group: int, into: dict[int, NDArray]) -> NDArray:
        """Waves of the scene's z0 that arrive at rows of a group and leave, (points, rows, 2), under its efforts."""
        flows = {}
        for k in {place[0] for *_, place in self.rows[group] if place}:
            side = self.sides[k]
            flows[k] = self.network.z0[side.ends // 2] * _of(side.admittance, u[:, side.nodes] - 2 * into.get(k, 0.0))
        flow = [flows[place[0]][:, place[1]] if place else 0.0 * u[:, 0] for *_, place in self.rows[group]]
        here = u[:, [node for _, node, _ in self.rows[group]]]
        return here[:, :, None] + np.stack(flow, axis=1)[:, :, None] * np.array([-1.0, 1.0])


def _of(matrices: NDArray, vectors: NDArray) -> NDArray:
    """Product at each point."""
    return (matrices @ vectors[:, :, None])[:, :, 0]


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
