"""Energy accounts of one group of nodes: powers of its elements, from the waves at its line ends.

Some flows into elements follow from those of the lines alone.

At each node of a group the flow from lines, less that into conductances and sources, is the remainder r. Where only
one element has a port at a node, its flow is r; the flow of an element between two nodes is then known at the
other as well; and so on. Elements whose flows cannot be separated in this way share an account.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import projected
from tline.solver.description.given import (
    Between,
    Matched,
    RationalImpedance,
    Reservoir,
    Resistor,
    Shape,
    Short,
    Switch,
)
from tline.solver.description.groups import Group, parts
from tline.solver.description.nodes import Node, lowered
from tline.solver.radau import Basis, thin_product
from tline.words.wording import place

COLUMNS = ("supplied", "dissipated", "stored", "taken", "unaccounted")  # of a ledger
GRAVITY = "gravity"  # account of outflow to the open air below the highest node
SUPPLIED, DISSIPATED, STORED, TAKEN, UNACCOUNTED = range(5)  # the first four: what an element is expected to do


class Member(NamedTuple):
    """Element whose flow follows from that of the lines, or that prescribes the effort of a node."""

    where: str
    nodes: tuple[str, ...]
    column: int
    may_give: bool
    through: bool = False  # whether the flow into one node leaves at the other
    to_air: bool = True  # whether it leads from its nodes to the open air at their heights
    series: float = 0.0  # resistance that the flow passes
    beside: float = 0.0  # conductance beside the rest
    conductance: float = 0.0  # of a resistor between two nodes


class Conductor(NamedTuple):
    """A resistor at a node, a switch that is never shut without one, or a source: with a resistance, or of flow."""

    where: str
    node: str
    conductance: float
    switch: Switch | None = None
    effort: Shape | None = None  # behind the conductance, in place of the open air
    flow: Shape | None = None  # beside it


def inventory_of(description: Description, group: Group) -> tuple[list[Member], list[Conductor]]:
    """Sort the elements at the nodes of a group; beside a prescribed effort only known conductances are included."""
    found = [one for node in group.nodes for one in _at_node(node, description.steady)]
    members = [one for one in found if isinstance(one, Member)]
    between = {place(*at): element for at, element in description.scene.placed if isinstance(element, Between)}
    for branch in group.branches:
        nodes = tuple(group.nodes[p].name for p in branch.nodes)
        may_give = description.steady or branch.where in description.active
        members.append(_linear(branch.where, nodes, between.get(branch.where), may_give, branch.to_air))
    for element in group.elements:  # a valve, pump, vessel, diode or table; beyond a valve may be a pressure
        kind, back = element.kind, element.law.constants[0] if element.to_node is None else 0.0
        column = SUPPLIED if kind.supplies else TAKEN if kind.returns or back else DISSIPATED
        nodes, through = tuple(element.nodes), len(element.nodes) == 2
        members.append(Member(element.where, nodes, column, column != DISSIPATED, through, to_air=not through))
    return members, [one for one in found if isinstance(one, Conductor)]


def _at_node(node: Node, steady: bool) -> Iterator[Member | Conductor]:
    name = node.name
    for where, source in node.sources.items():
        if np.isinf(source.conductance):
            yield Member(where, (name,), SUPPLIED, True, to_air=False)
        elif source.is_effort:
            yield Conductor(where, name, source.conductance, effort=lowered(source.value, node.height.level))
        else:
            yield Conductor(where, name, source.conductance, flow=source.value)
    for where, load in node.loads.items():
        match load:
            case Resistor() if load.resistance > 0:
                yield Conductor(where, name, float(1 / load.resistance))
            case Switch() if load.before > 0 and load.after > 0:
                yield Conductor(where, name, 0.0, load)
            case Matched():
                yield Conductor(where, name, node.lines + node.lumped)
            case Short() | Resistor() | Switch():
                yield Member(where, (name,), DISSIPATED, False)
            case Reservoir():
                yield Member(where, (name,), SUPPLIED, True, to_air=False)
            case RationalImpedance() if node.held is None:
                column = STORED if load.stores else TAKEN
                yield Member(where, (name,), column, steady, series=load.series, beside=load.beside)


def _linear(where: str, nodes: tuple[str, ...], link: Between | None, may_give: bool, to_air: bool) -> Member:
    if link is None and where.startswith("sources."):
        return Member(where, nodes[:2], SUPPLIED, True, through=True, to_air=False)
    if not isinstance(link, RationalImpedance | Switch):
        return Member(where, nodes, TAKEN, may_give, to_air=to_air)
    if isinstance(link, Switch) or link.ratio.degree == 0:
        r = 0.0 if isinstance(link, Switch) else link.ratio.at_zero()
        conductance = 1 / r if r else 0.0
        return Member(where, nodes, DISSIPATED, may_give, through=True, to_air=False, conductance=conductance)
    column, series, beside = STORED if link.stores else TAKEN, link.series, link.beside
    return Member(where, nodes, column, may_give, through=True, to_air=False, series=series, beside=beside)


class Port(NamedTuple):
    """A port of an element at a node."""

    element: int
    node: int
    twin: int = -1  # the port at which the same flow leaves the element


def _sums(shares: NDArray, values: NDArray) -> NDArray:
    """Weighted sums of values along their first axis."""
    n, m, s = values.shape
    sums = thin_product(values.reshape(n, m * s).T, shares.T)
    return np.ascontiguousarray(sums.T).reshape(len(shares), m, s)


class Flows(NamedTuple):
    """Flows from nodes into elements, as linear combinations of the remainders r and the efforts u of nodes."""

    shares: NDArray  # (rows, 2 nodes) of r, then u
    node: NDArray  # (rows,) node that each flow leaves
    elements: list[tuple[int, ...]]  # elements that each flow enters; empty where a remainder must vanish


def flows_of(ports: Sequence[Port], n: int, conductances: Mapping[int, float]) -> Flows:
    """Flows of the ports at n nodes.

    Where the balances of nodes do not tell the flow of a resistor between two of them, its conductance does.

    Examples
    --------
    Two nodes with a valve between them; at the second there is a vessel too.

    >>> flows = flows_of([Port(0, 0, 1), Port(0, 1, 0), Port(1, 1)], 2, {})
    >>> flows.shares[:, :2].tolist(), flows.elements
    ([[1.0, 0.0], [-1.0, 0.0], [1.0, 1.0]], [(0,), (0,), (1,)])
    """
    known, told, unknown = _followed(ports, n, conductances)
    pairs = [(min(elements), element) for elements in unknown for element in elements]
    first, second = np.array(pairs, int).reshape(-1, 2).T
    part = parts(first, second, 1 + max((port.element for port in ports), default=-1))
    part_of = [tuple(np.flatnonzero(part == own).tolist()) for own in part]
    rows = [(known[p], port.node, part_of[port.element]) for p, port in enumerate(ports) if p in known]
    for k in range(n):
        if k not in told:
            left = np.eye(n, 2 * n)[k] - sum(known[p] for p, port in enumerate(ports) if p in known and port.node == k)
            rows.append((left, k, part_of[min(unknown[k])] if unknown[k] else ()))
    shares, node, elements = zip(*rows, strict=True)
    return Flows(np.array(shares), np.array(node, int), list(elements))


def _followed(
    ports: Sequence[Port], n: int, conductances: Mapping[int, float]
) -> tuple[dict[int, NDArray], set[int], list[set[int]]]:
    """Known flows by port, the nodes whose balance gave them, and the elements of unknown flow at each node."""
    known: dict[int, NDArray] = {}
    told: set[int] = set()
    waiting = [{p for p, port in enumerate(ports) if port.node == k} for k in range(n)]
    by_size = sorted(conductances, key=lambda element: conductances[element])
    free = [p for element in by_size for p, port in enumerate(ports) if port.element == element]

    def tell(p: int, flow: NDArray) -> None:
        """Take note of a flow, and of the same at the other node."""
        known[p] = flow
        waiting[ports[p].node].discard(p)
        twin = ports[p].twin
        if twin >= 0 and twin not in known:
            tell(twin, 0.0 - flow)

    while True:
        ready = [k for k in range(n) if len(waiting[k]) == 1 and k not in told]
        if ready:
            (p,) = waiting[ready[0]]
            others = (known[q] for q, port in enumerate(ports) if port.node == ready[0] and q in known)
            told.add(ready[0])
            tell(p, np.eye(n, 2 * n)[ready[0]] - sum(others, np.zeros(2 * n)))
        elif ohmic := [p for p in free if p not in known]:
            one, other = ports[ohmic[0]].node, ports[ports[ohmic[0]].twin].node
            tell(ohmic[0], conductances[ports[ohmic[0]].element] * (np.eye(2 * n)[n + one] - np.eye(2 * n)[n + other]))
        else:
            return known, told, [{ports[p].element for p in left} for left in waiting]


class Columns(NamedTuple):
    """Time intervals of integration: whole slabs, one after the other, or pieces of slabs."""

    basis: Basis
    h: float
    slab: NDArray  # (m,)
    span: NDArray | None = None  # (m, 2) start and end in slab time; None for whole slabs

    @property
    def width(self) -> NDArray:
        """Widths of the intervals, s; shape (m,)."""
        return np.full(len(self.slab), self.h) if self.span is None else self.h * (self.span[:, 1] - self.span[:, 0])

    @property
    def middle(self) -> NDArray:
        """Midpoints of the intervals, s; shape (m,)."""
        return self.h * (self.slab + (0.5 if self.span is None else self.span.mean(axis=1)))

    def values(self, shape: Shape) -> NDArray:
        """Values of a waveform at the points of each interval; shape (m, s)."""
        if self.span is None:
            return projected(shape, self.basis, self.h, int(self.slab[0]), len(self.slab))
        start = self.middle - self.width / 2
        return shape.value(start[:, None] + self.width[:, None] * self.basis.c, self.middle[:, None])

    def integral(self, x: NDArray) -> NDArray:
        """Exact integral over each interval of polynomials, and of products of two; shapes (…, m, s) to (…, m)."""
        return thin_product(x, self.basis.A[-1]) * self.width


class Accounts(NamedTuple):
    """Energy accounts of a group; node numbers count within the group."""

    where: list[str]  # of each account
    may_give: list[bool]
    places: NDArray  # (rows,) numbers of the line ends here, and of nodes without one, which count behind all ends
    admittance: NDArray  # (rows,) 1/z0, zero for nodes
    heads: NDArray  # (nodes,) a row of each
    gathers: NDArray  # (nodes, rows) from w - o to flows into the nodes
    conductors: list[tuple[int, Conductor]]  # with their nodes; these accounts are the first
    flows: Flows
    posts: list[tuple[int, int, Member | None]]  # account and column of each flow; its member if there is one only
    above_level: NDArray  # (nodes,) effort at zero gauge pressure
    falls: NDArray  # (flows,) effort at zero gauge pressure if all the flow leaves to the open air, else 0
    gravity: int  # account of outflow to the open air below the level

    def energies(self, w: NDArray, o: NDArray, columns: Columns) -> tuple[NDArray, NDArray]:
        """Energies in each time interval, J.

        Waves w arrive and o leave, shape (rows, m, s), both the effort at nodes. Returned are energies out of lines
        (rows, m), and into accounts (accounts, columns of a ledger, m).
        """
        integral = columns.integral
        found = np.zeros((len(self.where), len(COLUMNS), len(columns.slab)))
        u, rest = (w[self.heads] + o[self.heads]) / 2, _sums(self.gathers, w - o)
        for account, (node, one) in enumerate(self.conductors):
            g, level, switch = np.full(len(columns.slab), one.conductance), self.above_level[node], one.switch
            if switch is not None:  # one that moves inside an interval moves at its nearest edge
                g = np.where(columns.middle < switch.time, 1 / float(switch.before), 1 / float(switch.after))
            behind = level if one.effort is None else columns.values(one.effort)
            drop = behind - u[node]
            rest[node] += g[:, None] * drop
            found[account, DISSIPATED] += g * integral(drop * drop)
            if one.effort is not None:
                found[account, SUPPLIED] += g * integral(behind * drop)
            elif level:
                found[self.gravity, SUPPLIED] += level * g * integral(drop)
            if one.flow is not None:
                flow = columns.values(one.flow)
                rest[node] += flow
                found[account, SUPPLIED] += integral(flow * u[node])
        flows = _sums(self.flows.shares, np.concatenate([rest, u]))
        for flow, node, falls, (account, column, member) in zip(
            flows, self.flows.node, self.falls, self.posts, strict=True
        ):
            effort = u[node] - falls
            power = integral(effort * flow)
            found[account, column] += -power if column == SUPPLIED else power
            if falls:
                found[self.gravity, SUPPLIED] -= falls * integral(flow)
            if member is not None and (member.series or member.beside):
                burnt = member.series * integral(flow * flow) + member.beside * integral(effort * effort)
                found[account, DISSIPATED] += burnt
                found[account, STORED] -= burnt
        return integral((w - o) * (w + o)) * self.admittance[:, None] / 4, found


def accounts_of(description: Description, group: Group, z0: NDArray, inner: Mapping[str, int]) -> Accounts:
    """Open the accounts of a group; `inner` has the places of nodes without line ends."""
    members, conductors = inventory_of(description, group)
    nodes = [node for node in group.nodes if not node.hidden]
    number = {node.name: k for k, node in enumerate(nodes)}
    each = [node.ends or [inner[node.name]] for node in nodes]
    places, at = np.concatenate(each).astype(int), np.repeat(np.arange(len(nodes)), list(map(len, each)))
    admittance = np.append(1 / np.repeat(z0, 2), np.zeros(len(inner)))[places]
    gathers = (at == np.arange(len(nodes))[:, None]) * admittance / 2
    ports: list[Port] = []
    for e, member in enumerate(members):
        first = len(ports)
        ports += [Port(e, number[node], first + 1 - k if member.through else -1) for k, node in enumerate(member.nodes)]
    flows = flows_of(ports, len(nodes), {e: one.conductance for e, one in enumerate(members) if one.conductance})
    where = [one.where for one in conductors]
    may_give = [one.effort is not None or one.flow is not None for one in conductors]
    above_level = np.array([node.above_level for node in nodes])
    falls = np.zeros(len(flows.node))
    posts: list[tuple[int, int, Member | None]] = []
    opened: dict[tuple[int, ...], int] = {}
    for k, (elements, node) in enumerate(zip(flows.elements, flows.node, strict=True)):
        here = [members[e] for e in elements]
        if not here:
            posts.append((len(where), UNACCOUNTED, None))
            where.append(f"node '{nodes[node].name}'")
            may_give.append(True)
            continue
        to_air = all(member.to_air for member in here)
        falls[k] = above_level[node] if to_air else 0.0
        if elements not in opened:
            opened[elements] = len(where)
            where.append(" and ".join(member.where for member in here))
            lifts = not to_air and any(member.to_air and above_level[number[member.nodes[0]]] for member in here)
            may_give.append(lifts or any(member.may_give for member in here))
        alone = here[0] if len(here) == 1 else None
        posts.append((opened[elements], alone.column if alone else TAKEN, alone))
    if above_level.any():
        where.append(GRAVITY)
        may_give.append(True)
    heads = np.unique(at, return_index=True)[1]
    by_node = [(number[one.node], one) for one in conductors]
    last = len(where) - 1
    return Accounts(
        where, may_give, places, admittance, heads, gathers, by_node, flows, posts, above_level, falls, last
    )
