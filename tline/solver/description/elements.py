"""The elements of a scene: laws between nodes, and linear links and sources as branches; which are active, or may be.

Each branch relates the efforts u of its terminals and the flows i into them: M u + N i = E x, with states x that
follow dx/dt = Q x + P u + R i.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tline.line.modes import Modes
from tline.scene.ports import Multiport
from tline.scene.rational import Impedance, RationalImpedance
from tline.solver.description.circuit import StateSpace, reflection
from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw, Governor, LawKind, Ports, Ratio, Scene, Switch, Tabled
from tline.solver.description.lines import Line
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import Verdict
    from tline.solver.description.nodes import Node


class PlacedLaw(NamedTuple):
    """A law between two nodes, or a node and the reference (None)."""

    where: str
    law: ElementLaw
    from_node: str | None
    to_node: str | None
    above_level: float = 0.0  # of a node that it leads from to the open air; of one that it leads to, less than zero
    levels: tuple[float, float] = (0.0, 0.0)  # of its nodes, each where its gauge pressure is zero
    control: float = 1.0  # what scales it over time, just before t = 0

    @property
    def kind(self) -> LawKind:
        """Kind of the law."""
        return self.law.of_kind

    @property
    def constants(self) -> tuple[float, ...]:
        """Constants of the law, the first (its reference effort) at the element's height, and of its governor."""
        first, *rest = self.law.constants
        return (first + self.above_level, *rest, *(self.governor.flat() if self.governor is not None else ()))

    @property
    def governor(self) -> Governor | None:
        """Governor of the opening, with set points referred to the level; a difference of efforts has none."""
        governor = self.law.governor
        if governor is None or (governor.here[0] and governor.there[0]):
            return governor
        here, there = (
            (gain, value + level)
            for (gain, value), level in zip((governor.here, governor.there), self.levels, strict=True)
        )
        return governor._replace(here=here, there=there)

    def share(self, opening: float) -> float:
        """Share of the capacity at an opening that moves by itself."""
        assert self.governor is not None
        if not self.governor.shares:
            return opening
        openings, shares = np.array(self.governor.shares).T
        return float(np.interp(opening, openings, shares))

    @property
    def nodes(self) -> list[str]:
        """Nodes of the element."""
        return [node for node in (self.from_node, self.to_node) if node is not None]

    def seen(self, nodes: Mapping[str, Node]) -> float:
        """Thévenin resistance at the nodes, of lines and resistances alone."""
        return sum(1 / abs(nodes[node].total) for node in self.nodes if nodes[node].held is None)


def elements_of(
    scene: Scene,
    laws: Mapping[tuple[str, str], ElementLaw],
    nodes: Mapping[str, Node],
    like: Iterable[PlacedLaw] = (),
) -> list[PlacedLaw]:
    """Select the non-linear elements of a scene, without those between prescribed efforts.

    An element equal to that at the same place in `like` is taken over, and so is an equal opening.
    """
    found, known = [], {element.where: element for element in like}
    for (part, name), law in laws.items():
        ends = (scene.links if part == "links" else scene.loads)[name].terminals
        if any(node is not None and nodes[node].held is None for node in ends):
            where, before = place(part, name), 1.0
            if where in known and known[where].law is law:
                found.append(known[where])
                continue
            from_node, to_node = reversed(ends) if law.reverse else ends
            levels = [nodes[node].above_level if node is not None else 0.0 for node in (from_node, to_node)]
            height = 0.0 if None not in ends else levels[0] if to_node is None else -levels[1]
            if law.factor is not None and where in known and known[where].law.factor == law.factor:
                law, before = law._replace(factor=known[where].law.factor), known[where].control
            elif law.factor is not None:
                before = just_before(law.factor)
            found.append(PlacedLaw(where, law, from_node, to_node, height, (levels[0], levels[1]), before))
    return found


def impedances(scene: Scene) -> dict[str, Impedance]:
    """Loads and links that may be active, by place; R, L and C above zero are not."""
    return {place(*at): x for at, x in scene.placed if isinstance(x, Impedance)}


def active_impedances(scene: Scene) -> dict[str, Verdict]:
    """Loads and links whose impedance is refuted to be positive real, by place."""
    given = impedances(scene)
    if not given:
        return {}
    from passivity import Status, check_positive_real

    verdicts = {where: check_positive_real(element.rational()) for where, element in given.items()}
    return {where: verdict for where, verdict in verdicts.items() if verdict.status is Status.REFUTED}


def controlled_sources(scene: Scene) -> list[str]:
    """Names of the links that may feed waves."""
    return [name for name, link in scene.links.items() if link.kind == "controlled source"]


def laws_not_through_the_origin(scene: Scene) -> dict[str, str]:
    """Sentence on each law that is not passive by its kind, by place.

    A monotone law is passive if its flow is zero without effort; otherwise it contains a source.
    """
    told = {place(*at): law.of_kind.source(law.constants) for at, law in scene.laws.items()}
    return {where: sentence for where, sentence in told.items() if sentence}


def active_parts(scene: Scene) -> dict[str, str]:
    """Sentence on each active load, and on each link that may be active, by place."""
    told = {where: f"is active: {verdict.why}" for where, verdict in active_impedances(scene).items()}
    return told | {place("links", name): "may feed waves" for name in controlled_sources(scene)}


class Branch(NamedTuple):
    """Linear element: name, its terminals' nodes by name, or by place in their group, and equations."""

    where: str
    nodes: Any  # sequence of names, or array of places
    ports: Ports
    flows: tuple[float, ...] = ()  # into its terminals before t = 0, where these are known
    switch: Switch | None = None  # if it is one
    to_air: bool = False  # whether its efforts are gauge pressures

    def before(self, t: float) -> Branch:
        """Return the branch just before an instant, with the switch set."""
        if self.switch is None:
            return self
        now = self.switch.after if self.switch.time < t else self.switch.before
        return self._replace(ports=between(resistance(float(now))))


def one_port(reflection: StateSpace, z: float) -> Ports:
    """An impedance from one terminal to the reference: a = u + z i enters, b = u - z i comes back of it."""
    A, b, c, d = reflection
    return Ports(1.0 - d, -z * (1.0 + d), c, A, b, z * b)


def between(ports: Ports) -> Ports:
    """Convert equations of a one-port to those of a branch between two terminals."""
    M, N, E, Q, P, R = ports
    none = np.zeros((1, E.shape[1]))
    return Ports(
        np.block([[M, -M], [np.zeros((1, 2))]]),
        np.block([[N, np.zeros((1, 1))], [np.ones((1, 2))]]),
        np.vstack([E, none]),
        Q,
        np.hstack([P, -P]),
        np.hstack([R, 0.0 * R]),
    )


def resistance(r: float) -> Ports:
    """A resistance from one terminal to the reference, zero and infinite ones included."""
    M, N = (np.zeros((1, 1)), np.ones((1, 1))) if np.isinf(r) else (np.ones((1, 1)), np.full((1, 1), -r))
    none = np.zeros((0, 1))
    return Ports(M, N, none.T, np.zeros((0, 0)), none, none)


def lc_sections(line: Line, number: int) -> Ports:
    """A lossless line as n inductors z0 T/n in a row, with a capacitor T/(n z0) between each two.

    States are the inductors' flows times z0 and the capacitors' efforts, in order along the line; so all rates are n/T.
    """
    n, rate = 2 * number - 1, number / line.delay
    Q = rate * (np.eye(n, k=-1) - np.eye(n, k=1))
    P, E = np.zeros((n, 2)), np.zeros((2, n))
    P[0, 0], P[-1, 1] = rate, -rate
    E[0, 0], E[1, -1] = 1.0, -1.0
    return Ports(np.zeros((2, 2)), line.z0 * np.eye(2), E, Q, P, 0.0 * P)


def conductors(modes: Modes) -> Ports:
    """An end of coupled conductors, an ideal transformer: v = T u of the modes, and T' i = -j flows out of them.

    Terminals are the conductors, then the modes.
    """
    T = modes.T
    none, one = np.zeros_like(T), np.eye(len(T))
    states = np.zeros((0, 2 * len(T)))
    M, N = np.block([[one, -T], [none, none]]), np.block([[none, none], [T.T, one]])
    return Ports(M, N, states.T, np.zeros((0, 0)), states, states)


def branches_of(scene: Scene, nodes: Mapping[str, Node]) -> Iterator[Branch]:
    """Yield the branches of a scene; `nodes` are those of the scene."""
    for name, link in scene.links.items():
        where = place("links", name)
        match link:
            case Multiport():
                yield Branch(where, link.nodes, link.ports(), to_air=link.is_grounded)
            case RationalImpedance():
                z, Z = 1 / nodes[link.nodes[0]].alone, link.ratio
                realised = one_port(reflection(Z, z, where), z) if Z.degree else resistance(Z.at_zero())
                yield Branch(where, link.nodes, between(realised))
            case Switch():
                yield Branch(where, link.nodes, between(resistance(float(link.before))), switch=link)
    for name, source in scene.sources.items():
        if source.nodes is not None:
            where, r = place("sources", name), 1 / source.conductance if source.conductance else np.inf
            if source.is_effort:
                yield Branch(where, (*source.nodes, where), _behind(r))
            elif np.isfinite(r):
                yield Branch(where, source.nodes, between(resistance(r)))


def _behind(r: float) -> Ports:
    """Equations of an effort behind a resistance, from its plus to its minus; that of a third node prescribes it."""
    none = np.zeros((0, 3))
    M = np.array([[1.0, -1.0, -1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    N = np.array([[-r, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return Ports(M, N, none.T, np.zeros((0, 0)), none, none)


def resistive(scene: Scene, nodes: Mapping[str, Node]) -> list[PlacedLaw]:
    """Linear resistances to a steady flow, with the effort of a source in series, between nodes not both prescribed."""
    found: list[tuple[str, tuple[str, str], float, float]] = []  # with that effort, and the resistance
    for name, link in scene.links.items():
        if isinstance(link, RationalImpedance) and link.ratio.at_zero():
            found.append((place("links", name), link.nodes, 0.0, link.ratio.at_zero()))
        elif isinstance(link, Switch):
            r = float(link.after if link.time < 0 else link.before)
            found.append((place("links", name), link.nodes, 0.0, r))
    for name, source in scene.sources.items():
        if source.nodes is not None and source.conductance > 0:
            open_ = just_before(source.value) if source.is_effort else 0.0
            found.append((place("sources", name), source.nodes, open_, 1 / source.conductance))
    return [
        PlacedLaw(where, ElementLaw(Tabled.name, (0.0, 2.0, open_, open_ + r, 0.0, 1.0)), *at)
        for where, at, open_, r in found
        if abs(r) < np.inf and any(nodes[node].held is None for node in at)
    ]


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
