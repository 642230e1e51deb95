"""Linear links, and sources between two nodes, while nothing changes: resistances, shorts, or nothing at all."""

from collections.abc import Iterator

from tline.scene.rational_link import RationalLink
from tline.scene.switch import SwitchLink
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw
from tline.wording import place


def resistive(description: Description) -> list[PlacedLaw]:
    """Those that pass a flow in proportion to the effort, beside what a source adds, where a node is not held."""
    nodes = description.nodes
    return [law for law in _resistive(description) if any(nodes[node].held is None for node in law.nodes)]


def _resistive(description: Description) -> Iterator[PlacedLaw]:
    scene = description.scene
    for name, link in scene.links.items():
        if isinstance(link, RationalLink):
            r = float(link.rational().at_zero())
            if 0 < abs(r) < float("inf"):
                yield _straight(place("links", name), link.nodes, 0.0, r)
        elif isinstance(link, SwitchLink):
            r = float(link.after if link.time < 0 else link.before)
            if r < float("inf"):
                yield _straight(place("links", name), link.nodes, 0.0, r)
    for name, source in scene.sources.items():
        if source.nodes is not None and source.conductance > 0:
            open_ = just_before(source.value) if source.is_effort else 0.0
            yield _straight(place("sources", name), source.nodes, open_, 1 / source.conductance)


def _straight(where: str, nodes: tuple[str, str], open_: float, r: float) -> PlacedLaw:
    """A law that passes no flow at one effort, and in proportion to what is beyond."""
    return PlacedLaw(where, ElementLaw("table", (0.0, 2.0, open_, open_ + r, 0.0, 1.0)), *nodes)


def inductive(description: Description) -> list[tuple[str, str, float]]:
    """Nodes of links that are shorts, and their inductances."""
    found = []
    for link in description.scene.links.values():
        if isinstance(link, RationalLink) and link.rational().at_zero() == 0:
            impedance = link.rational().reduced()
            found.append((*link.nodes, float(impedance.numerator[-2] / impedance.denominator[-1])))
    return found
