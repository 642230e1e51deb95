"""Lines so short beside all else that they may be lumped; whether that is good enough is measured afterwards."""

from collections.abc import Iterable
from itertools import pairwise
from math import inf, isfinite

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import resolution
from tline.solver.description.slab import SLABS_PER_DELAY

SHORT = 1 / 8  # of the slab that suits all other lines
SETTLED = 1  # slab, within which a group has to settle after a front
MOST_STATES = 12  # of a group


def short_lines(description: Description, record: Iterable[str]) -> tuple[list[str], float]:
    """Names of the lines that may be lumped, and the time they take to settle after a front, s.

    `record` names lines that may not be lumped.

    Lines that probes see stay lines. So do lines at a node with a switch, a non-linear element, a measured
    load or an active resistance, and lines in which a front would ring on for longer than a part of a slab.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.description.description import describe
    >>> long, stub = ({"z0": 50, "delay": 1, "nodes": ["a", "b"]}, {"z0": 50, "delay": 1e-4, "nodes": ["b", "c"]})
    >>> scene = Scene(
    ...     medium="electrical", t_end=9, lines={"long": long, "stub": stub}, probes={"p": {"at": "a"}},
    ...     loads={"r": {"at": "b", "kind": "resistor", "resistance": 50}},
    ... )
    >>> short_lines(describe(scene), [])[0]
    ['stub']
    """
    delays = [line.delay for line in description.lines.values()]
    if min(delays) * SLABS_PER_DELAY >= SHORT * max(delays):
        return [], 0.0
    barred = {name for name, node in description.nodes.items() if _barred(node)}
    joints = [link.nodes for link in description.scene.links.values()] + [one.nodes for one in description.elements]
    barred |= {node for joint in joints for node in joint}
    barred |= {node for end in description.ends for node in (*end.conductors, *end.modal)}
    kept = {name for name, line in description.lines.items() if barred & {*line.nodes}}
    kept |= {*record} | description.probed | {name for name, line in description.lines.items() if line.losses}
    while short := _far_shorter(description, kept):
        restless, settle = _restless(description, short)
        if not restless:
            return short, settle
        kept |= restless
    return [], 0.0


def _barred(node: Node) -> bool:
    return bool(node.switches) or node.conductance < 0 or node.measured is not None


def _far_shorter(description: Description, kept: set[str]) -> list[str]:
    """The lines that are far shorter than a slab which suits all others."""
    delays = {name: line.delay for name, line in description.lines.items()}
    floor = min((delays[name] for name in kept), default=inf)
    for longer, bound in pairwise(sorted(set(delays.values()), reverse=True)):
        if bound < floor and bound * SLABS_PER_DELAY < SHORT * longer:
            short = [name for name, delay in delays.items() if delay <= bound]
            try:
                if bound < SHORT * resolution(description, sections=dict.fromkeys(short, 1)).h:
                    return short
            except InputError:  # the others want too much, too
                continue
    return []


def _restless(description: Description, short: list[str]) -> tuple[set[str], float]:
    """Those of them that lie in a group which settles too slowly, or is too large; and how slowly the others settle."""
    sections = dict.fromkeys(short, 1)
    try:
        groups, _ = description.grouped(sections)
    except InputError:  # loads of too high a degree, or too far apart
        return set(short), 0.0
    h = resolution(description, sections=sections).h
    quick = [group.settles(h) for group in groups]
    h = resolution(description, sections=sections, settle=max(filter(isfinite, quick), default=0.0)).h
    found: set[str] = set()
    slowest = 0.0
    for group in groups:
        size, settle = sum(lumped.states for lumped in group.lumped_lines) + 2 * len(group.nodes), group.settles(h)
        if size > MOST_STATES or settle >= SETTLED * h:
            found |= {lumped.name for lumped in group.lumped_lines}
        slowest = max(slowest, settle)
    return found, slowest
