"""Equations of what stands at the nodes of a circuit and between them.

Whatever it is, it binds the efforts u of its terminals and the flows i into them: M u + N i = E x, with states x that
follow dx/dt = Q x + P u + R i.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.line.modes import Modes
from tline.solver.description.given import Ports, Switch
from tline.solver.description.lines import Line
from tline.solver.description.load_step import StateSpace


class Branch(NamedTuple):
    """Something with terminals: what it is called, their places among the nodes of its group, and its equations."""

    where: str
    nodes: NDArray
    ports: Ports
    to_air: bool = False  # whether it sees the gauge pressure at its nodes
    flows: tuple[float, ...] = ()  # into its terminals before t = 0, where these are known
    switch: Switch | None = None  # if it is one

    def before(self, t: float) -> "Branch":
        """The same just before an instant."""
        if self.switch is None:
            return self
        now = self.switch.after if self.switch.time < t else self.switch.before
        return self._replace(ports=between(resistance(float(now))))


class PlacedBranch(NamedTuple):
    """The same with the names of the nodes."""

    where: str
    nodes: Sequence[str]
    ports: Ports
    flows: tuple[float, ...] = ()
    switch: Switch | None = None
    to_air: bool = False

    def among(self, places: NDArray) -> Branch:
        """The branch where its nodes have these places."""
        return Branch(self.where, places, self.ports, self.to_air, self.flows, self.switch)


def one_port(reflection: StateSpace, z: float) -> Ports:
    """An impedance from one terminal to the reference: a = u + z i enters, b = u - z i comes back of it."""
    A, b, c, d = reflection
    return Ports(1.0 - d, -z * (1.0 + d), c, A, b, z * b)


def between(ports: Ports) -> Ports:
    """The same from one terminal to another."""
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
