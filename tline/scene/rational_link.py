"""Links that are rational impedances Z(s) between two nodes."""

from typing import Any, Literal

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.between import Between
from tline.scene.rational import (
    AnyImpedance,
    OneCapacitance,
    OneInductance,
    OneResistance,
    ParallelRLC,
    RationalImpedance,
    SeriesRLC,
    coefficients_of,
)


class RationalLink(RationalImpedance, Between):
    """A rational impedance between two nodes."""


class ResistorLink(OneResistance, RationalLink):
    """A resistance between two nodes."""

    kind: Literal["resistor"] = "resistor"


class InductorLink(OneInductance, RationalLink):
    """An inductance between two nodes, Z(s) = sL."""

    kind: Literal["inductor"] = "inductor"


class CapacitorLink(OneCapacitance, RationalLink):
    """A capacitance between two nodes, Z(s) = 1/(sC): it blocks a steady flow.

    Examples
    --------
    >>> CapacitorLink(nodes=["driver", "line"], capacitance="100 nF").rational().at_zero()
    inf
    """

    kind: Literal["capacitor"] = "capacitor"


class SeriesLink(SeriesRLC, RationalLink):
    """R, L and C one after the other between two nodes, Z(s) = R + sL + 1/(sC); those not given are absent."""

    kind: Literal["series"] = "series"


class ParallelLink(ParallelRLC, RationalLink):
    """R, L and C side by side between two nodes, 1/Z(s) = 1/R + 1/(sL) + sC; those not given are absent."""

    kind: Literal["parallel"] = "parallel"


class ImpedanceLink(AnyImpedance, RationalLink):
    """Any rational Z(s) between two nodes: an expression with its parameters, or coefficients, highest power first."""

    kind: Literal["impedance"] = "impedance"

    @model_validator(mode="after")
    def _parts(self):
        if self.ratio.is_zero:
            raise InputError("", "its impedance is zero", "one node in place of the two")
        return self

    @classmethod
    def from_system(cls, system: Any, nodes: tuple[str, str]) -> "ImpedanceLink":
        """Z(s) from a scipy.signal or python-control system with one input (flow) and one output (effort)."""
        return cls.model_validate({"nodes": nodes} | coefficients_of(system))
