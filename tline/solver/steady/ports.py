"""Multiports and coupled conductors as linear equations beside the balances of nodes, with lossless lines among them.

All unknowns are of the size of efforts: flows count times an impedance. Where the equations at s = 0 are
underdetermined, those of the first order in s complete them.

References
----------
C.-W. Ho, A. E. Ruehli, P. A. Brennan: The modified nodal approach to network analysis (1975).

Terms at s = 0 of each node, and joins of nodes without a drop: held efforts, flows, conductances; lossless lines.

To the first order in s there are capacities to the reference, and an inertia along each join.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.solver.description.bundle import bundles_of
from tline.solver.description.description import Description
from tline.solver.description.elements import Branch, Ports, admittance, capacitive, conductors, inductive
from tline.solver.description.excitation import just_before
from tline.solver.description.groups import parts
from tline.solver.steady.balance import Limit, Linear, Sparse
from tline.words.wording import first_of, place

NAMED = 4  # elements in a message


class AtNodes(NamedTuple):
    """Terms of each node, shape (nodes,)."""

    given: NDArray  # effort that is held, else nan
    conductance: NDArray  # to the reference
    driven: NDArray  # flow of sources
    capacity: NDArray  # to the reference
    tie: NDArray  # 1/inertia between the node and what holds it: infinite where that is ideal


class Wiring(NamedTuple):
    """Lines between numbered nodes; and joins of these without a steady drop: lossless lines, then inductors."""

    number: dict[str, int]  # of nodes, by name
    ends: NDArray  # (lines, 2), numbers of nodes
    z0: NDArray  # (lines,)
    delay: NDArray
    leak: NDArray  # conductance at each end
    falls: NDArray  # whether effort falls along it
    joined: NDArray  # whether it does not, nor do losses mix its mode with others
    joins: NDArray  # (joins, 2)
    inertia: NDArray  # (joins,)
    names: list[str]  # of the joins that are lines
    part: NDArray  # (nodes,) number of those that are joined


def wiring_of(description: Description) -> Wiring:
    """Lines and joins of a scene."""
    columns, number = description.columns, {name: k for k, name in enumerate(description.nodes)}
    ends = np.array([number[node] for node in columns.nodes])[columns.ends]
    z0, delay, falls = columns.z0, columns.delay, columns.falls
    joined = ~falls
    for bundle in bundles_of(description).values():
        joined[bundle.lines] = False
    shorts = inductive(description.scene)
    pairs = np.array([[number[first], number[second]] for first, second, _ in shorts], int).reshape(-1, 2)
    joins = np.vstack([ends[joined], pairs])
    inertia = np.concatenate([(z0 * delay)[joined], [inertia for *_, inertia in shorts]])
    names = [name for name, kept in zip(description.lines, joined.tolist(), strict=True) if kept]
    part = parts(joins[:, 0], joins[:, 1], len(number))
    return Wiring(number, ends, z0, delay, columns.pi[1], falls, joined, joins, inertia, names, part)


def at_nodes(description: Description, lines: Wiring) -> AtNodes:
    """Balances of all nodes, with half of the leakage and of the storage of a line at each of its ends."""
    n, number = len(lines.number), lines.number
    given, conductance, driven, capacity, tie = np.full(n, np.nan), *np.zeros((4, n))
    for k, node in enumerate(description.nodes.values()):
        switched = node.switched(0.0)
        if node.held is not None:
            given[k], tie[k] = just_before(node.held), np.inf
        elif switched == np.inf:
            given[k], tie[k] = node.above_level, np.inf
        else:
            driven[k], conductance[k] = node.flow_before(), node.conductance + switched
            driven[k] += switched * node.above_level
            if node.load is not None and node.load.at_zero() == 0:  # an inductor: a short, with an inertia
                inertia = node.load.numerator[-2] / node.load.denominator[-1]
                given[k], tie[k] = node.above_level, 1 / inertia if inertia else np.inf
            elif node.load is not None:
                conducted, capacity[k] = admittance(node.load)
                conductance[k] += conducted
                driven[k] += conducted * node.above_level
    for name, effort in description.tanks.items():
        given[number[name]], tie[number[name]] = effort, np.inf
    for end in lines.ends.T:
        conductance += np.bincount(end, lines.leak, n)
        capacity += np.bincount(end, lines.delay / lines.z0 / 2, n)
    return AtNodes(given, conductance, driven, capacity, tie)


class _Equations:
    """Collected entries of A and B, and owners of each equation and unknown: edges first, then nodes.

    Flows are multiplied by the impedance `unit`, s by 1/rate; nodes are numbered from `first` on.
    """

    def __init__(self, names: list[str], first: int, unit: float, rate: float):
        self.names, self.first, self.unit, self.rate = names, first, unit, rate
        self.known = [np.zeros(0)]
        self._all: list[tuple[NDArray, ...]] = []

    def add(self, rows: ArrayLike, columns: ArrayLike, now: ArrayLike = 0.0, slow: ArrayLike = 0.0) -> None:
        """Add entries of A, and of B, at rows and columns that are broadcast."""
        self._all.append(tuple(part.ravel() for part in np.broadcast_arrays(rows, columns, now, slow)))

    def store(self, from_node: int | NDArray, to_node: int | None, capacity: float | NDArray) -> None:
        """Add capacities from nodes to others, or to the reference."""
        for row, sign in ((from_node, 1.0), (to_node, -1.0)):
            for column, other in ((from_node, 1.0), (to_node, -1.0)):
                if row is not None and column is not None:
                    slow = sign * other * capacity * self.unit * self.rate
                    self.add(self.first + row, self.first + column, slow=slow)

    def branch(self, branch: Branch, nodes: NDArray, level: NDArray, inertia: ArrayLike = ()) -> NDArray:
        """Add a branch between nodes of such numbers and efforts without gauge pressure; its flows, then its states.

        The first flows have inertias. Places of the flows among the unknowns behind nodes are returned.
        """
        inert, places = np.arange(np.size(inertia)), sum(map(len, self.known)) + np.arange(len(nodes))
        M, N, E, Q, P, R = branch.ports
        at, flows = self.first + nodes, len(self.names) + np.arange(len(nodes))
        states = len(self.names) + len(nodes) + np.arange(len(Q))
        self.names += [branch.where] * (len(nodes) + len(Q))
        size = np.maximum(np.abs(M).max(axis=1), np.abs(N).max(axis=1) / self.unit)[:, None]
        pace = np.hstack([np.abs(Q), np.abs(P), np.abs(R) / self.unit]).max(axis=1, initial=0.0)[:, None]
        pace[pace == 0.0] = 1.0
        for rows, scale, each in ((flows, size, (M, N, -E)), (states, pace, (P, R, Q))):
            for columns, matrix, of in zip((at, flows, states), each, (1.0, self.unit, 1.0), strict=True):
                self.add(rows[:, None], columns, matrix / scale / of)
            self.known.append(each[0] @ level / scale[:, 0])
        self.add(states, states, slow=-self.rate / pace[:, 0])
        self.add(flows[inert], flows[inert], slow=np.asarray(inertia) * self.rate / self.unit / size[inert, 0])
        self.add(at, flows, 1.0)
        return places

    def joins(self, lines: Wiring) -> NDArray:
        """Add lossless lines and inductors; places of their flows among the unknowns behind nodes."""
        flows = len(self.names) + np.arange(len(lines.inertia))
        for end, sign in zip(lines.joins.T, (1.0, -1.0), strict=True):
            self.add(flows, self.first + end, sign)
            self.add(self.first + end, flows, sign)
        self.add(flows, flows, slow=-lines.inertia * self.rate / self.unit)
        self.names += [place("lines", name) for name in lines.names] + [""] * (len(flows) - len(lines.names))
        self.known.append(np.zeros(len(flows)))
        return sum(map(len, self.known[:-1])) + np.arange(len(flows))

    def ties(self, nodes: NDArray, tie: NDArray, given: NDArray, names: Iterable[str]) -> None:
        """Add inductances between nodes and given efforts."""
        tied = len(self.names) + np.arange(len(nodes))
        self.add(tied, self.first + nodes, 1.0)
        self.add(self.first + nodes, tied, 1.0)
        self.add(tied, tied, slow=-self.rate / tie / self.unit)
        self.names += names
        self.known.append(given)

    def matrices(self, held: NDArray) -> tuple[Sparse, Sparse]:
        """A and B without the balances of held nodes."""
        rows, columns, now, slow = (np.concatenate(part) for part in zip(*self._all, strict=True))
        kept = ~np.isin(rows, self.first + held)
        rows, columns = rows[kept].astype(int), columns[kept].astype(int)
        return Sparse(rows, columns, now[kept]), Sparse(rows, columns, slow[kept])


def branches_with_ports(description: Description) -> list[Branch]:
    """Multiports, and ends of coupled conductors."""
    multiports = {place("links", name) for name in description.multiports}
    found = [branch for branch in description.branches if branch.where in multiports]
    ends = [Branch("", (*end.conductors, *end.modal), conductors(end.modes)) for end in description.ends]
    return [*found, *ends, *_mixing(description)]


def _mixing(description: Description) -> list[Branch]:
    """Modes of coupled conductors that constant losses mix, from end to end, at s = 0."""
    bundles = bundles_of(description)
    if not bundles:  # for an import takes longer than many a run
        return []
    from scipy.linalg import expm

    found = []
    for name, bundle in bundles.items():
        one, none = np.eye(len(bundle.z0)), np.zeros((len(bundle.z0),) * 2)
        rate = np.block([[none, bundle.resistance], [bundle.conductance, none]])
        (A, B), (C, D) = (np.hsplit(half, 2) for half in np.vsplit(expm(-bundle.length * rate), 2))
        M, N = np.block([[-A, one], [-C, none]]), np.block([[-B, none], [-D, -one]])
        states = np.zeros((0, len(M)))
        ports = Ports(M, N, states.T, np.zeros((0, 0)), states, states)
        near, far = (end.modal for end in description.coupled[name])
        found.append(Branch(place("lines", name), (*near, *far), ports))
    return found


def ported(
    description: Description, at: AtNodes, edges: list[str], lines: Wiring, unit: float
) -> tuple[Linear, list[str], NDArray]:
    """The equations; of the edges, which come first, with the inertia of the falling lines among them.

    The first edges are falling lines, with their delays. Returned are also the owners of each equation and unknown, and
    the places of flows among the others: those of joins, then into both ends of modes that losses mix.
    """
    falls, number = lines.delay[lines.falls], lines.number
    rate = 1 / float(np.mean(lines.delay))
    nodes, lossy = list(description.nodes.values()), np.arange(len(falls))
    found = _Equations([*edges, *(f"node '{name}'" for name in number)], len(edges), unit, rate)
    found.add(lossy, lossy, slow=falls * rate)
    found.store(np.arange(len(nodes)), None, at.capacity)
    for (one, other), capacity in capacitive(description.scene):
        found.store(number[one], number[other], capacity)
    mixed, bundles = [], bundles_of(description)
    inertia = {place("lines", name): each.length * each.inductance for name, each in bundles.items()}
    for branch in branches_with_ports(description):
        here = [number[node] for node in branch.nodes]
        level = np.array([branch.to_air * nodes[k].above_level for k in here])
        flows = found.branch(branch, np.array(here), level, inertia.get(branch.where, ()))
        mixed += [flows] if branch.where in inertia else []
    inert = np.flatnonzero((at.tie > 0) & (at.tie < np.inf))
    flows = found.joins(lines)
    found.ties(inert, at.tie[inert], at.given[inert], [nodes[k].load_name for k in inert])
    given = at.given.copy()
    given[inert] = np.nan
    matrices = found.matrices(np.flatnonzero(~np.isnan(given)))
    linear = Linear(given, at.conductance, at.driven, unit, *matrices, np.concatenate(found.known))
    return linear, found.names, np.concatenate([flows, *mixed])


def check_limit(limit: Limit | None, names: list[str], lines: Wiring) -> None:
    """Refuse equations that contradict each other, or leave something open, naming elements."""
    for at, problem in (
        (limit.rows if limit else [], "nothing takes the flow, or efforts contradict each other"),
        (limit.columns if limit else [], "nothing determines its effort or flow"),
    ):
        if not len(at):
            continue
        found = {names[k] for k in at} - {""}
        between = [name.removeprefix("node '").removesuffix("'") for name in found if name.startswith("node '")]
        nodes, pairs = {lines.number[name] for name in between}, zip(lines.names, lines.joins.tolist(), strict=False)
        found |= {place("lines", name) for name, pair in pairs if nodes >= {*pair}}
        known = sorted(found - {""}, key=lambda name: (name.startswith("node "), names.index(name)))
        where, expected = first_of(known, NAMED) or "start", "a resistance in between, or start = 'rest'"
        raise InputError(where, f"no steady state: {problem}", expected)
