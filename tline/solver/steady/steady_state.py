"""The steady state that constant sources imply: one effort on all lines that hang together, and a flow in each.

A lossless line keeps effort and flow the same at both ends. The effort of a connected part follows from the sum of what
its sources drive, its loads take, and lossy lines and elements between parts carry away. Where lines form loops, or
several ideal efforts share a part, the flows are not unique; taken is the one that a slow rise from rest leads to: no
net inertia round any loop, so that flow = difference of a potential over z0·T of the line.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.components import parts
from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before
from tline.solver.description.nodes import NONE, Node
from tline.solver.steady.balance import CLOSE, balanced
from tline.solver.steady.edges import Edges
from tline.solver.steady.lossy_lines import FrictionTable, pi
from tline.solver.steady.openings import openings_at_rest, still
from tline.solver.steady.operating_point import operating_point
from tline.solver.steady.pockets import settled
from tline.words.wording import place

SAME = 1e-9  # efforts that differ by less than this, relatively, are equal
LAST_DIGITS = 1e-14  # of the level, which efforts have lost by counting from it
SMALL = 300  # nodes
ROUNDING = 1e-12  # of the flows that meet
STUCK = 1e-9  # of the largest flow, or of what held efforts and pumps send into a line, that only a leak takes


class Before(NamedTuple):
    """What there is before t = 0; efforts count from the level."""

    effort: dict[str, float]  # of each node
    flows: NDArray  # (lines, 2) at both ends, from end 1 to end 2
    through: dict[str, float]  # of each element that lets something pass
    openings: dict[str, float]  # of each element that moves its opening


def rest(description: Description) -> Before:
    """While all stands still."""
    flows = np.zeros((len(description.lines), 2))
    return Before(dict.fromkeys(description.nodes, 0.0), flows, {}, openings_at_rest(description.elements))


def steady_state(
    description: Description, tables: Mapping[str, FrictionTable] = NONE
) -> tuple[dict[str, float], NDArray]:
    """Effort of each node and flows at both ends of each line, from end 1 to end 2, immediately before t = 0.

    Parameters
    ----------
    tables : mapping of str to Table
        Of lines whose friction is to be the one that their loss elements have.

    Raises
    ------
    InputError
        If there is none: different ideal efforts on connected lines, or a flow that nothing takes; or none was found.
    """
    effort, flows, _, _ = above_level(description, tables)
    return {name: u + description.nodes[name].height.level for name, u in effort.items()}, flows


def above_level(description: Description, tables: Mapping[str, FrictionTable] = NONE) -> Before:
    """The same with efforts that count from the level, flows through elements, and openings that hold still."""
    if description.mixing:
        description.refuse_coupled("a steady state in stretches")
    if description.coupled or description.multiports:
        return still(
            description.elements, lambda openings: Before(*operating_point(description, tables, openings), openings)
        )
    return still(description.elements, lambda openings: _under(description, tables, openings))


def _under(description: Description, tables: Mapping[str, FrictionTable], openings: dict[str, float]) -> Before:
    """The steady state with these openings of the elements that move them."""
    nodes, lines = description.nodes, description.lines.values()
    number, n = {name: k for k, name in enumerate(nodes)}, len(nodes)
    shorts = description.inductive
    joined = [*(line.nodes for line in lines), *((first, second) for first, second, _ in shorts)]
    first, second = np.array([[number[node] for node in pair] for pair in joined]).T
    lossy = np.array([line.losses is not None and any(line.losses.steady_drop(1.0)) for line in lines])
    leak = np.array([pi(line)[1] for line in lines] + [0.0] * len(shorts))
    count, stiff = len(lossy), np.append(~lossy, np.ones(len(shorts), bool))
    part = parts(first[stiff], second[stiff], n)
    given, conductance, driven, tie = _balances(nodes)
    for name, effort in description.tanks.items():
        given[number[name]], tie[number[name]] = effort, np.inf
    conductance += np.bincount(first, leak, n) + np.bincount(second, leak, n)
    _check_held(description, part, given)
    _check_between(description, part, number)
    edges = Edges(description, number, lossy, tables, openings, description.resistive)
    if edges.count:
        level, flow = _between_parts(description, number, part, given, conductance, driven, edges)
        out = edges.out_of_nodes(flow, n)
    else:
        level, flow, out = _efforts(description, number, part, given, conductance, driven), np.zeros(0), np.zeros(n)
    effort = level[part]
    unheld = np.isnan(_least(given, part))
    tie[np.unique(part, return_index=True)[1][unheld]] = np.inf  # the potential's zero, anywhere
    stiffness = np.array([1 / (line.z0 * line.delay) for line in lines] + [1 / inertia for _, _, inertia in shorts])
    stiffness[:count][lossy] = 0.0
    flow_in = driven - conductance * effort - out
    potential = _potential(first[stiff], second[stiff], stiffness[stiff], flow_in, tie)
    y = stiffness * (potential[first] - potential[second])
    y[:count][lossy] = flow[: lossy.sum()]
    flows = np.stack([y + leak * effort[first], y - leak * effort[second]], axis=1)[:count]
    through = dict(zip(edges.where[lossy.sum() :], flow[lossy.sum() :].tolist(), strict=True))
    return Before(dict(zip(nodes, effort.tolist(), strict=True)), flows, through, openings)


def _between_parts(
    description: Description,
    number: dict[str, int],
    part: NDArray,
    given: NDArray,
    conductance: NDArray,
    driven: NDArray,
    edges: Edges,
) -> tuple[NDArray, NDArray]:
    """The effort of each connected part, and the flow through each edge between them."""
    total, source = (np.bincount(part, weights) for weights in (conductance, driven))
    held = np.nanmax(np.abs(given), initial=0.0)
    laws = edges.laws(part, held)
    found = balanced(laws, _least(given, part), total, source)
    if not found.rest.max() <= CLOSE:
        where = edges.where[int(np.argmax(np.nan_to_num(found.rest, nan=np.inf)))]
        raise InputError(where, "no steady state found: efforts and flows do not settle here", "start = 'rest'")
    largest = held / min(line.z0 for line in description.lines.values())
    by_itself = np.abs(laws.solved(np.zeros(edges.count))[1]).max()  # of a pump, or of air outside at another height
    driving = max(np.abs(driven).max(), largest, by_itself)
    scale = np.abs(found.flow).max(initial=driving)
    stuck = np.flatnonzero((np.abs(found.leak) > STUCK * scale) & (driving > 0))
    if stuck.size:
        _refuse_flow(description, number, part, int(stuck[0]), float(found.leak[stuck[0]]))
    known = ~np.isnan(_least(given, part)) | (total != 0)
    start = _starts(description, number, part)
    effort, opened = settled(found.effort, known, start, *edges.holding(part, found.flow, scale))
    if opened.size:
        name = next(name for name in description.starts if part[number[name]] in opened)
        got = effort[part[number[name]]] + description.nodes[name].height.level
        unit = description.medium.units["effort"]
        raise InputError(place("nodes", name, "start"), "a valve would open", f"such as {got:g} {unit}")
    return effort, found.flow


def _starts(description: Description, number: dict[str, int], part: NDArray) -> NDArray:
    """What parts are to start with, above the level, where nothing else determines it; else nan."""
    start = np.full(part.max() + 1, np.nan)
    for name, effort in description.starts.items():
        start[part[number[name]]] = description.nodes[name].height.below(effort)
    return start


def _refuse_flow(description: Description, number: dict[str, int], part: NDArray, stuck: int, flow: float) -> None:
    """Say that nothing takes the flow into a part."""
    sources = description.scene.sources.items()
    where = next(
        (place("sources", name) for name, source in sources if part[number[source.terminals[0]]] == stuck),
        f"node '{list(number)[int(np.flatnonzero(part == stuck)[0])]}'",
    )
    got = f"{flow:g} {description.medium.units['flow']}"
    raise InputError(where, "no steady state: nothing takes the flow", "a load that does", got)


def _balances(nodes: dict[str, Node]) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Of each node: effort if given, else nan; conductance; driven flow; tie to the reference (infinite: ideal)."""
    n = len(nodes)
    given, conductance, driven, tie = np.full(n, np.nan), np.zeros(n), np.zeros(n), np.zeros(n)
    for k, node in enumerate(nodes.values()):
        switched = node.switched(0.0)
        resistance = np.inf if node.load is None else node.load.at_zero()
        if node.held is not None:
            given[k], tie[k] = just_before(node.held), np.inf
        elif switched == np.inf:
            given[k], tie[k] = node.above_level, np.inf
        else:
            driven[k], conductance[k] = node.flow_before(), node.conductance + switched
            driven[k] += switched * node.above_level
            if node.load is not None and resistance == 0:  # an inductor: a short, its inertia beside those of the lines
                inertia = node.load.numerator[-2] / node.load.denominator[-1]
                given[k], tie[k] = node.above_level, 1 / inertia if inertia else np.inf
            else:
                conductance[k] += 1 / resistance
                driven[k] += node.above_level / resistance
    return given, conductance, driven, tie


def _least(values: NDArray, part: NDArray) -> NDArray:
    """Least value in each part, nan where all are nan."""
    least = np.full(part.max() + 1, np.nan)
    np.fmin.at(least, part, values)
    return least


def _check_held(description: Description, part: NDArray, given: NDArray) -> None:
    """Refuse different ideal efforts in one part."""
    units, names = description.medium.units, list(description.nodes)
    low, high = _least(given, part), -_least(-given, part)
    level = np.zeros(len(low))
    level[part] = [node.height.level for node in description.nodes.values()]
    torn = np.flatnonzero(high - low > SAME * np.fmax(np.abs(low), np.abs(high)) + LAST_DIGITS * np.abs(level))
    if torn.size:
        k = torn[0]
        lowest, highest = (names[np.flatnonzero((part == k) & (given == level))[0]] for level in (low[k], high[k]))
        raise InputError(
            f"nodes '{lowest}' and '{highest}'",
            "no steady state: lossless lines join different ideal efforts",
            got=f"{low[k] + level[k]:g} and {high[k] + level[k]:g} {units['effort']}",
        )


def _check_between(description: Description, part: NDArray, number: dict[str, int]) -> None:
    """Refuse ideal efforts between two nodes of one part."""
    for name, source in description.scene.sources.items():
        if source.nodes is not None and source.conductance == np.inf:
            one, other = (part[number[node]] for node in source.nodes)
            value = just_before(source.value)
            if one == other and value:
                got = f"{value:g} {description.medium.units['effort']}"
                problem = "no steady state: lossless lines join its two nodes"
                raise InputError(place("sources", name), problem, "a resistance", got)


def _efforts(
    description: Description,
    number: dict[str, int],
    part: NDArray,
    given: NDArray,
    conductance: NDArray,
    driven: NDArray,
) -> NDArray:
    """The effort of each connected part, where nothing lies between parts."""
    low = _least(given, part)
    total, flow, size = (np.bincount(part, weights) for weights in (conductance, driven, np.abs(driven)))
    stuck = np.flatnonzero(np.isnan(low) & (total == 0) & (np.abs(flow) > ROUNDING * size))
    if stuck.size:
        _refuse_flow(description, number, part, int(stuck[0]), float(flow[stuck[0]]))
    level = np.divide(flow, total, out=np.zeros_like(flow), where=total != 0)
    return np.where(np.isnan(low), level, low)


def _potential(first: NDArray, second: NDArray, stiffness: NDArray, flow_in: NDArray, tie: NDArray) -> NDArray:
    """Potential of each node, zero where the tie is infinite: the flows that it drives balance what flows in."""
    n, free = len(tie), np.flatnonzero(tie < np.inf)
    potential = np.zeros(n)
    diagonal = np.where(tie < np.inf, tie, 0.0)
    np.add.at(diagonal, np.concatenate([first, second]), np.tile(stiffness, 2))
    every = np.arange(n)
    places = np.concatenate([first, second, every]), np.concatenate([second, first, every])
    entries = np.concatenate([-stiffness, -stiffness, diagonal])
    try:
        potential[free] = _solved(entries, places, free, n, flow_in[free]) if free.size else 0.0
    except (RuntimeError, np.linalg.LinAlgError):
        raise InputError("start", "no steady state: active loads cancel the inertia of lines", "'rest'") from None
    return potential


def _solved(entries: NDArray, places: tuple[NDArray, NDArray], free: NDArray, n: int, flow_in: NDArray) -> NDArray:
    """Solution of the balances at the free nodes; small ones are spared the import of the sparse solver."""
    if n <= SMALL:
        matrix = np.zeros((n, n))
        np.add.at(matrix, places, entries)
        return np.linalg.solve(matrix[np.ix_(free, free)], flow_in)
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    matrix = coo_array((entries, places), shape=(n, n)).tocsc()[free][:, free]
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(flow_in)
