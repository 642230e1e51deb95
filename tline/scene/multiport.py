"""Linear multiports: elements without a delay whose ports are each a node and the reference, or two nodes."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator, model_validator

from tline.errors import InputError
from tline.scene.element import Name, nodes_of, optional, required, sequence_of
from tline.scene.ports import Multiport, Ports, floating
from tline.scene.quantity import Inductance, PositiveResistance, Quantity, Resistance, Role
from tline.words.wording import shown

MOST_PORTS = 16
TIGHTEST = 0.999999  # coupling of windings
ROUNDED = 1e-6  # tolerance for matrices of rounded decimals that exceed a passive one
TWO_OR_FOUR = sequence_of(
    (2, 4), "not the nodes of two ports", 'two names such as ["a", "b"], or two for each port, ["a", "b", "c", "d"]'
)


def _memoryless(M: ArrayLike, N: ArrayLike) -> Ports:
    M, N = np.array(M, float), np.array(N, float)
    none = np.zeros((0, len(M)))
    return Ports(M, N, none.T, np.zeros((0, 0)), none, none)


def _apart(nodes: tuple[str, ...]) -> tuple[str, ...]:
    for one, other in (nodes,) if len(nodes) == 2 else (nodes[:2], nodes[2:]):
        if one == other:
            problem = "both ends are at one node" if len(nodes) == 2 else "both ends of a port are at one node"
            raise InputError("", problem, "two different nodes", shown(one))
    return nodes


class _TwoPort(Multiport):
    nodes: Annotated[tuple[Name, ...], TWO_OR_FOUR, AfterValidator(_apart)] = required(
        "a node for each port, against the reference; or four: the first port from the first to the "
        "second, the second port from the third to the fourth, which may share nodes"
    )

    @property
    def is_grounded(self) -> bool:
        """Whether the ports are between a node and the reference."""
        return len(self.nodes) == 2

    def ports(self) -> Ports:
        """Equations of the multiport, with an effort and a flow for each node, in the order of its nodes."""
        return self._grounded() if self.is_grounded else floating(self._grounded())

    def _grounded(self) -> Ports:
        """Equations with both ports against the reference."""
        raise NotImplementedError


class Transformer(_TwoPort):
    """Ideal transformer: u₁ = n·u₂ across its ports, and i₂ = -n·i₁ with flows into them.

    Examples
    --------
    >>> Transformer(nodes=["a", "b"], ratio=2).ports().M.tolist()
    [[1.0, -2.0], [0.0, 0.0]]
    """

    kind: Literal["transformer"] = "transformer"
    ratio: Annotated[Quantity, Role("ratio", "")] = required("n, effort across the first port over the second's")

    @model_validator(mode="after")
    def _joins(self):
        if self.ratio == 0:
            raise InputError("ratio", "shorts the first port and leaves the second", "any other number", "0")
        return self

    def _grounded(self) -> Ports:
        n = float(self.ratio)
        return _memoryless([[1, -n], [0, 0]], [[0, 0], [n, 1]])


class Gyrator(_TwoPort):
    """Gyrator: u₁ = -R·i₂ and u₂ = R·i₁, with flows into it; a capacitor C behind it acts as an inductor R²·C."""

    kind: Literal["gyrator"] = "gyrator"
    resistance: PositiveResistance = required("R, of gyration")

    def _grounded(self) -> Ports:
        R = float(self.resistance)
        return _memoryless([[1, 0], [0, 1]], [[0, R], [-R, 0]])


class ControlledSource(_TwoPort):
    """Source at the second port, controlled by the effort across the first, which carries no flow."""

    kind: Literal["controlled source"] = "controlled source"
    gain: Annotated[Quantity, Role("gain", "")] | None = optional(
        "open effort across the second port over that across the first"
    )
    resistance: Resistance | None = optional("of the source; 0 for an ideal one")
    transconductance: Annotated[Quantity, Role("transconductance", "")] | None = optional(
        "instead of these: flow into the second port over the effort across the first, SI"
    )

    @model_validator(mode="after")
    def _drives(self):
        given = [name for name in ("gain", "resistance", "transconductance") if getattr(self, name) is not None]
        if given not in (["gain", "resistance"], ["transconductance"]):
            raise InputError("", "is not given once", "gain and resistance, or transconductance", ", ".join(given))
        if self.resistance is not None and np.isinf(self.resistance):
            raise InputError("resistance", "drives nothing", "a finite one", "inf")
        return self

    def _grounded(self) -> Ports:
        if self.transconductance is not None:
            return _memoryless([[0, 0], [-float(self.transconductance), 0]], [[1, 0], [0, 1]])
        gain, resistance = float(self.gain or 0), float(self.resistance or 0)
        return _memoryless([[0, 0], [-gain, 1]], [[1, 0], [0, -resistance]])


class CoupledInductors(_TwoPort):
    """Two coupled windings, each a port: a real transformer without losses.

    Examples
    --------
    >>> pair = CoupledInductors(nodes=["a", "b"], inductance=["1 uH", "4 uH"], coupling=0.5)
    >>> (np.linalg.inv(pair.ports().P) * 1e6).round(9).tolist()
    [[1.0, 1.0], [1.0, 4.0]]
    """

    kind: Literal["coupled inductors"] = "coupled inductors"
    inductance: tuple[Inductance, Inductance] = required("of the first winding and the second")
    coupling: Annotated[Quantity, Role("coupling", "", at_least=-1, at_most=1)] = required(
        "k, with the mutual inductance k·√(L₁·L₂); at most 0.999999"
    )

    @model_validator(mode="after")
    def _leaks(self):
        if abs(self.coupling) > TIGHTEST:
            problem, expected = "without leakage the windings are one", f"up to {TIGHTEST}, or kind = 'transformer'"
            raise InputError("coupling", problem, expected, f"{self.coupling:.9g}")
        return self

    def _grounded(self) -> Ports:
        # states are the currents of the windings
        one, two = map(float, self.inductance)
        mutual, left = float(self.coupling) * np.sqrt(one * two), one * two * (1 - float(self.coupling) ** 2)
        inverse = np.array([[two, -mutual], [-mutual, one]]) / left
        none, one = np.zeros((2, 2)), np.eye(2)
        return Ports(none, one, one, none, inverse, none)


def _different(nodes: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(nodes)) < len(nodes):
        raise InputError("", "two ports are at one node", "different nodes", shown(nodes))
    return nodes


PortNodes = Annotated[tuple[Name, ...], nodes_of(MOST_PORTS, "one for each port"), AfterValidator(_different)]


class Junction(Multiport):
    """Junction of constant scattering: incident waves a = u + z0·i give outgoing waves b = u - z0·i = S·a.

    Circulators, hybrids and power dividers; it loses nothing where S is orthogonal.

    Examples
    --------
    >>> circulator = Junction(nodes=["a", "b", "c"], z0=50, scattering=[[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    >>> circulator.ports().N[0].tolist()
    [-50.0, -0.0, -50.0]
    """

    kind: Literal["junction"] = "junction"
    nodes: PortNodes = required("one for each port")
    z0: PositiveResistance = required("reference of all ports")
    scattering: list[list[Annotated[Quantity, Role("scattering", "")]]] = required("matrix S, its rows")

    @model_validator(mode="after")
    def _fits(self):
        k = len(self.nodes)
        if [len(row) for row in self.scattering] != [k] * k:
            got = f"rows of {', '.join(str(len(row)) for row in self.scattering)}"
            raise InputError("scattering", f"not a matrix for {k} ports", f"{k} rows of {k}", got)
        norm = np.linalg.norm(np.array(self.scattering, float), 2)
        if norm > 1 + ROUNDED:
            problem = f"some waves come out {norm:.6g} times as large"
            raise InputError("scattering", problem, "at most as large, or kind = 'controlled source'")
        return self

    def ports(self) -> Ports:
        """Equations of the junction, with an effort and a flow for each node, in the order of its nodes."""
        S, one = np.array(self.scattering, float), np.eye(len(self.nodes))
        return _memoryless(one - S, -float(self.z0) * (one + S))
