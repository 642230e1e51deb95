"""The operating point of scenes with multiports or coupled conductors: the equations of their circuits at s = 0.

These are the equations that a run steps, with lossless lines and modes as an effort and a flow that are the same at
both ends, and lossy lines and laws as what falls across them. Newton's method meets the laws; where equations at s = 0
leave an effort or a flow open, it is the one that a slow rise from rest leads to.

References
----------
C.-W. Ho, A. E. Ruehli, P. A. Brennan: The modified nodal approach to network analysis (1975).
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.circuit import equations
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import just_before
from tline.solver.description.groups import Group
from tline.solver.description.lines import Line
from tline.solver.description.nodes import Node
from tline.solver.steady.edges import FILLED, Edges
from tline.solver.steady.lossy_lines import FrictionTable, pi
from tline.solver.steady.slow_limit import Limit, Pencil, slow_limit
from tline.words.wording import place

STEPS, SHORTEST = 200, 1e-9  # of Newton, and the shortest share of one
CLOSE = 1e-10  # residuals, of the largest effort
LEAST = 1e-9  # slope of a law where it has none
CANCELLED = 1e-14  # of what line ends and other elements conduct at a node
NAMED = 4  # elements in a message


class Point(NamedTuple):
    """Efforts of nodes, flows (lines, 2) at the ends of lines, and flows through elements."""

    effort: dict[str, float]
    flows: NDArray
    through: dict[str, float]


class _Columns(NamedTuple):
    """Numbers of unknowns: efforts by node, flows at the ends of lines and through laws."""

    effort: dict[str, int]
    ends: NDArray  # (lines, 2)
    laws: dict[str, int]
    unit: float  # of flows, over that of efforts
    rate: float  # unit of s, 1/s


def operating_point(
    description: Description, tables: Mapping[str, FrictionTable], openings: Mapping[str, float]
) -> Point:
    """Efforts and flows under what sources prescribe immediately before t = 0.

    Raises
    ------
    InputError
        There is none, or several, naming elements that are involved; or none was found.
    """
    for name in description.starts:
        raise InputError(place("nodes", name, "start"), "is not known beside multiports or coupled conductors", "none")
    groups, nodes = description.grouped()
    lines, pencil = description.lines, Pencil()
    columns = _Columns(
        dict(zip(nodes, pencil.unknowns(f"node '{name}'" for name in nodes).tolist(), strict=True)),
        pencil.unknowns(place("lines", name) for name in lines for _ in range(2)).reshape(-1, 2),
        {},
        next(iter(nodes.values())).alone,
        1 / float(np.mean([line.delay for line in lines.values()])),
    )
    z0 = np.array([line.z0 for line in lines.values()])
    for group in groups:
        _add_group(pencil, columns, group, z0)
        for element in group.elements:
            if element.law.kind in FILLED:
                _add_filled(pencil, columns, element, description.tanks)
    falling = [line.losses is not None and any(line.losses.steady_drop(1.0)) for line in lines.values()]
    _add_lines(pencil, columns, lines, falling)
    edges = Edges(description, columns.effort, np.array(falling), tables, openings, [])
    lossy = [pair for pair, falls in zip(zip(columns.ends, lines.values(), strict=True), falling, strict=True) if falls]
    z = _solved(pencil, _Laws(pencil, columns, edges, lossy))
    effort = {name: float(z[columns.effort[name]]) for name in description.nodes}
    through = {where: float(z[column]) * columns.unit for where, column in columns.laws.items()}
    return Point(effort, z[columns.ends] * columns.unit, through)


def _add_group(pencil: Pencil, columns: _Columns, group: Group, z0: NDArray) -> None:
    """Balances at nodes, branches and states of a group; laws follow."""
    branches = [*group.loads, *(branch.before(0.0) for branch in group.branches)]
    laws, k = [element.where for element in group.elements], len(group.nodes)
    F, G, H, Q, L = equations(
        group.nodes, branches, group.ports(len(laws) * [1.0]), [node.switched(0.0) for node in group.nodes]
    )
    flows = pencil.unknowns([branch.where for branch in branches for _ in branch.nodes] + laws)
    columns.laws.update(zip(laws, flows[len(flows) - len(laws) :].tolist(), strict=True))
    v = np.concatenate([[columns.effort[node.name] for node in group.nodes], flows]).astype(int)
    names = [branch.where for branch in branches for _ in branch.ports.Q]
    x = pencil.unknowns(names + [""] * (len(Q) - len(names)))  # the last one may be always 1
    for p in range(len(F) - len(laws)):
        entries, known = [*zip(v, F[p], strict=True), *zip(x, -G[p], strict=True)], 0.0
        if p < k and H[p, p]:
            waves, known = _wave(columns, group.nodes[p], z0)
            own = F[p, p] - H[p, p] * sum(value for column, value in waves if column == v[p])
            entries[p] = v[p], own if abs(own) > CANCELLED * abs(F[p, p]) else 0.0
            entries += [(column, -H[p, p] * value) for column, value in waves if column != v[p]]
            known *= H[p, p]
        pencil.row(pencil.columns[v[p]], entries, known=known)
    for p, name in enumerate(names):
        size = max(np.abs(Q[p]).max(), np.abs(L[p]).max()) or 1.0
        entries = [*zip(x, Q[p] / size, strict=True), *zip(v, L[p] / size, strict=True)]
        pencil.row(name, entries, [(x[p], -columns.rate / size)])
    for column in x[len(names) :]:
        pencil.row("", [(column, 1.0)], known=1.0)


def _wave(columns: _Columns, node: Node, z0: NDArray) -> tuple[list[tuple[int, float]], float]:
    """Thévenin wave of a node: its entries of the waves u + z0 i that arrive with flows i, and what sources add."""
    entries = []
    for end, weight in zip(node.ends, node.weights(z0).tolist(), strict=True):
        line, side = divmod(end, 2)
        sign = weight * z0[line] * columns.unit * (1 if side else -1)
        entries += [(columns.effort[node.name], weight), (int(columns.ends[line, side]), sign)]
    return entries, sum(share * just_before(waveform) for waveform, share in node.excitations)


def _add_filled(pencil: Pencil, columns: _Columns, element: PlacedLaw, tanks: Mapping[str, float]) -> None:
    """What takes no flow in the end, or a tank that starts at a level of its own."""
    ends = [(columns.effort[node], sign) for node, sign in zip(element.nodes, (1.0, -1.0), strict=False)]
    if element.law.kind == "tank" and element.nodes[0] in tanks:
        pencil.row(element.where, ends[:1], known=tanks[element.nodes[0]])
    else:
        pencil.row(element.where, [(columns.laws[element.where], 1.0)], [(at, -sign) for at, sign in ends])


def _add_lines(pencil: Pencil, columns: _Columns, lines: Mapping[str, Line], falling: list[bool]) -> None:
    """What leaks from each line, and of those along which nothing falls that efforts are the same at both ends."""
    for (name, line), ends, falls in zip(lines.items(), columns.ends.tolist(), falling, strict=True):
        at = [columns.effort[node] for node in line.nodes]
        half, leak = line.delay * columns.rate / 2, pi(line)[1] / columns.unit
        charge, flux = half / (line.z0 * columns.unit), half * line.z0 * columns.unit
        flows, lost = zip(ends, (1.0, -1.0), strict=True), [(node, -leak) for node in at]
        pencil.row(place("lines", name), [*flows, *lost], [(node, -charge) for node in at])
        if not falls:
            across = zip(at, (1.0, -1.0), strict=True)
            pencil.row(place("lines", name), across, [(end, -flux) for end in ends])


class _Laws:
    """Lossy lines and elements: a fall between two nodes, and the flow through, over one unknown each."""

    def __init__(self, pencil: Pencil, columns: _Columns, edges: Edges, lossy: list[tuple[NDArray, Line]]):
        self.a = pencil.unknowns(edges.where)
        self.falls, self.flows = np.empty(edges.count, int), np.empty(edges.count, int)
        self.unit = columns.unit
        for k, where in enumerate(edges.where):
            nodes = zip((int(edges.from_node[k]), int(edges.to_node[k])), (-1.0, 1.0), strict=True)
            across = [(node, sign) for node, sign in nodes if node >= 0]
            if k < len(lossy):
                ends, line = lossy[k]
                leak, flux = pi(line)[1] / columns.unit / 2, line.delay * columns.rate * line.z0 * columns.unit / 2
                passed = [*((end, -0.5) for end in ends), *((node, -sign * leak) for node, sign in across)]
                slow = [(end, flux) for end in ends]
            else:
                passed, slow = [(columns.laws[where], -1.0)], []
            self.falls[k] = pencil.row(where, across, slow)
            self.flows[k] = pencil.row(where, passed)
        largest = max(map(abs, pencil.known), default=0.0)
        self._solved = edges.laws(np.arange(len(columns.effort)), largest).solved if edges.count else None

    def at(self, a: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Falls and flows, and their slopes over a, which are never zero."""
        if self._solved is None:
            return a, a, a, a
        fall, flow, steep, slope = self._solved(a)
        return fall, flow / self.unit, np.maximum(steep, LEAST), np.maximum(slope / self.unit, LEAST)


def _solved(pencil: Pencil, laws: _Laws) -> NDArray:
    """Newton's steps, halved until what is left falls."""
    A, B, f = pencil.matrices()
    rows, a = np.concatenate([laws.falls, laws.flows]), np.tile(laws.a, 2)

    def left(z: NDArray) -> tuple[NDArray, float, NDArray]:
        fall, flow, steep, slope = laws.at(z[laws.a])
        rest = A @ z - f
        rest[rows] += np.concatenate([fall, flow])
        return rest, float(np.abs(rest).max()), np.concatenate([steep, slope])

    def limit(z: NDArray, rest: NDArray, slopes: NDArray) -> Limit:
        J = A.plus(rows, a, slopes)
        return slow_limit(J, B, J @ z - rest)

    z = np.zeros(len(f))
    rest, worst, slopes = left(z)
    found = limit(z, rest, slopes)
    for _ in range(STEPS):
        step, share = found.z - z, 1.0
        now = left(z + step)
        while now[1] >= worst > 0 and share > SHORTEST:
            share /= 2
            now = left(z + share * step)
        if now[1] >= worst:
            break
        z, (rest, worst, slopes) = z + share * step, now
        found = limit(z, rest, slopes)
    _check(pencil, found, worst, np.abs(z).max())
    return z


def _check(pencil: Pencil, found: Limit, worst: float, largest: float) -> None:
    """Refuse what contradicts itself, what stays open, and what was not found, naming the elements."""
    if found.rows.size:
        where, problem = _names(pencil.rows, found.rows), "nothing takes the flow, or efforts contradict each other"
        raise InputError(where, f"no steady state: {problem}", "a resistance in between, or start = 'rest'")
    if found.columns.size:
        where, problem = _names(pencil.columns, found.columns), "nothing determines its effort or flow"
        raise InputError(where, f"no steady state: {problem}", "a resistance in between, or start = 'rest'")
    if not worst <= CLOSE * largest:
        where = _names(pencil.rows, np.arange(len(pencil.rows)))
        raise InputError(where, "no steady state found: efforts and flows do not settle", "start = 'rest'")


def _names(known: list[str], at: NDArray) -> str:
    known = list(dict.fromkeys(known[k] for k in at if known[k]))
    names = sorted(known, key=lambda name: name.startswith("node "))
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more or "start"
