"""Lines so short beside all else that they may be lumped; whether that is good enough is measured afterwards."""

from collections.abc import Iterable
from itertools import pairwise
from math import isfinite

import numpy as np

from tline.errors import InputError
from tline.scene.coupled import ends_of
from tline.scene.scene import Scene
from tline.solver.description.elements import elements_of
from tline.solver.description.groups import grouped
from tline.solver.description.nodes import Node, nodes_of
from tline.solver.description.resolution import SLABS_PER_DELAY, resolution
from tline.solver.prepared import probed

SHORT = 1 / 8  # of the slab that suits all other lines
SETTLED = 1  # slab, within which a group has to settle after a front
MOST_STATES = 12  # of a group


def short_lines(scene: Scene, record: Iterable[str]) -> tuple[list[str], float]:
    """Names of the lines that may be lumped, and the time they take to settle after a front, s.

    `record` names lines that may not be lumped.

    Lines that probes see stay lines. So do lines at a node with a switch, a non-linear element, a measured
    load or an active resistance, and lines in which a front would ring on for longer than a part of a slab.

    Examples
    --------
    >>> long, stub = ({"z0": 50, "delay": 1, "nodes": ["a", "b"]}, {"z0": 50, "delay": 1e-4, "nodes": ["b", "c"]})
    >>> scene = Scene(
    ...     medium="electrical", t_end=9, lines={"long": long, "stub": stub}, probes={"p": {"at": "a"}},
    ...     loads={"r": {"at": "b", "kind": "resistor", "resistance": 50}},
    ... )
    >>> short_lines(scene, [])[0]
    ['stub']
    """
    nodes = nodes_of(scene)
    barred = {name for name, node in nodes.items() if _barred(node)}
    barred |= {node for link in scene.links.values() for node in link.nodes}
    barred |= {node for element in elements_of(scene, nodes) for node in element.nodes}
    barred |= {node for end in ends_of(scene.lines) for node in (*end.conductors, *end.modal)}
    kept = {name for name, line in scene.single_lines.items() if barred & {*line.nodes}} | {*record} | probed(scene)
    while short := _far_shorter(scene, nodes, kept):
        restless, settle = _restless(scene, nodes, short)
        if not restless:
            return short, settle
        kept |= restless
    return [], 0.0


def _barred(node: Node) -> bool:
    return bool(node.switches) or node.conductance < 0 or node.measured is not None


def _far_shorter(scene: Scene, nodes: dict[str, Node], kept: set[str]) -> list[str]:
    """The lines that are far shorter than a slab which suits all others."""
    delays = {name: line.parameters.delay or 0.0 for name, line in scene.single_lines.items()}
    floor = min(delays[name] for name in kept)
    for longer, bound in pairwise(sorted(set(delays.values()), reverse=True)):
        if bound < floor and bound * SLABS_PER_DELAY < SHORT * longer:
            short = [name for name, delay in delays.items() if delay <= bound]
            try:
                if bound < SHORT * resolution(scene, nodes, cells=dict.fromkeys(short, 1)).h:
                    return short
            except InputError:  # the others want too much, too
                continue
    return []


def _restless(scene: Scene, nodes: dict[str, Node], short: list[str]) -> tuple[set[str], float]:
    """Those of them that lie in a group which settles too slowly, or is too large; and how slowly the others settle."""
    cells = dict.fromkeys(short, 1)
    try:
        lumped = nodes_of(scene, cells)
    except InputError:  # loads of too high a degree, or too far apart
        return set(short), 0.0
    none = np.zeros(len(scene.single_lines))
    groups, _ = grouped(scene, cells, lumped, none, none)
    h = resolution(scene, nodes, cells=cells).h
    quick = [group.settles(h) for group in groups]
    h = resolution(scene, nodes, cells=cells, settle=max(filter(isfinite, quick), default=0.0)).h
    found: set[str] = set()
    slowest = 0.0
    for group in groups:
        size, settle = sum(lump.states for lump in group.lumps) + 2 * len(group.nodes), group.settles(h)
        if size > MOST_STATES or settle >= SETTLED * h:
            found |= {lump.name for lump in group.lumps}
        slowest = max(slowest, settle)
    return found, slowest
