"""What stands at the nodes of a scene, sorted by how its power is found."""

from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.load import Load, Matched, Reservoir, Resistor, Short, Switch
from tline.scene.multiport import ControlledSource, Multiport
from tline.scene.rational_load import Parallel, Rational, Series
from tline.solver.description.description import Description
from tline.solver.description.elements import Element
from tline.solver.description.excitation import places_of
from tline.solver.description.given import Shape
from tline.solver.description.nodes import Node, lowered
from tline.wording import place

SUPPLIED, DISSIPATED, STORED, TAKEN = range(4)  # what an element is expected to do with energy
GIVING = {"pump", "rotor"}  # kinds of laws
STORING = {"gas", "tank", "table"}  # those that may give what they held; a table may hold a source


class Member(NamedTuple):
    """An element whose flow follows from what the lines bring; also what holds the effort of a node."""

    where: str
    nodes: tuple[str, ...]
    column: int
    may_give: bool
    through: bool = False  # whether what flows in at one node flows out at the other
    to_air: bool = True  # whether it leads from its nodes to the open air at their heights
    series: float = 0.0  # resistance that the flow passes
    beside: float = 0.0  # conductance beside the rest


class Resistive(NamedTuple):
    """A resistor, or a switch that is never shut without a resistance."""

    where: str
    node: str
    conductance: float
    switch: Switch | None = None


class Excitation(NamedTuple):
    """A source with a resistance, or one of flow."""

    where: str
    node: str
    waveform: Shape
    breaks: NDArray  # in slabs
    conductance: float
    is_effort: bool


class Inventory(NamedTuple):
    """All of a scene."""

    members: list[Member]
    conductors: list[Resistive]
    drives: list[Excitation]


def inventory_of(
    description: Description, nodes: Mapping[str, Node], lumped: Collection[str], h: float, t_end: float
) -> Inventory:
    """Sort what stands at nodes. What stands beside a held effort and has no known conductance is not seen.

    Parameters
    ----------
    nodes : mapping of str to Node
        With what is attached to them.
    lumped : collection of str
        Names of lumped lines.
    h, t_end : float
        Slab width and end of the run, s.
    """
    unseen = {name for name, node in nodes.items() if not node.ends and node.held is None}
    drives, conductors = list(_drives(description, nodes, h, t_end)), list(_conductors(description))
    members = [
        *(Member(one.where, (one.node,), TAKEN, True, to_air=False) for one in drives if one.node in unseen),
        *(Member(one.where, (one.node,), DISSIPATED, False) for one in conductors if one.node in unseen),
        *_holding(description),
        *_dynamic(description, nodes),
        *(_non_linear(element) for element in description.elements),
        *(_lumped(name, description) for name in lumped),
    ]
    return Inventory(
        members,
        [one for one in conductors if one.node not in unseen],
        [one for one in drives if one.node not in unseen],
    )


def _drives(description: Description, nodes: Mapping[str, Node], h: float, t_end: float) -> Iterator[Excitation]:
    for name, source in description.scene.sources.items():
        if np.isfinite(source.conductance):
            breaks = places_of([(source.value, 1.0)], t_end, h)
            value = lowered(source.value, nodes[source.at].height.level) if source.is_effort else source.value
            yield Excitation(place("sources", name), source.at, value, breaks, source.conductance, source.is_effort)


def _lumped(name: str, description: Description) -> Member:
    """A lumped line."""
    return Member(place("lines", name), description.lines[name].nodes, TAKEN, description.steady, to_air=False)


def _conductors(description: Description) -> Iterator[Resistive]:
    for name, load in description.scene.loads.items():
        g = _conductance(load, description)
        if np.isfinite(g):
            yield Resistive(place("loads", name), load.at, g, load if isinstance(load, Switch) else None)


def _conductance(load: Load, description: Description) -> float:
    """Of a resistor, some finite one of a switch with resistances; infinite for all others."""
    match load:
        case Resistor() if load.resistance > 0:
            return float(1 / load.resistance)
        case Switch() if load.before > 0 and load.after > 0:
            return 0.0
        case Matched():
            return sum(line.nodes.count(load.at) / line.z0 for line in description.lines.values())
    return np.inf


def _holding(description: Description) -> Iterator[Member]:
    """What holds the effort of its node, or may."""
    for name, source in description.scene.sources.items():
        if np.isinf(source.conductance):
            yield Member(place("sources", name), (source.at,), SUPPLIED, True, to_air=False)
    for name, load in description.scene.loads.items():
        if isinstance(load, Reservoir):
            yield Member(place("loads", name), (load.at,), SUPPLIED, True, to_air=False)
        elif isinstance(load, Short | Resistor | Switch) and np.isinf(_conductance(load, description)):
            yield Member(place("loads", name), (load.at,), DISSIPATED, False)


def _dynamic(description: Description, nodes: Mapping[str, Node]) -> Iterator[Member]:
    """What has states of its own, and multiports."""
    scene, holds = description.scene, description.steady
    for name, load in scene.loads.items():
        if isinstance(load, Rational) and nodes[load.at].held is None:
            R = float(getattr(load, "resistance", None) or 0.0)
            column = STORED if isinstance(load, Series | Parallel) else TAKEN
            series, beside = isinstance(load, Series) and R, isinstance(load, Parallel) and R and 1 / R
            yield Member(place("loads", name), (load.at,), column, holds, series=float(series), beside=float(beside))
    for name, link in scene.links.items():
        if isinstance(link, Multiport):
            yield Member(place("links", name), link.nodes, TAKEN, holds or isinstance(link, ControlledSource))


def _non_linear(element: Element) -> Member:
    """A valve, pump, vessel, diode or table; beyond a valve may be a pressure."""
    kind, back = element.law.kind, element.law.constants[0] if element.other is None else 0.0
    column = SUPPLIED if kind in GIVING else TAKEN if kind in STORING or back else DISSIPATED
    between = len(element.nodes) == 2
    return Member(element.where, tuple(element.nodes), column, column != DISSIPATED, between, to_air=not between)
