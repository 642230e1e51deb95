"""Inventory of the elements at nodes, sorted by the way their power is computed."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tline.scene.element import Between
from tline.scene.load import Matched, Reservoir, Resistor, Short
from tline.scene.rational import RationalImpedance
from tline.scene.switch import Switch
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import Shape
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node, lowered
from tline.words.wording import place

SUPPLIED, DISSIPATED, STORED, TAKEN = range(4)  # what an element is expected to do with energy


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
    members.extend(map(_non_linear, group.elements))
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


def _non_linear(element: PlacedLaw) -> Member:
    """A valve, pump, vessel, diode or table; beyond a valve may be a pressure."""
    kind, back = element.kind, element.law.constants[0] if element.to_node is None else 0.0
    column = SUPPLIED if kind.supplies else TAKEN if kind.returns or back else DISSIPATED
    between = len(element.nodes) == 2
    return Member(element.where, tuple(element.nodes), column, column != DISSIPATED, between, to_air=not between)
