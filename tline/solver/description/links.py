"""Linear links and sources between two nodes as branches, and their resistances to a steady flow.

Equations of elements at the nodes of a circuit and between them.

Each relates the efforts u of its terminals and the flows i into them: M u + N i = E x, with states x that
follow dx/dt = Q x + P u + R i.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from tline.line.modes import Modes
from tline.scene.multiport import Multiport
from tline.scene.rational import RationalImpedance
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw, Ports, Ratio, Scene, Switch
from tline.solver.description.lines import Line
from tline.solver.description.load_step import StateSpace, reflection
from tline.solver.description.nodes import Node
from tline.words.wording import place


class Branch(NamedTuple):
    """Linear element: name, its terminals' nodes by name, or by place in their group, and equations."""

    where: str
    nodes: Any  # sequence of names, or array of places
    ports: Ports
    flows: tuple[float, ...] = ()  # into its terminals before t = 0, where these are known
    switch: Switch | None = None  # if it is one
    to_air: bool = False  # whether its efforts are gauge pressures

    def before(self, t: float) -> "Branch":
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
                yield Branch(where, link.nodes, _across(link, 1 / nodes[link.nodes[0]].alone, where))
            case Switch():
                yield Branch(where, link.nodes, between(resistance(float(link.before))), switch=link)
    for name, source in scene.sources.items():
        if source.nodes is not None:
            where, r = place("sources", name), 1 / source.conductance if source.conductance else np.inf
            if source.is_effort:
                yield Branch(where, (*source.nodes, where), _behind(r))
            elif np.isfinite(r):
                yield Branch(where, source.nodes, between(resistance(r)))


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
    """Linear resistances to a steady flow, with the effort of a source in series, between nodes not both prescribed."""
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
    """Law of a resistance r with an effort `open_` in series."""
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
