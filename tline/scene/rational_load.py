"""Loads that are rational impedances Z(s) from their node to the reference."""

from typing import Any, Literal

from tline.scene.element import AtNode
from tline.scene.rational import (
    AnyImpedance,
    OneCapacitance,
    OneInductance,
    ParallelRLC,
    RationalImpedance,
    SeriesRLC,
    coefficients_of,
)


class Rational(RationalImpedance, AtNode):
    """A load that is a rational impedance."""


class Inductor(OneInductance, Rational):
    """An inductance, Z(s) = sL."""

    kind: Literal["inductor"] = "inductor"


class Capacitor(OneCapacitance, Rational):
    """A capacitance, Z(s) = 1/(sC)."""

    kind: Literal["capacitor"] = "capacitor"


class Series(SeriesRLC, Rational):
    """R, L and C one after the other, Z(s) = R + sL + 1/(sC); those not given are absent."""

    kind: Literal["series"] = "series"


class Parallel(ParallelRLC, Rational):
    """R, L and C side by side, 1/Z(s) = 1/R + 1/(sL) + sC; those not given are absent."""

    kind: Literal["parallel"] = "parallel"


class Impedance(AnyImpedance, Rational):
    """Any rational Z(s): an expression with its parameters, or coefficients with the highest power first.

    Examples
    --------
    >>> Impedance(at="far", expression="R + s*L", parameters={"R": 5, "L": "2 nH"}).rational()(0j)
    (5+0j)
    """

    kind: Literal["impedance"] = "impedance"

    @classmethod
    def from_system(cls, system: Any, at: str) -> "Impedance":
        """Z(s) from a scipy.signal or python-control system with one input (flow) and one output (effort)."""
        return cls.model_validate({"at": at} | coefficients_of(system))
