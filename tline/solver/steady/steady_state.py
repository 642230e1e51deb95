"""Steady state under constant sources: one effort on all connected lossless lines, and a flow in each.

A lossless line keeps effort and flow the same at both ends. The effort of a connected part follows from the sum of the
flows of its sources, its loads, and lossy lines and elements between parts. Where lines form loops, or several ideal
efforts share a part, the flows are not unique; taken are those to which a slow rise from rest leads: no net inertia
round any loop, so that flow = difference of a potential over z0·T of the line.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.bundle import bundles_of
from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before
from tline.solver.kernel.arithmetic import ACCEPTED_RESIDUAL
from tline.solver.steady.balance import Balance, Linear, Sparse, balanced, regular
from tline.solver.steady.edges import Edges, openings_at_rest, still
from tline.solver.steady.pockets import settled
from tline.solver.steady.ports import AtNodes, Wiring, at_nodes, branches_with_ports, check_limit, ported, wiring_of
from tline.words.wording import place

SAME_EFFORT = 1e-9  # relative difference of equal efforts, and share of the largest flow that leaks may take
LAST_DIGITS = 1e-14  # of the level: rounding of efforts that count from it
DROWNING = 1e9  # times the flow that efforts drive through lines: waves have no digits left for these efforts


class Before(NamedTuple):
    """State before t = 0; efforts count from the level."""

    effort: dict[str, float]  # of each node
    flows: NDArray  # (lines, 2) at both ends, from end 1 to end 2
    through: dict[str, float]  # of each element that passes a flow
    openings: dict[str, float]  # of each element that moves its opening
    unknowns: NDArray | None = None  # of the balances


def rest(description: Description) -> Before:
    """State at rest."""
    flows = np.zeros((len(description.lines), 2))
    return Before(dict.fromkeys(description.nodes, 0.0), flows, {}, openings_at_rest(description.elements))


def steady_state(description: Description) -> tuple[dict[str, float], NDArray]:
    """Effort of each node and flows at both ends of each line, from end 1 to end 2, immediately before t = 0."""
    effort, flows, *_ = above_level(description)
    return {name: u + description.nodes[name].height.level for name, u in effort.items()}, flows


def above_level(description: Description) -> Before:
    """Efforts that count from the level, flows through elements, and openings that hold still, before t = 0."""
    if Before not in description.known:
        description.known[Before] = still(description.elements, lambda openings: _under(description, openings))
    return description.known[Before]


class _Parts(NamedTuple):
    """A scene whose lossless lines and inductors join nodes to parts of one effort, and the terms of each node."""

    description: Description
    lines: Wiring
    at: AtNodes


def _under(description: Description, openings: dict[str, float]) -> Before:
    """The steady state with these openings of the elements that move them."""
    like = description.origin and not description.anew and not description.tanks
    known = description.origin.description.known if description.origin and like else description.known
    if _Parts not in known:
        known[_Parts] = _parted(description)
    parted = known[_Parts]._replace(description=description)
    lines = parted.lines
    edges = known[Edges].like(description, openings) if Edges in known else None
    if edges is None:
        edges = known[Edges] = Edges(description, lines.number, openings, lines.falls, lines.ends)
    effort, y, flow, unknowns = _solved(parted, edges)
    lossy = int(lines.falls.sum())
    along = np.empty(len(lines.z0))
    along[lines.falls], along[lines.joined] = flow[:lossy], y[: len(lines.names)]
    flows = along[:, None] + lines.leak[:, None] * effort[lines.ends] * [1.0, -1.0]
    into = y[len(lines.inertia) :]
    for one in bundles_of(description).values():
        k = len(one.lines)
        flows[one.lines], into = np.column_stack([into[:k], -into[k : 2 * k]]), into[2 * k :]
    through = dict(zip([element.where for element in edges.elements], flow[lossy:].tolist(), strict=True))
    return Before(dict(zip(lines.number, effort.tolist(), strict=True)), flows, through, openings, unknowns)


def _parted(description: Description) -> _Parts:
    """Parts of a description with the terms of their nodes; the joins stay when values change."""
    if Wiring not in description.grids:
        description.grids[Wiring] = wiring_of(description)
    lines = description.grids[Wiring]
    parted = _Parts(description, lines, at_nodes(description, lines))
    _check_held(description, lines.part, parted.at.given)
    _check_between(description, lines)
    return parted


def _solved(parted: _Parts, edges: Edges) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Efforts of nodes, flows through joins and edges, and all unknowns.

    A part is one unknown effort, and flows inside follow from it; but beside multiports and coupled conductors each
    node and each flow is unknown.
    """
    description, lines, at = parted
    ports = bool(description.coupled or description.multiports)
    part = np.arange(len(lines.part)) if ports else lines.part
    given = _least(at.given, part)
    laws = edges.laws(part, np.nanmax(np.abs(given), initial=0.0))
    known = laws.impedance if len(laws.impedance) else lines.z0
    unit = float(np.exp(np.log(known).mean()))
    if ports:
        linear, names, flows = ported(description, at, edges.where, lines, unit)
        near = None
    else:
        total, source = (np.bincount(part, weights) for weights in (at.conductance, at.driven))
        linear, names, flows = Linear(given, total, source, unit), [], None
        near = _near(description, len(edges.from_node) + len(given))
    found = balanced(laws, linear, near)
    check_limit(found.limit, names, lines)
    driving = _driving(parted, edges)
    _check_found(parted, edges, found, part, driving)
    effort = _settled(parted, edges, found, found.effort[part], driving)
    y = _inside(parted, edges, found, effort) if flows is None else found.others[flows] / unit
    return effort, y, found.flow, found.unknowns


def _inside(parted: _Parts, edges: Edges, found: Balance, effort: NDArray) -> NDArray:
    """Flows through joins, which balance those of edges and the inflow at each node."""
    lines, at, n = parted.lines, parted.at, len(effort)
    if not len(lines.inertia):
        return np.zeros(0)
    firsts = np.unique(lines.part, return_index=True)[1]
    held = at.tie == np.inf
    held[firsts[np.isnan(_least(at.given, lines.part))]] = True  # the potential's zero, anywhere
    into = np.zeros(n + 1)  # nodes from the edges, and the reference
    np.add.at(into, edges.to_node, found.flow)
    np.subtract.at(into, edges.from_node, found.flow)
    flow_in = np.where(held, 0.0, at.driven - at.conductance * effort + into[:-1])
    first, second = lines.joins.T
    every, stiffness = np.arange(n), 1 / lines.inertia
    ends = np.concatenate([first, second]), np.concatenate([second, first])
    own = np.where(held, 1.0, at.tie + np.bincount(ends[0], np.tile(stiffness, 2), n))
    free = ~(held[ends[0]] | held[ends[1]])
    rows, columns, values = ends[0][free], ends[1][free], -np.tile(stiffness, 2)[free]
    system = Sparse(*(np.concatenate(each) for each in ((rows, every), (columns, every), (values, own))))
    scale = 1 / np.sqrt(np.abs(own))
    potential = regular(system.scaled(scale, scale), scale * flow_in, symmetric=True)
    if potential is None:
        raise InputError("start", "no steady state: active loads cancel the inertia of lines", "'rest'")
    potential *= scale
    return (potential[first] - potential[second]) * stiffness


def _near(description: Description, count: int) -> NDArray | None:
    """Unknowns of the description from which this one was changed; None without them, or if their number differs."""
    known = description.origin and description.origin.description.known.get(Before)
    found = None if known is None else known.unknowns
    return None if found is None or len(found) != count else found


def _check_found(parted: _Parts, edges: Edges, found: Balance, part: NDArray, driving: float) -> None:
    """Raise an error if no solution was found, or nothing takes a flow.

    `driving` is the largest flow that something drives, `part` the number of each node's balance.
    """
    if not found.worst <= ACCEPTED_RESIDUAL:
        k = int(np.argmax(np.nan_to_num(found.rest, nan=np.inf)))
        where = edges.where[k] if k < len(edges.from_node) else "start"
        raise InputError(where, "no steady state found: efforts and flows do not settle here", "start = 'rest'")
    if driving > 0 and np.abs(found.flow).max(initial=0.0) > DROWNING * driving:
        problem = "no steady state: nothing limits the flow that an ideal effort drives through it"
        raise InputError(edges.where[int(np.abs(found.flow).argmax())], problem, "a resistance between")
    stuck = np.flatnonzero(np.abs(found.leak) > SAME_EFFORT * np.abs(found.flow).max(initial=driving))
    if stuck.size and driving > 0:
        description, number = parted.description, parted.lines.number
        names, sources = list(number), description.scene.sources
        at = {name: part[number[source.terminals[0]]] for name, source in sources.items()}
        where = f"node '{names[int(np.flatnonzero(part == stuck[0])[0])]}'"
        where = next((place("sources", name) for name, k in at.items() if k == stuck[0]), where)
        got = f"{float(found.leak[stuck[0]]):g} {description.medium.units['flow']}"
        raise InputError(where, "no steady state: nothing takes the flow", "a load that does", got)


def _driving(parted: _Parts, edges: Edges) -> float:
    """The largest flow of sources, into a line at a held effort, or of a pump or of air at another height by itself."""
    held = np.nanmax(np.abs(parted.at.given), initial=0.0)
    into_line = held / parted.lines.z0.min()
    by_itself = np.abs(edges.solved(np.zeros(len(edges.from_node)))[1]).max(initial=into_line)
    return max(np.abs(parted.at.driven).max(), by_itself)


def _settled(parted: _Parts, edges: Edges, found: Balance, effort: NDArray, driving: float) -> NDArray:
    """The effort of each node, with those of pockets."""
    description, at = parted.description, parted.at
    number, part = parted.lines.number, parted.lines.part
    known = ~np.isnan(at.given) | (at.conductance != 0)
    known[[number[node] for branch in branches_with_ports(description) for node in branch.nodes]] = True
    if (by_part := np.bincount(part, known) > 0).all():
        return effort
    start = np.full(part.max() + 1, np.nan)
    for name, given in description.starts.items():
        start[part[number[name]]] = description.nodes[name].height.below(given)
    holding = edges.holding(part, found.flow, np.abs(found.flow).max(initial=driving))
    before = effort[np.unique(part, return_index=True)[1]]
    after, opened = settled(before, by_part, start, *holding)
    if opened.size:
        name = next(name for name in description.starts if part[number[name]] in opened)
        got = after[part[number[name]]] + description.nodes[name].height.level
        unit = description.medium.units["effort"]
        raise InputError(place("nodes", name, "start"), "a valve would open", f"such as {got:g} {unit}")
    return effort + (after - before)[part]


def _least(values: NDArray, part: NDArray) -> NDArray:
    least = np.full(part.max() + 1, np.nan)
    np.fmin.at(least, part, values)
    return least


def _check_held(description: Description, part: NDArray, given: NDArray) -> None:
    """Refuse different ideal efforts in one part."""
    units, names = description.medium.units, list(description.nodes)
    low, high = _least(given, part), -_least(-given, part)
    level = np.zeros(len(low))
    level[part] = [node.height.level for node in description.nodes.values()]
    torn = np.flatnonzero(high - low > SAME_EFFORT * np.fmax(np.abs(low), np.abs(high)) + LAST_DIGITS * np.abs(level))
    if torn.size:
        k = torn[0]
        lowest, highest = (names[np.flatnonzero((part == k) & (given == level))[0]] for level in (low[k], high[k]))
        raise InputError(
            f"nodes '{lowest}' and '{highest}'",
            "no steady state: lossless lines join different ideal efforts",
            got=f"{low[k] + level[k]:g} and {high[k] + level[k]:g} {units['effort']}",
        )


def _check_between(description: Description, lines: Wiring) -> None:
    """Refuse ideal efforts between two nodes of one part."""
    for name, source in description.scene.sources.items():
        if source.nodes is not None and source.conductance == np.inf:
            one, other = (lines.part[lines.number[node]] for node in source.nodes)
            value = just_before(source.value)
            if one == other and value:
                got = f"{value:g} {description.medium.units['effort']}"
                problem = "no steady state: lossless lines join its two nodes"
                raise InputError(place("sources", name), problem, "a resistance", got)
