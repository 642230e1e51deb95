"""A way through the network: lines from node to node, and what happens along them."""

import heapq
from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import refuse_coupled
from tline.scene.lossless import refuse_losses
from tline.scene.mistakes import nearest
from tline.scene.scene import Scene
from tline.solver.curve import drawable
from tline.solver.result import Result


class Leg(NamedTuple):
    """One line of a route."""

    line: str
    forward: bool  # from its end 1 to its end 2
    start: float  # delay from the route's first node, s


class Route(NamedTuple):
    """Lines from one node to another."""

    nodes: tuple[str, ...]
    legs: tuple[Leg, ...]
    marks: tuple[float, ...]  # places of the nodes: metres if all lengths are known, else delays in seconds
    unit: str

    @property
    def lines(self) -> tuple[str, ...]:
        """Names of the lines, for `simulate(scene, record=route.lines)`."""
        return tuple(leg.line for leg in self.legs)


def route(scene: Scene, start: str | None = None, end: str | None = None) -> Route:
    """The way of least delay between two nodes; without them the whole chain, if the scene is one.

    Parameters
    ----------
    scene : Scene
        The network.
    start, end : str, optional
        Two different nodes.

    Raises
    ------
    InputError
        Unknown nodes, no way between them, or none given in a scene that is no chain.
    """
    refuse_losses(scene, "only its ends are known, not what is along it")
    ends: dict[str, list[tuple[str, bool, str]]] = defaultdict(list)  # node -> (line, forward, other node)
    refuse_coupled(scene.lines, "a path")
    for name, line in scene.lines.items():
        near, far = line.nodes
        ends[near].append((name, True, far))
        ends[far].append((name, False, near))
    if start is None or end is None:
        start, end = _chain_ends(ends)
    for node in (start, end):
        if node not in ends:
            raise InputError("path", "no such node", nearest(node, list(ends)), f"'{node}'")
    if start == end:
        raise InputError("path", "leads nowhere", "two different nodes", f"'{start}' twice")
    way = _least_delay(scene, ends, start, end)
    parameters = [scene.lines[line].parameters for line, _, _ in way]
    delays = _sums([line.delay or 0.0 for line in parameters])
    lengths = [line.length for line in parameters if line.length is not None]
    known = len(lengths) == len(way)
    legs = tuple(Leg(line, forward, t) for (line, forward, _), t in zip(way, delays, strict=False))
    nodes = (start, *(node for _, _, node in way))
    return Route(nodes, legs, _sums(lengths) if known else delays, "m" if known else "s")


def _sums(values: list[float]) -> tuple[float, ...]:
    return tuple(float(x) for x in np.cumsum([0.0, *values]))


def _chain_ends(ends: dict[str, list[tuple[str, bool, str]]]) -> tuple[str, str]:
    outer = [node for node, here in ends.items() if len(here) == 1]
    connected, grown = set(outer[:1]), set(outer[:1])
    while grown:
        grown = {other for node in grown for _, _, other in ends[node]} - connected
        connected |= grown
    if len(outer) != 2 or len(connected) < len(ends) or max(map(len, ends.values())) > 2:
        rings = [node for node, here in ends.items() if any(other == node for _, _, other in here)]
        why = f", for one has both ends at node '{rings[0]}'" if rings else ""
        expected = "the two nodes between which to look" if len(ends) > 1 else "a scene with two nodes or more"
        raise InputError("path", f"the lines form no chain{why}", expected)
    return outer[0], outer[1]


def _least_delay(scene: Scene, ends: dict, start: str, end: str) -> list[tuple[str, bool, str]]:
    """Dijkstra's algorithm; returns (line, forward, node it leads to)."""
    came: dict[str, tuple[str, bool, str]] = {}
    waiting, done = [(0.0, start, ("", True, ""))], set()
    while waiting and end not in done:
        delay, node, step = heapq.heappop(waiting)
        if node in done:
            continue
        done.add(node)
        came[node] = step
        for line, forward, other in ends[node]:
            total = delay + (scene.lines[line].parameters.delay or 0.0)
            heapq.heappush(waiting, (total, other, (line, forward, node)))
    if end not in done:
        raise InputError("path", "no lines lead there", got=f"'{start}' and '{end}'")
    way, node = [], end
    while node != start:
        line, forward, before = came[node]
        way.append((line, forward, node))
        node = before
    return way[::-1]


def effort_along(result: Result, way: Route, x: NDArray, t: NDArray) -> NDArray:
    """Effort at places x of a route (in its unit) and instants t, shape (len(t), len(x)).

    Raises
    ------
    InputError
        A line of the route was not recorded.
    """
    for name in way.lines:
        if name not in result.lines:
            raise InputError("path", f"line '{name}' was not recorded", "simulate(scene, record=route.lines)")
    records = [drawable(result.lines[name]) for name in way.lines]
    marks = np.array(way.marks)
    leg = np.clip(np.searchsorted(marks, x) - 1, 0, len(records) - 1)
    share = np.clip((x - marks[leg]) / np.diff(marks)[leg], 0.0, 1.0)
    effort = np.empty((len(t), len(x)))
    for column, (k, part) in enumerate(zip(leg, share, strict=True)):
        a, b = records[k].waves(t, float(part if way.legs[k].forward else 1.0 - part))
        effort[:, column] = (a + b) / 2
    return effort


def start_effort(result: Result, way: Route) -> float:
    """Effort at the route's first node before t = 0."""
    record = result.lines[way.lines[0]]
    return (record.a1.before + record.b1.before) / 2
