"""Rational impedances Z(s): what loads and links with resistance, inductance or capacitance share."""

import math
import numbers
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.quantity import LARGEST, SMALLEST, Capacitance, Inductance, Parameter, PositiveResistance
from tline.wording import shown

if TYPE_CHECKING:
    from passivity import RationalFunction

MOST_STATES = 20  # degree up to which double precision holds ladders of L and C to some 1e-12


class RationalImpedance(Element):
    """An element that is a rational impedance between its two terminals."""

    _rational: "RationalFunction" = PrivateAttr()

    def rational(self) -> "RationalFunction":
        """Z(s), exact for the decimals typed."""
        return self._rational

    def _build(self) -> "RationalFunction":
        raise NotImplementedError

    @model_validator(mode="after")
    def _readable(self):
        self._rational = self._build()
        return self


def _exact(value: float) -> Fraction:
    """The shortest decimal that is this float: what was typed."""
    return Fraction(repr(float(value)))


@cache
def _s() -> "RationalFunction":
    """The impedance s, of 1 H."""
    from passivity import RationalFunction

    return RationalFunction.from_coefficients([1, 0], [1])


def _constant(value: float) -> "RationalFunction":
    """The impedance of a resistor."""
    from passivity import RationalFunction

    return RationalFunction.constant(_exact(value))


def _as_typed(value: float | str) -> Fraction | float | str:
    return _exact(value) if isinstance(value, float) and math.isfinite(value) else value


class OneResistance(RationalImpedance):
    """One resistor."""

    resistance: PositiveResistance = Field(description="R")

    def _build(self) -> "RationalFunction":
        return _constant(self.resistance)


class OneInductance(RationalImpedance):
    """One inductor, Z(s) = sL."""

    inductance: Inductance = Field(description="L")

    def _build(self) -> "RationalFunction":
        return _constant(self.inductance) * _s()


class OneCapacitance(RationalImpedance):
    """One capacitor, Z(s) = 1/(sC)."""

    capacitance: Capacitance = Field(description="C")

    def _build(self) -> "RationalFunction":
        return (_constant(self.capacitance) * _s()).inverse()


class _RLC(RationalImpedance):
    resistance: PositiveResistance | None = Field(default=None, description="R")
    inductance: Inductance | None = Field(default=None, description="L")
    capacitance: Capacitance | None = Field(default=None, description="C")

    def _impedances(self) -> "list[RationalFunction]":
        parts = []
        if self.resistance is not None:
            parts.append(_constant(self.resistance))
        if self.inductance is not None:
            parts.append(_constant(self.inductance) * _s())
        if self.capacitance is not None:
            parts.append((_constant(self.capacitance) * _s()).inverse())
        if not parts:
            raise InputError("", "no element given", "at least one of resistance, inductance and capacitance")
        return parts


class SeriesRLC(_RLC):
    """R, L and C one after the other."""

    def _build(self) -> "RationalFunction":
        first, *rest = self._impedances()
        for part in rest:
            first = first + part
        return first


class ParallelRLC(_RLC):
    """R, L and C side by side."""

    def _build(self) -> "RationalFunction":
        first, *rest = self._impedances()
        for part in rest:
            first = first.parallel(part)
        return first


def _number_or_text(value: Any) -> Any:
    if isinstance(value, str) or (isinstance(value, numbers.Real) and not isinstance(value, bool)):
        return value
    raise InputError("", "not a number", "a number or text such as '10 nH'", shown(value))


Coefficient = Annotated[int | float | str, BeforeValidator(_number_or_text)]


class AnyImpedance(RationalImpedance):
    """Any rational Z(s): an expression with its parameters, or coefficients with the highest power first."""

    expression: str | None = Field(default=None, description="Z(s) in SI, such as 'R + s*L'")
    parameters: dict[str, Parameter] = Field(default_factory=dict, description="values of the names in the expression")
    numerator: list[Coefficient] | None = Field(default=None, description="coefficients, highest power first, SI")
    denominator: list[Coefficient] | None = Field(default=None, description="coefficients, highest power first, SI")

    def _build(self) -> "RationalFunction":
        if self.expression is not None and self.numerator is None and self.denominator is None:
            return _within_limits(self._from_expression(self.expression))
        if self.expression is not None or self.numerator is None or self.denominator is None:
            given = [key for key in ("expression", "numerator", "denominator") if getattr(self, key) is not None]
            expected = "either expression, or numerator and denominator"
            raise InputError("", "its Z(s) is not given once", expected, ", ".join(given) or "none")
        if self.parameters:
            raise InputError("parameters", "they belong to an expression, not to coefficients")
        return _within_limits(self._from_coefficients(self.numerator, self.denominator))

    def _from_expression(self, expression: str) -> "RationalFunction":
        from passivity import ExpressionError, RationalFunction

        try:
            values = {name: _exact(value) for name, value in self.parameters.items()}
            return RationalFunction.from_expression(expression, values)
        except ExpressionError as error:
            at, _, name = error.where.partition("parameter ")
            problem = f"{at}: {error.problem}" if at else error.problem
            where = f"parameters.{name}" if name else "expression"
            raise InputError(where, problem, error.expected, error.got) from None

    def _from_coefficients(self, *sides: list[Coefficient]) -> "RationalFunction":
        from passivity import ExpressionError, RationalFunction

        try:
            numerator, denominator = (list(map(_as_typed, side)) for side in sides)
            return RationalFunction.from_coefficients(numerator, denominator)
        except ExpressionError as error:
            raise InputError(error.where, error.problem, error.expected, error.got) from None


def coefficients_of(system: Any) -> dict[str, list[str]]:
    """Numerator and denominator of a scipy.signal or python-control system from one input to one output."""
    from passivity import RationalFunction

    function = RationalFunction.from_system(system)
    return {"numerator": [str(a) for a in function.numerator], "denominator": [str(a) for a in function.denominator]}


def _within_limits(impedance: "RationalFunction") -> "RationalFunction":
    for limit in (impedance.at_zero(), impedance.at_infinity()):
        if limit not in (0, math.inf) and not SMALLEST <= abs(limit) <= LARGEST:
            problem = "its resistance at low or high frequency is out of range"
            raise InputError("", problem, f"{SMALLEST:g} to {LARGEST:g}")
    degree = impedance.reduced().degree
    if degree > MOST_STATES:
        raise InputError("", "its degree in s is too high", f"at most {MOST_STATES}", f"{degree}")
    return impedance
