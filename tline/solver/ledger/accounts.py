"""Energy accounts of one group of nodes: powers of its elements, from the waves at its line ends.

Some flows into elements follow from those of the lines alone.

At each node of a group the flow from lines, less that into conductances and sources, is the remainder r. Where only
one element has a port at a node, its flow is r; the flow of an element between two nodes is then known at the
other as well; and so on. Elements whose flows cannot be separated in this way share an account.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.excitation import broken
from tline.solver.description.given import Shape
from tline.solver.description.groups import parts
from tline.solver.description.inventory import (
    DISSIPATED,
    STORED,
    SUPPLIED,
    TAKEN,
    Excitation,
    Inventory,
    Member,
    Resistive,
)
from tline.solver.description.nodes import Node
from tline.solver.ledger.ledger import COLUMNS, GRAVITY, UNACCOUNTED
from tline.solver.radau import Basis, thin_product


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
    """Flows from nodes into elements, as linear combinations of the remainders r."""

    shares: NDArray  # (rows, nodes) rows @ r are flows
    node: NDArray  # (rows,) node that each flow leaves
    elements: list[tuple[int, ...]]  # elements that each flow enters; empty where a remainder must vanish


def flows_of(ports: Sequence[Port], seen: Sequence[bool]) -> Flows:
    """Flows of a group's ports.

    Where a node's effort is unknown, the remainder is of no use, and the elements there share an account.

    Examples
    --------
    Two nodes with a valve between them; at the second there is a vessel too.

    >>> flows = flows_of([Port(0, 0, 1), Port(0, 1, 0), Port(1, 1)], [True, True])
    >>> flows.shares.tolist(), flows.elements
    ([[1.0, 0.0], [-1.0, 0.0], [1.0, 1.0]], [(0,), (0,), (1,)])
    """
    n = len(seen)
    known, told, unknown = _followed(ports, n)
    together = [*unknown, *({port.element for port in ports if port.node == k} for k in range(n) if not seen[k])]
    pairs = [(min(elements), element) for elements in together for element in elements]
    first, second = np.array(pairs, int).reshape(-1, 2).T
    part = parts(first, second, 1 + max((port.element for port in ports), default=-1))
    part_of = [tuple(np.flatnonzero(part == own).tolist()) for own in part]
    shares, node, elements = [], [], []
    for p, port in enumerate(ports):
        if p in known and seen[port.node]:
            shares.append(known[p])
            node.append(port.node)
            elements.append(part_of[port.element])
    for k in range(n):
        left = np.eye(n)[k] - sum(known[p] for p, port in enumerate(ports) if p in known and port.node == k)
        if seen[k] and k not in told:
            shares.append(left)
            node.append(k)
            elements.append(part_of[min(unknown[k])] if unknown[k] else ())
    return Flows(np.array(shares).reshape(-1, n), np.array(node, int), elements)


def _followed(ports: Sequence[Port], n: int) -> tuple[dict[int, NDArray], set[int], list[set[int]]]:
    """Known flows by port, the nodes whose balance gave them, and the elements of unknown flow at each node."""
    known: dict[int, NDArray] = {}
    told: set[int] = set()
    waiting = [{p for p, port in enumerate(ports) if port.node == k} for k in range(n)]
    ready = [k for k in range(n) if len(waiting[k]) == 1]
    while ready:
        k = ready.pop(0)
        if len(waiting[k]) != 1:
            continue
        p = waiting[k].pop()
        others = (known[q] for q, port in enumerate(ports) if port.node == k and q in known)
        known[p] = np.eye(n)[k] - sum(others, np.zeros(n))
        told.add(k)
        twin = ports[p].twin
        if twin >= 0 and twin not in known:
            known[twin] = 0.0 - known[p]
            at = ports[twin].node
            waiting[at].discard(twin)
            ready.append(at)
    return known, told, [{ports[p].element for p in left} for left in waiting]


class Columns(NamedTuple):
    """Time intervals of integration: whole slabs, or pieces of slabs."""

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

    def values(self, shape: Shape, breaks: NDArray) -> NDArray:
        """Values of a waveform, with breaks at instants in slabs, at the points of each interval; shape (m, s)."""
        basis, h = self.basis, self.h
        start = self.middle - self.width / 2
        values = shape.value(start[:, None] + self.width[:, None] * basis.c, self.middle[:, None])
        inside = breaks[breaks % 1 != 0]
        if self.span is None and len(inside):
            low, n = int(self.slab[0]), len(self.slab)
            parts = broken([(shape, 1.0)], inside, basis, h, low, n)
            first = np.cumsum([0, *parts.parts])
            for slab, a, b in zip(parts.slab, first[:-1], first[1:], strict=True):
                values[slab - low] = sum(
                    basis.projection(parts.start[j], parts.stop[j]) @ (basis.to_points @ parts.coef[j])
                    for j in range(a, b)
                )
        return values

    def integral(self, x: NDArray, y: NDArray) -> NDArray:
        """Exact integral of x·y over each interval, for polynomials of shape (…, m, s); shape (…, m)."""
        return self.integral_of(x * y)

    def integral_of(self, x: NDArray) -> NDArray:
        """Integral of polynomials over each interval; shapes (…, m, s) to (…, m)."""
        return thin_product(x, self.basis.A[-1]) * self.width


class Accounts(NamedTuple):
    """Energy accounts of a group; node numbers count within the group."""

    where: list[str]  # of each account
    may_give: list[bool]
    ends: NDArray  # (ends,) numbers of the line ends here
    z0: NDArray  # (ends,)
    gathers: NDArray  # (nodes, ends) from w - o to flows into the nodes
    heads: dict[int, int]  # one line end of each node that has any
    held: dict[int, Shape]  # prescribed efforts of nodes without line ends
    excitations: list[tuple[int, int, Excitation]]  # account, node
    conductors: list[tuple[int, int, Resistive]]
    flows: Flows
    posts: list[tuple[int, int, Member | None]]  # account and column of each flow; its member if there is one only
    above_level: NDArray  # (nodes,) effort at zero gauge pressure
    falls: NDArray  # (flows,) effort at zero gauge pressure if all the flow leaves to the open air, else 0
    gravity: int  # account of outflow to the open air below the level

    def energies(self, w: NDArray, o: NDArray, columns: Columns) -> tuple[NDArray, NDArray]:
        """Energies in each time interval, J.

        Waves w arrive and o leave, shape (ends, m, s). Returned are energies out of lines (ends, m), and into
        accounts (accounts, columns of a ledger, m).
        """
        m, integral = len(columns.slab), columns.integral
        found = np.zeros((len(self.where), len(COLUMNS), m))
        u = np.zeros((len(self.gathers), m, columns.basis.s))
        rest = _sums(self.gathers, w - o)
        for node, end in self.heads.items():
            u[node] = (w[end] + o[end]) / 2
        for node, shape in self.held.items():
            u[node] = columns.values(shape, np.empty(0))
        for account, node, excitation in self.excitations:
            level, g = columns.values(excitation.waveform, excitation.breaks), excitation.conductance
            gauge = u[node] - self.above_level[node]
            flow = g * (level - u[node]) if excitation.is_effort else level - g * gauge
            lost = level - u[node] if excitation.is_effort else gauge
            if not excitation.is_effort:
                found[self.gravity, SUPPLIED] -= self.above_level[node] * g * columns.integral_of(gauge)
            found[account, SUPPLIED] += integral(level, flow if excitation.is_effort else u[node])
            found[account, DISSIPATED] += g * integral(lost, lost)
            rest[node] += flow
        for account, node, conductor in self.conductors:
            g, gauge = _conductance(conductor, columns), u[node] - self.above_level[node]
            found[account, DISSIPATED] += integral(gauge, gauge) * g
            found[self.gravity, SUPPLIED] -= self.above_level[node] * g * columns.integral_of(gauge)
            rest[node] -= g[:, None] * gauge
        flows = _sums(self.flows.shares, rest)
        for flow, node, falls, (account, column, member) in zip(
            flows, self.flows.node, self.falls, self.posts, strict=True
        ):
            effort = u[node] - falls
            power = integral(effort, flow)
            found[account, column] += -power if column == SUPPLIED else power
            if falls:
                found[self.gravity, SUPPLIED] -= falls * columns.integral_of(flow)
            if member is not None and (member.series or member.beside):
                burnt = member.series * integral(flow, flow) + member.beside * integral(effort, effort)
                found[account, DISSIPATED] += burnt
                found[account, STORED] -= burnt
        return columns.integral(w - o, w + o) / (4 * self.z0[:, None]), found


def _conductance(conductor: Resistive, columns: Columns) -> NDArray:
    """Conductance in each interval, shape (m,); a switch that moves inside one moves at its nearest edge."""
    switch = conductor.switch
    if switch is None:
        return np.full(len(columns.slab), conductor.conductance)
    return np.where(columns.middle < switch.time, 1 / float(switch.before), 1 / float(switch.after))


def accounts_of(nodes: Sequence[Node], inventory: Inventory, z0: NDArray) -> Accounts:
    """Open the accounts of a group."""
    number = {node.name: k for k, node in enumerate(nodes)}
    ends = np.array([end for node in nodes for end in node.ends], int)
    at = np.repeat(np.arange(len(nodes)), [len(node.ends) for node in nodes])
    heads = {int(k): int(e) for k, e in zip(*np.unique(at, return_index=True), strict=True)}
    gathers = (at == np.arange(len(nodes))[:, None]) / (2 * z0[ends // 2])
    held = {k: n.held for k, n in enumerate(nodes) if n.held is not None and not n.ends and not n.hidden}
    ports: list[Port] = []
    for e, member in enumerate(inventory.members):
        first = len(ports)
        ports += [Port(e, number[node], first + 1 - k if member.through else -1) for k, node in enumerate(member.nodes)]
    flows = flows_of(ports, [k in heads or k in held for k in range(len(nodes))])
    where = [one.where for one in (*inventory.excitations, *inventory.conductors)]
    may_give = [True for _ in inventory.excitations] + [False for _ in inventory.conductors]
    above_level = np.array([node.above_level for node in nodes])
    falls = np.zeros(len(flows.node))
    posts: list[tuple[int, int, Member | None]] = []
    opened: dict[tuple[int, ...], int] = {}
    for k, (elements, node) in enumerate(zip(flows.elements, flows.node, strict=True)):
        members = [inventory.members[e] for e in elements]
        if not members:
            posts.append((len(where), UNACCOUNTED, None))
            where.append(f"node '{nodes[node].name}'")
            may_give.append(True)
            continue
        to_air = all(member.to_air for member in members)
        falls[k] = above_level[node] if to_air else 0.0
        if elements not in opened:
            opened[elements] = len(where)
            where.append(" and ".join(member.where for member in members))
            lifts = not to_air and any(member.to_air and above_level[number[member.nodes[0]]] for member in members)
            may_give.append(lifts or any(member.may_give for member in members))
        alone = members[0] if len(members) == 1 else None
        posts.append((opened[elements], alone.column if alone else TAKEN, alone))
    excitations = [(k, number[excitation.node], excitation) for k, excitation in enumerate(inventory.excitations)]
    conductors = [(len(excitations) + k, number[one.node], one) for k, one in enumerate(inventory.conductors)]
    if above_level.any():
        where.append(GRAVITY)
        may_give.append(True)
    last = len(where) - 1
    columns = z0[ends // 2], gathers, heads, held, excitations, conductors, flows, posts, above_level, falls, last
    return Accounts(where, may_give, ends, *columns)
