"""Routes through the network, over lines and links from node to node, and waves and effort along them."""

import heapq
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.connected import connected
from tline.scene.load import linked_pairs
from tline.scene.medium import readable
from tline.scene.refuse import refuse_coupled
from tline.scene.scene import Scene
from tline.solver.result.dense_output import Inside, InStretches, inside
from tline.solver.result.result import Result
from tline.units import handy
from tline.words.wording import nearest


class Leg(NamedTuple):
    """One line of a route."""

    line: str
    forward: bool  # from its end 1 to its end 2
    start: float  # delay from the route's first node, s
    span: tuple[float, float]  # places of its ends, in the route's unit


class PathStep(NamedTuple):
    """One step of a path: an edge out of a node."""

    line: str  # empty for a link
    forward: bool
    node: str  # node at its other end


Steps = Mapping[str, Sequence[PathStep]]


class Route(NamedTuple):
    """Lines from one node to another."""

    nodes: tuple[str, ...]
    legs: tuple[Leg, ...]
    marks: tuple[float, ...]  # places of the nodes: metres if all lengths are known, else delays in seconds
    unit: str

    @property
    def lines(self) -> tuple[str, ...]:
        """Names of the lines, for `simulate(scene, record=route.lines)`."""
        return tuple(dict.fromkeys(leg.line for leg in self.legs))

    @property
    def labels(self) -> dict[float, str]:
        """Names by place; nodes connected by a link share one."""
        names: dict[float, str] = {}
        for mark, node in zip(self.marks, self.nodes, strict=True):
            names[mark] = f"{names[mark]}–{node}" if mark in names else node
        return names


def route(scene: Scene, *nodes: str) -> Route:
    """Find the route of least delay through some nodes; without them the whole chain, if the scene is one.

    Links, such as pumps and valves, are passed without a delay.

    Parameters
    ----------
    scene : Scene
        The network.
    *nodes : str
        The first node, any to be passed on the way, and the last.

    Raises
    ------
    InputError
        Unknown nodes, no way between them, or none given in a scene that is not a chain.

    Examples
    --------
    >>> delays = {"ab": 1, "bc": 1, "ac": 1}
    >>> lines = {name: {"nodes": [*name], "z0": 50, "delay": delay} for name, delay in delays.items()}
    >>> ring = Scene(medium="electrical", t_end=9, lines=lines, probes={"p": {"at": "a", "line": "ab"}})
    >>> route(ring, "a", "b").nodes, route(ring, "a", "c", "b").nodes
    (('a', 'b'), ('a', 'c', 'b'))
    """
    refuse_coupled(scene.lines, "a path")
    by_line = _steps((name, line.nodes) for name, line in scene.lines.items())
    linked = [("", pair) for pair in linked_pairs(scene)]
    steps = _steps([*((name, line.nodes) for name, line in scene.lines.items()), *linked])
    for node in nodes:
        if not isinstance(node, str):
            raise InputError("path", "is no name", "each node as an argument of its own", f"{node!r}")
    nodes = nodes or _chain_ends(by_line) or _chain_ends(steps) or _no_chain(by_line)
    for node in nodes:
        if node not in steps:
            raise InputError("path", "no such node", nearest(node, list(steps)), f"'{node}'")
    for node, after in pairwise(nodes):
        if node == after:
            raise InputError("path", "leads nowhere", "two different nodes", f"'{node}' twice")
    way = [step for start, end in pairwise(nodes) for step in _least_delay(scene, steps, start, end)]
    lines = [scene.lines[step.line].parameters if step.line else None for step in way]
    if not any(lines):
        raise InputError("path", "no line lies on it", "nodes between which there is one", f"{' and '.join(nodes)}")
    delays = _sums([line.delay or 0.0 if line else 0.0 for line in lines])
    known = all(line is None or line.length is not None for line in lines)
    marks = _sums([line.length or 0.0 if line else 0.0 for line in lines]) if known else delays
    spans = zip(way, delays, pairwise(marks), strict=False)
    legs = tuple(Leg(step.line, step.forward, delay, span) for step, delay, span in spans if step.line)
    return Route((nodes[0], *(step.node for step in way)), legs, marks, "m" if known else "s")


def axis(way: Route, scene: Scene) -> tuple[float, str]:
    """Size of the unit for places of a route, and the label of its axis."""
    size, unit = handy(way.marks[-1], readable(scene).shown.get(way.unit, way.unit))
    return size, f"{'distance' if way.unit == 'm' else 'delay'} from {way.nodes[0]} [{unit}]"


def _sums(values: list[float]) -> tuple[float, ...]:
    return tuple(float(x) for x in np.cumsum([0.0, *values]))


def _steps(pairs: Iterable[tuple[str, tuple[str, str]]]) -> Steps:
    found = defaultdict(list)
    for line, (near, far) in pairs:
        found[near].append(PathStep(line, True, far))
        found[far].append(PathStep(line, False, near))
    return found


def _chain_ends(steps: Steps) -> tuple[str, ...]:
    """Ends of a chain; empty if the steps are not a chain."""
    outer = [node for node, here in steps.items() if len(here) == 1]
    whole = connected(outer[:1], ((node, step.node) for node, here in steps.items() for step in here))
    chain = len(outer) == 2 and len(whole) == len(steps) and max(map(len, steps.values())) <= 2
    return (outer[0], outer[1]) if chain else ()


def _no_chain(steps: Steps) -> tuple[str, ...]:
    rings = [node for node, here in steps.items() if any(step.node == node for step in here)]
    why = f", for one has both ends at node '{rings[0]}'" if rings else ""
    expected = "the two nodes between which to look" if len(steps) > 1 else "a scene with two nodes or more"
    raise InputError("path", f"the lines form no chain{why}", expected)


def _least_delay(scene: Scene, steps: Steps, start: str, end: str) -> list[PathStep]:
    """Find the path of least delay by Dijkstra's algorithm."""
    came: dict[str, tuple[str, PathStep]] = {}
    waiting, done = [(0.0, start, "", PathStep("", True, start))], set()
    while waiting and end not in done:
        delay, node, before, step = heapq.heappop(waiting)
        if node in done:
            continue
        done.add(node)
        came[node] = before, step
        for out in steps[node]:
            further = scene.lines[out.line].parameters.delay or 0.0 if out.line else 0.0
            heapq.heappush(waiting, (delay + further, out.node, node, out))
    if end not in done:
        raise InputError("path", "no lines lead there", got=f"'{start}' and '{end}'")
    way, node = [], end
    while node != start:
        node, step = came[node]
        way.append(step)
    return way[::-1]


STRETCHES, FEWEST = 320, 8  # on the whole route, and on each line, at whose ends extremes are known


class RouteExtremes(NamedTuple):
    """Effort along a route, Pa or V; where lines meet there are two equal places, and at a link two efforts."""

    x: NDArray  # (places,) in the route's unit
    start: NDArray  # before t = 0
    lowest: NDArray
    highest: NDArray


def waves_along(result: Result, way: Route, x: NDArray, t: NDArray) -> NDArray:
    """Waves that travel along a route and against it, at places x (in its unit) and instants t.

    Shape (2, len(t), len(x)). Half of their sum is the effort.
    """
    legs = _insides(result, way, min(len(x), STRETCHES))
    at = np.clip(np.searchsorted([leg.span[1] for leg in way.legs], x), 0, len(legs) - 1)
    both = np.empty((2, len(t), len(x)))
    for k in np.unique(at):
        leg, here = way.legs[k], at == k
        part = np.clip((x[here] - leg.span[0]) / (leg.span[1] - leg.span[0]), 0.0, 1.0)
        waves = _waves(legs[k], t, part if leg.forward else 1.0 - part)
        both[:, :, here] = waves if leg.forward else waves[::-1]
    return both


def _waves(seen: Inside | InStretches, t: NDArray, shares: NDArray) -> NDArray:
    """Waves a and b at places of one line, shape (2, len(t), len(shares))."""
    if isinstance(seen, InStretches) or seen.lost is not None:
        return np.stack([seen.waves(t, share) for share in shares.tolist()], axis=-1)
    (a, _), (_, b), late = seen.record.at_end1, seen.record.at_end2, shares * seen.record.delay
    return np.stack([a(t[:, None] - late), b(t[:, None] - (seen.record.delay - late))])


def effort_along(result: Result, way: Route, x: NDArray, t: NDArray) -> NDArray:
    """Effort at places x of a route (in its unit) and instants t, shape (len(t), len(x))."""
    return waves_along(result, way, x, t).mean(axis=0)


def extremes_along(result: Result, way: Route) -> RouteExtremes:
    """Effort before t = 0, and lowest and highest effort of the run, line after line."""
    places, efforts = [], []
    for leg, seen in zip(way.legs, _insides(result, way), strict=True):
        share, forward = seen.places, leg.forward
        places.append(leg.span[0] + (leg.span[1] - leg.span[0]) * (share if forward else 1 - share[::-1]))
        efforts.append(seen.extremes(result.t)[:, :: 1 if forward else -1])
    return RouteExtremes(np.concatenate(places), *np.concatenate(efforts, axis=1))


def start_effort(result: Result, way: Route) -> float:
    """Effort at the route's first node before t = 0."""
    leg = way.legs[0]
    record = result.lines[leg.line]
    a, b = (record.a1, record.b1) if leg.forward else (record.a2, record.b2)
    return (a.before + b.before) / 2


def _insides(result: Result, way: Route, stretches: int = STRETCHES) -> list[Inside | InStretches]:
    return [inside(result, leg.line, _cells(way, leg, stretches)) for leg in way.legs]


def _cells(way: Route, leg: Leg, stretches: int) -> int:
    return max(round(stretches * (leg.span[1] - leg.span[0]) / way.marks[-1]), FEWEST)
