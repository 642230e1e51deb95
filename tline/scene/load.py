"""Loads: what a node lets pass to the reference."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from passivity import RationalFunction
from tline.errors import InputError
from tline.scene.element import AtNode
from tline.scene.quantity import Capacitance, Effort, Inductance, PositiveResistance, Resistance, Time
from tline.units import to_si


class NoFlow(AtNode):
    """An end that lets nothing pass: a closed pipe, an open cable."""

    kind: Literal["closed", "open"]


class Short(AtNode):
    """An end held at zero effort."""

    kind: Literal["short"] = "short"


class Reservoir(AtNode):
    """A node held at constant pressure."""

    kind: Literal["reservoir"] = "reservoir"
    pressure: Effort


class Matched(AtNode):
    """The one line's own z0: no wave comes back."""

    kind: Literal["matched"] = "matched"


class Resistor(AtNode):
    """A resistance, zero and infinity included."""

    kind: Literal["resistor"] = "resistor"
    resistance: Resistance


class Switch(AtNode):
    """A valve or switch whose resistance changes from one value to another at an instant."""

    kind: Literal["switch", "valve"]
    before: Resistance
    after: Resistance
    time: Time


class _Elements(AtNode):
    resistance: PositiveResistance | None = None
    inductance: Inductance | None = None
    capacitance: Capacitance | None = None

    @model_validator(mode="after")
    def _something(self):
        if self.resistance is None and self.inductance is None and self.capacitance is None:
            raise InputError("", "no element given", "at least one of resistance, inductance and capacitance")
        return self

    def _impedances(self) -> list[RationalFunction]:
        exact = RationalFunction.from_coefficients
        parts = []
        if self.resistance is not None:
            parts.append(exact([float(self.resistance)], [1]))
        if self.inductance is not None:
            parts.append(exact([float(self.inductance), 0], [1]))
        if self.capacitance is not None:
            parts.append(exact([1], [float(self.capacitance), 0]))
        return parts


class Series(_Elements):
    """R, L and C one after the other; those not given are absent."""

    kind: Literal["series"] = "series"

    def rational(self) -> RationalFunction:
        """Z(s) = R + sL + 1/(sC)."""
        first, *rest = self._impedances()
        for part in rest:
            first = first + part
        return first


class Parallel(_Elements):
    """R, L and C side by side; those not given are absent."""

    kind: Literal["parallel"] = "parallel"

    def rational(self) -> RationalFunction:
        """1/Z(s) = 1/R + 1/(sL) + sC."""
        first, *rest = self._impedances()
        for part in rest:
            first = first.parallel(part)
        return first


class Impedance(AtNode):
    """Any rational Z(s): an expression with its parameters, or coefficients with the highest power first.

    Examples
    --------
    >>> Impedance(at="far", expression="R + s*L", parameters={"R": 5, "L": "2 nH"}).rational()(0j)
    (5+0j)
    """

    kind: Literal["impedance"] = "impedance"
    expression: str | None = None
    parameters: dict[str, float | str] = Field(default_factory=dict)
    numerator: list[float | str] | None = None
    denominator: list[float | str] | None = None

    @model_validator(mode="after")
    def _readable(self):
        if (self.expression is None) == (self.numerator is None):
            raise InputError("", "its Z(s) is not given once", "either expression, or numerator and denominator")
        if (self.numerator is None) != (self.denominator is None):
            raise InputError("", "numerator and denominator go together", "both")
        self.rational()
        return self

    def rational(self) -> RationalFunction:
        """Z(s), exact for the decimals typed."""
        if self.expression is None:
            return RationalFunction.from_coefficients(self.numerator or [], self.denominator or [])
        values = {name: to_si(value, None, f"parameters.{name}") for name, value in self.parameters.items()}
        return RationalFunction.from_expression(self.expression, values)

    @classmethod
    def from_system(cls, system: Any, at: str) -> "Impedance":
        """Z(s) from a scipy.signal or python-control system with one input (flow) and one output (effort)."""
        function = RationalFunction.from_system(system)
        numerator: list[float | str] = [str(a) for a in function.numerator]
        denominator: list[float | str] = [str(a) for a in function.denominator]
        return cls(at=at, numerator=numerator, denominator=denominator)


Load = Annotated[
    NoFlow | Short | Reservoir | Matched | Resistor | Switch | Series | Parallel | Impedance,
    Field(discriminator="kind"),
]
