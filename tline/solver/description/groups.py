"""Groups of nodes connected without delay, and the circuit between their line ends.

Connected components of graphs, and time scales of waveforms and dynamic loads.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from operator import is_
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.circuit import Circuit, StateSpace, circuit, equations
from tline.solver.description.elements import Branch, PlacedLaw, conductors, lc_sections, one_port
from tline.solver.description.excitation import Shape
from tline.solver.description.given import End
from tline.solver.description.lines import Line
from tline.solver.description.nodes import Node
from tline.words.wording import place


def parts(first: NDArray, second: NDArray, n: int) -> NDArray:
    """Number of the connected part that each of n nodes lies in, for lines from the first nodes to the second."""
    label, before = np.arange(n), np.full(n, -1)  # the least node of a part gives it its label, along the lines
    while (label != before).any():
        before = label.copy()
        least = np.minimum(label[first], label[second])
        np.minimum.at(label, first, least)
        np.minimum.at(label, second, least)
        label = label[label]
    return np.unique(label, return_inverse=True)[1]


class LumpedLine(NamedTuple):
    """A short line as inductors and capacitors; half a capacitor at each end is part of the loads there."""

    name: str
    line: Line
    sections: int
    y: float = 0.0  # before t = 0

    @property
    def states(self) -> int:
        """Inductors and the capacitors between them."""
        return 2 * self.sections - 1


FAST = 3.0  # over the slab's width: poles beyond are not resolved
LONG = 64.0  # delays, so that the steps of that time are too long for what rings in LC sections, but not in lines
ROUNDS = 3  # in which laws find the impedances that they see
OPEN = 1 - 1e-6  # share of a wave that comes back where a law sees next to nothing
SLOW = 1e-9  # share of the largest rate in a circuit that counts as steady
GONE = 20.0  # time constants after which 2e-9 is left


@dataclass(frozen=True, eq=False)
class Group:
    """Nodes connected by branches or laws, or a single node; circuits are cached."""

    nodes: list[Node]
    branches: list[Branch]  # beside the loads
    elements: list[PlacedLaw]
    lumped_lines: list[LumpedLine]
    _circuits: dict[tuple[float, ...], list[Circuit]] = field(default_factory=dict)

    @cached_property
    def dynamic(self) -> bool:
        """Whether it has branches, loads with a state, or switches."""
        for node in self.nodes:
            if node.held is None and (node.load or node.switches):
                return True
        return bool(self.branches)

    @cached_property
    def single(self) -> bool:
        """Whether it is one node with nothing but line ends, resistors, sources and loads: u = (w + its echo)/2."""
        node, beside = self.nodes[0], (self.branches, self.elements, self.nodes[1:])
        if any(beside) or node.held is not None or node.switches or node.dead or node.above_level:
            return False
        return node.load is not None

    @cached_property
    def simple(self) -> bool:
        """Whether the group is one law behind line ends, resistors and sources."""
        return len(self.elements) == 1 and not self.dynamic and not any(node.dead for node in self.nodes)

    @cached_property
    def pockets(self) -> NDArray:
        """Whether each node's effort is determined by laws alone."""
        tied = {int(k) for branch in self.branches for k in branch.nodes}
        alone = (node.dead and not (node.load or node.switches or node.flows) for node in self.nodes)
        return np.array([one and bool(self.elements) and k not in tied for k, one in enumerate(alone)])

    @cached_property
    def loads(self) -> list[Branch]:
        """Loads with a state."""
        return [
            Branch(node.load_name, np.array([k]), one_port(node.reflection, 1 / node.total), to_air=True)
            for k, node in enumerate(self.nodes)
            if node.load is not None and node.held is None
        ]

    @cached_property
    def instants(self) -> list[float]:
        """When switches move, s; not before t = 0."""
        switches = [switch for node in self.nodes for switch in node.switches]
        switches += [branch.switch for branch in self.branches if branch.switch is not None]
        return sorted({float(switch.time) for switch in switches if switch.time >= 0})

    def circuit(self, t: float, impedances: Sequence[float] = ()) -> Circuit:
        """The circuit just before an instant.

        Its laws are behind impedances; without these it has none.
        """
        if self.single:
            A, b, c, d = self.nodes[0].reflection
            return Circuit(StateSpace(A, b, c / 2, (1.0 + d) / 2), np.arange(len(A)))
        branches = [*self.loads, *(branch.before(t) for branch in self.branches)]
        return circuit(self.nodes, branches, self.ports(impedances), [node.switched(t) for node in self.nodes])

    @cached_property
    def always(self) -> StateSpace:
        """State space from waves of the nodes to their efforts, without moving switches and laws."""
        return (self.circuit(np.inf) if self.single else self.circuits()[-1]).system

    def circuits(self, impedances: Sequence[float] = ()) -> list[Circuit]:
        """Circuits before the first switching instant and after each; without impedances they have no laws."""
        key = tuple(impedances)
        if key not in self._circuits:
            self._circuits[key] = [self.circuit(t, impedances) for t in (*self.instants, np.inf)]
        return self._circuits[key]

    @cached_property
    def poles(self) -> NDArray | None:
        """Poles in all positions of its switches while its laws let nothing pass; None without states or efforts."""
        if not any(len(branch.ports.Q) for branch in (*self.loads, *self.branches)):
            return None
        try:
            systems = [circuit.system for circuit in self.circuits()]
        except InputError:
            if not self.elements:
                raise
            return None  # only laws tie some efforts
        return np.concatenate([poles_of(system) for system in systems])

    @cached_property
    def _alone(self) -> list[float]:
        """Impedances at the laws' ports with resistors alone at their nodes."""
        nodes = {node.name: node for node in self.nodes}
        return [element.seen(nodes) for element in self.elements]

    @cached_property
    def _initial(self) -> Circuit:
        """Circuit at t = 0, with the laws behind these impedances."""
        return self.circuit(0.0, self._alone) if self.elements else self.circuits()[0]

    def ports(self, impedances: Sequence[float]) -> list[tuple[int, int, float]]:
        """Ports of the laws: positions of their nodes, -1 for the reference, and the impedances in front of them."""
        at = {node.name: k for k, node in enumerate(self.nodes)} | {None: -1}
        each = zip(self.elements, impedances, strict=bool(impedances))
        return [(at[e.from_node], at[e.to_node], z) for e, z in each]

    def matched(self, rate: float) -> list[float]:
        """Impedances matched to the circuit at its laws' ports, for signals of a rate, 1/s, all laws being matched."""
        if not self.elements or self.simple:
            return self._alone if self.elements else []
        seen = np.array(self._alone)
        A, B, C, D = self._initial.system
        k = len(self.nodes)
        fastest = max(rate, SLOW * np.abs(A).max(initial=0.0)) or 1.0
        whole = C @ np.linalg.solve(fastest * np.eye(len(A)) - A, B) + D if len(A) else D
        first = whole[k:, k:]  # from waves behind these impedances to efforts, Z/(Z + z)
        other = np.eye(len(seen)) - first
        now: NDArray = first
        z: NDArray = seen
        for _ in range(ROUNDS):
            share = np.clip(np.diag(now), 1 - OPEN, OPEN)
            z = np.where(share == OPEN, z, np.maximum(z * share / (1 - share), (1 - OPEN) * seen))
            now = first @ np.linalg.inv(first + (z / seen)[:, None] * other)  # the same behind others
        return z.tolist()

    def settles(self, h: float) -> float:
        """Time, s, in which oscillations of lumped lines that are faster than slabs of width h decay."""
        if not self.lumped_lines:
            return 0.0
        poles = np.linalg.eigvals(self.circuit(0.0).system.A)
        decay = -float(poles.real[np.abs(poles) * h > FAST].max(initial=-np.inf))
        return max(GONE / decay, LONG * max(lumped.line.delay for lumped in self.lumped_lines)) if decay > 0 else np.inf

    def at_rest(self) -> NDArray:
        """State while the liquid is at rest."""
        own = [node.state_at_rest() for node in self.nodes if node.load is not None and node.held is None]
        if self.single:
            return own[0]
        return self._kept(np.concatenate([np.zeros(0), *own]))

    def at_rest_under(
        self, waves: Mapping[str, float], efforts: Mapping[str, float], through: Mapping[str, float]
    ) -> NDArray:
        """Steady state under Thévenin waves of the nodes, which leads to efforts there and to flows through elements.

        Where inductors form loops, that of the least flows; but lumped lines carry theirs.
        """
        branches = [*self.loads, *(branch.before(0.0) for branch in self.branches)]
        k, n, unit = len(self.nodes), len(self.elements), self.nodes[0].alone
        w, u = (np.array([values[node.name] for node in self.nodes]) for values in (waves, efforts))
        passed = np.array([through.get(element.where, 0.0) for element in self.elements]) / unit
        F, G, H, Q, L = equations(
            self.nodes, branches, self.ports(n * [1.0]), [node.switched(0.0) for node in self.nodes]
        )
        of_branches, at = slice(k, len(F) - n), np.arange(len(F) - n)
        size = np.maximum(np.abs(Q).max(axis=1, initial=0.0), np.abs(L).max(axis=1, initial=0.0))[:, None]
        size[size == 0.0] = 1.0
        system: NDArray = np.block([[F[at, of_branches], -G[at]], [L[:, of_branches] / size, Q / size]])
        known = H[at, :k] @ w - F[at, :k] @ u - F[at, len(F) - n :] @ passed
        given: NDArray = np.concatenate([known, -(L[:, :k] / size) @ u])
        column = 0
        for branch in branches:
            for flow in branch.flows:
                system = np.vstack([system, np.arange(system.shape[1]) == column])
                given, column = np.append(given, flow / unit), column + 1
            column += len(branch.nodes) - len(branch.flows)
        if len(Q) > sum(len(branch.ports.Q) for branch in branches):  # the last one is always 1
            given, system = given - system[:, -1], system[:, :-1]
        return self._kept(np.linalg.lstsq(system, given)[0][len(F) - n - k :])

    def _kept(self, states: NDArray) -> NDArray:
        """Select the circuit's states from those of all branches (zero where not given) and a final 1."""
        number = sum(len(branch.ports.Q) for branch in (*self.loads, *self.branches))
        full = np.append(np.zeros(number), 1.0)
        full[: len(states)] = states
        return full[self._initial.kept]


def poles_of(system: StateSpace) -> NDArray:
    """Poles of a state space, 1/s."""
    return system.A[0] if len(system.A) == 1 else np.linalg.eigvals(system.A)


def regrouped(groups: Sequence[Group], nodes: Mapping[str, Node], elements: Sequence[PlacedLaw]) -> list[Group]:
    """Update groups to changed nodes and laws; unchanged groups are kept."""
    at = {element.where: element for element in elements}
    found = []
    for group in groups:
        here, laws = [nodes[node.name] for node in group.nodes], [at[element.where] for element in group.elements]
        same = all(map(is_, here, group.nodes)) and laws == group.elements
        found.append(group if same else Group(here, group.branches, laws, []))
    return found


def grouped(
    nodes: dict[str, Node],
    lumped_lines: Sequence[LumpedLine],
    elements: Sequence[PlacedLaw],
    coupled_ends: Sequence[End],
    branches: Sequence[Branch],
) -> tuple[list[Group], dict[str, Node]]:
    """Groups of the nodes that lumped or coupled lines, branches or elements join, and the nodes in their order."""
    placed = [
        *branches,
        *(
            Branch(place("lines", one.name), one.line.nodes, lc_sections(one.line, one.sections), (one.y, -one.y))
            for one in lumped_lines
        ),
        *(Branch("", (*end.conductors, *end.modal), conductors(end.modes)) for end in coupled_ends),
    ]
    if not placed and not elements:
        return [Group([node], [], [], []) for node in nodes.values()], nodes
    names, number = list(nodes), {name: k for k, name in enumerate(nodes)}
    pairs = [[number[one.nodes[0]], number[at]] for one in (*placed, *elements) for at in one.nodes]
    first, second = np.array(pairs).T
    part = parts(first, second, len(names))
    order = np.argsort(part, kind="stable")
    at = np.argsort(order) - np.searchsorted(part[order], part)  # of each node in its group
    groups = [Group([], [], [], []) for _ in range(part.max() + 1)]
    for k in order:
        groups[part[k]].nodes.append(nodes[names[k]])
    for element in elements:
        groups[part[number[element.nodes[0]]]].elements.append(element)
    for one in placed:
        here = [number[node] for node in one.nodes]
        groups[part[here[0]]].branches.append(one._replace(nodes=at[here]))
    for lumped in lumped_lines:
        groups[part[number[lumped.line.nodes[0]]]].lumped_lines.append(lumped)
    return groups, {names[k]: nodes[names[k]] for k in order}


def time_scales(waveforms: Mapping[str, Shape], groups: Iterable[Group]) -> dict[str, tuple[float, float]]:
    """Shortest time scale of each curved waveform and dynamic circuit, and that of its oscillations, s."""
    scales = {where: (waveform.fastest(), waveform.fastest()) for where, waveform in waveforms.items()}
    for group in groups:
        if group.poles is not None:
            poles, where = group.poles, next(b.where for b in (*group.loads, *group.branches) if len(b.ports.Q))
            ringing = poles[np.abs(np.imag(poles)) > np.abs(np.real(poles))]
            scales[where] = (_shortest(poles), _shortest(ringing))
    return scales


def filling_times(elements: Iterable[PlacedLaw], nodes: Mapping[str, Node], pressure: float) -> list[float]:
    """Times in which vessels and tanks fill through all else at their nodes, at a piezometric pressure, s."""
    times = []
    for element in elements:
        capacity = element.kind.capacity(element.constants, pressure)
        if capacity:
            ends = [nodes[name] for name in element.nodes]
            times.append(capacity * sum(1 / end.total for end in ends if end.held is None))
    return times


def _shortest(poles: NDArray) -> float:
    """Time scale of the fastest pole, s; infinite without poles."""
    fastest = float(np.abs(poles).max(initial=0.0))
    return 1 / fastest if fastest else inf
