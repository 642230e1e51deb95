"""Linear links, and sources between two nodes: as branches, and what is left of them while nothing changes."""

from collections.abc import Iterator, Mapping

import numpy as np

from tline.scene.multiport import Multiport
from tline.scene.rational import RationalImpedance
from tline.scene.switch import Switch
from tline.solver.description.branches import PlacedBranch, between, one_port, resistance
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw, Ports, Ratio, Scene
from tline.solver.description.load_step import reflection
from tline.solver.description.nodes import Node
from tline.words.wording import place


def branches_of(scene: Scene, nodes: Mapping[str, Node]) -> Iterator[PlacedBranch]:
    """Those of a scene; `nodes` are its own."""
    for name, link in scene.links.items():
        where = place("links", name)
        match link:
            case Multiport():
                yield PlacedBranch(where, link.nodes, link.ports(), to_air=link.is_grounded)
            case RationalImpedance():
                yield PlacedBranch(where, link.nodes, _across(link, 1 / nodes[link.nodes[0]].alone, where))
            case Switch():
                yield PlacedBranch(where, link.nodes, between(resistance(float(link.before))), switch=link)
    for name, source in scene.sources.items():
        if source.nodes is not None:
            where, r = place("sources", name), 1 / source.conductance if source.conductance else np.inf
            if source.is_effort:
                yield PlacedBranch(where, (*source.nodes, where), _behind(r))
            elif np.isfinite(r):
                yield PlacedBranch(where, source.nodes, between(resistance(r)))


def _across(link: RationalImpedance, z: float, where: str) -> Ports:
    """Equations of an impedance between two nodes, realised by its reflection against z."""
    impedance = link.ratio
    if impedance.degree == 0:
        return between(resistance(impedance.at_zero()))
    return between(one_port(reflection(impedance, z, where), z))


def _behind(r: float) -> Ports:
    """Equations of an effort behind a resistance, from its plus to its minus; that of a third node prescribes it."""
    none = np.zeros((0, 3))
    M = np.array([[1.0, -1.0, -1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    N = np.array([[-r, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return Ports(M, N, none.T, np.zeros((0, 0)), none, none)


def resistive(scene: Scene, nodes: Mapping[str, Node]) -> list[PlacedLaw]:
    """Those that pass a steady flow in proportion to the effort, beside what a source adds, where a node is free."""
    return [law for law in _resistive(scene) if any(nodes[node].held is None for node in law.nodes)]


def _resistive(scene: Scene) -> Iterator[PlacedLaw]:
    for name, link in scene.links.items():
        if isinstance(link, RationalImpedance):
            r = link.ratio.at_zero()
            if 0 < abs(r) < float("inf"):
                yield _straight(place("links", name), link.nodes, 0.0, r)
        elif isinstance(link, Switch):
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


def inductive(scene: Scene) -> list[tuple[str, str, float]]:
    """Nodes of links that are shorts to a steady flow, and their inductances."""
    found = []
    for link in scene.links.values():
        if isinstance(link, RationalImpedance) and link.ratio.at_zero() == 0:
            found.append((*link.nodes, link.ratio.numerator[-2] / link.ratio.denominator[-1]))
    return found


def capacitive(scene: Scene) -> list[tuple[tuple[str, str], float]]:
    """Nodes of links that are no shorts to a steady flow, and their capacities."""
    links = [link for link in scene.links.values() if isinstance(link, RationalImpedance)]
    return [(link.nodes, admittance(link.ratio)[1]) for link in links if link.ratio.at_zero()]


def admittance(impedance: Ratio) -> tuple[float, float]:
    """1/Z = conductance + s·capacity + ..., of one that is no short to a steady flow."""
    n1, n0, d1, d0 = (a for side in impedance for a in (0, *side)[-2:])
    return 1 / impedance.at_zero(), (d1 * n0 - d0 * n1) / (n0 * n0)
