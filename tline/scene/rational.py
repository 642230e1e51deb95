"""Rational impedances Z(s): what loads and links with resistance, inductance or capacitance share."""

import math
import numbers
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.quantity import LARGEST, SMALLEST, Capacitance, Inductance, Parameter, PositiveResistance
from tline.scene.ratio import Ratio
from tline.words.wording import shown

if TYPE_CHECKING:
    from passivity import RationalFunction

MOST_STATES = 20  # degree up to which double precision holds ladders of L and C to some 1e-12


class RationalImpedance(Element):
    """An element that is a rational impedance between its two terminals."""

    _ratio: Ratio = PrivateAttr()
    _rational: "RationalFunction | None" = PrivateAttr(default=None)

    @property
    def ratio(self) -> Ratio:
        """Z(s) without common factors, exact for the decimals typed."""
        return self._ratio

    def rational(self) -> "RationalFunction":
        """Z(s), exact for the decimals typed."""
        if self._rational is None:
            self._rational = self._ratio.function
        return self._rational

    def _find_ratio(self) -> Ratio:
        raise NotImplementedError

    @model_validator(mode="after")
    def _readable(self):
        self._ratio = self._find_ratio()
        return self


@lru_cache(maxsize=1024)
def exact(value: float) -> Fraction:
    """The shortest decimal that is this float: what was typed."""
    return Fraction(repr(float(value)))


def _as_typed(value: float | str) -> Fraction | float | str:
    return exact(value) if isinstance(value, float) and math.isfinite(value) else value


class OneResistance(RationalImpedance):
    """One resistor."""

    resistance: PositiveResistance = Field(description="R")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([exact(self.resistance)], [1])


class OneInductance(RationalImpedance):
    """One inductor, Z(s) = sL."""

    inductance: Inductance = Field(description="L")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([exact(self.inductance), 0], [1])


class OneCapacitance(RationalImpedance):
    """One capacitor, Z(s) = 1/(sC)."""

    capacitance: Capacitance = Field(description="C")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([1], [exact(self.capacitance), 0])


class _RLC(RationalImpedance):
    resistance: PositiveResistance | None = Field(default=None, description="R")
    inductance: Inductance | None = Field(default=None, description="L")
    capacitance: Capacitance | None = Field(default=None, description="C")

    def _exact_values(self) -> tuple[Fraction | None, Fraction | None, Fraction | None]:
        r, ind, c = (None if x is None else exact(x) for x in (self.resistance, self.inductance, self.capacitance))
        if r is ind is c is None:
            raise InputError("", "no element given", "at least one of resistance, inductance and capacitance")
        return r, ind, c


class SeriesRLC(_RLC):
    """R, L and C one after the other."""

    def _find_ratio(self) -> Ratio:
        r, ind, c = self._exact_values()
        if c is None:
            return Ratio.of_fractions([ind or 0, r or 0], [1])
        return Ratio.of_fractions([c * (ind or 0), c * (r or 0), 1], [c, 0])


class ParallelRLC(_RLC):
    """R, L and C side by side."""

    def _find_ratio(self) -> Ratio:
        r, ind, c = self._exact_values()
        conductance = 1 / r if r else 0
        if ind is None:
            return Ratio.of_fractions([1], [c or 0, conductance])
        return Ratio.of_fractions([1, 0], [c or 0, conductance, 1 / ind])


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

    def _find_ratio(self) -> Ratio:
        self._rational = self._read()
        ratio = Ratio.of(self._rational)
        _check_limits(ratio)
        return ratio

    def _read(self) -> "RationalFunction":
        if self.expression is not None and self.numerator is None and self.denominator is None:
            return self._from_expression(self.expression)
        if self.expression is not None or self.numerator is None or self.denominator is None:
            given = [key for key in ("expression", "numerator", "denominator") if getattr(self, key) is not None]
            expected = "either expression, or numerator and denominator"
            raise InputError("", "its Z(s) is not given once", expected, ", ".join(given) or "none")
        if self.parameters:
            raise InputError("parameters", "they belong to an expression, not to coefficients")
        return self._from_coefficients(self.numerator, self.denominator)

    def _from_expression(self, expression: str) -> "RationalFunction":
        from passivity import ExpressionError, RationalFunction

        try:
            values = {name: exact(value) for name, value in self.parameters.items()}
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


def _check_limits(impedance: Ratio) -> None:
    for limit in (impedance.at_zero(), impedance.at_infinity()):
        if limit not in (0, math.inf) and not SMALLEST <= abs(limit) <= LARGEST:
            problem = "its resistance at low or high frequency is out of range"
            raise InputError("", problem, f"{SMALLEST:g} to {LARGEST:g}")
    if impedance.degree > MOST_STATES:
        raise InputError("", "its degree in s is too high", f"at most {MOST_STATES}", f"{impedance.degree}")
