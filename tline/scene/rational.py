"""Rational impedances Z(s): base of loads and links with resistance, inductance or capacitance."""

import math
import numbers
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import chain
from math import inf, lcm
from operator import attrgetter
from sys import float_info
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.element import AtNode, Between, Placed, optional, required
from tline.scene.quantity import (
    LARGEST,
    SMALLEST,
    Capacitance,
    Inductance,
    LoadResistance,
    Parameter,
    PositiveResistance,
    Quantity,
)
from tline.words.wording import shown

if TYPE_CHECKING:
    from passivity import RationalFunction

MOST_STATES = 20  # degree up to which double precision holds ladders of L and C to some 1e-12


class Ratio(NamedTuple):
    """Coefficients of numerator and denominator, highest power first, of polynomials without common factors.

    Examples
    --------
    >>> Ratio.of_fractions([Fraction(1, 2), 0], [Fraction(1, 3)])
    Ratio(numerator=(3, 0), denominator=(2,))
    """

    numerator: tuple[int, ...]
    denominator: tuple[int, ...]

    @classmethod
    def of_fractions(cls, *sides: Sequence[Fraction | int]) -> "Ratio":
        """Reduce exact coefficients, whose leading ones may be zero."""
        common, whole = lcm(*map(attrgetter("denominator"), chain(*sides))), []
        for side in sides:
            first = 0
            while first < len(side) - 1 and not side[first]:
                first += 1
            whole.append(tuple([a.numerator * (common // a.denominator) for a in side[first:]]))
        return cls(*whole)

    @classmethod
    def of(cls, function: "RationalFunction") -> "Ratio":
        """Return the ratio of a rational function."""
        reduced = function.reduced()
        return cls(*(tuple(map(int, side)) for side in (reduced.numerator, reduced.denominator)))

    @property
    def function(self) -> "RationalFunction":
        """Rational function with the same coefficients for exact arithmetic."""
        from passivity import RationalFunction

        return RationalFunction.from_coefficients(self.numerator, self.denominator)

    @property
    def degree(self) -> int:
        """Larger degree of numerator and denominator."""
        return max(map(len, self)) - 1

    @property
    def is_zero(self) -> bool:
        """Whether the impedance is a short circuit."""
        return not any(self.numerator)

    def at_zero(self) -> float:
        """Resistance to a steady flow."""
        return _quotient(self.numerator[-1], self.denominator[-1]) if self.denominator[-1] else inf

    def at_infinity(self) -> float:
        """Limit at high frequency."""
        more = len(self.numerator) - len(self.denominator)
        if more or not self.denominator[0]:
            return inf if more >= 0 else 0.0
        return _quotient(self.numerator[0], self.denominator[0])

    def parallel(self, other: "Ratio") -> "Ratio":
        """Impedance of this in parallel with another."""
        return Ratio.of(self.function.parallel(other.function))


def _quotient(a: int, b: int) -> float:
    """Quotient a/b, or the largest or smallest float where it exceeds their range but is neither infinite nor zero."""
    try:
        value = a / b
    except OverflowError:
        value = inf
    size = min(max(abs(value), float_info.min), float_info.max) if a else 0.0
    return size if (a < 0) == (b < 0) else -size


class RationalImpedance(Placed):
    """Element with a rational impedance between its two terminals."""

    stores: ClassVar[bool] = False  # whether it stores energy, apart from its resistances
    _ratio: Ratio = PrivateAttr()
    _rational: "RationalFunction | None" = PrivateAttr(default=None)

    @property
    def series(self) -> float:
        """Resistance in series with the whole element."""
        return 0.0

    @property
    def beside(self) -> float:
        """Conductance in parallel with the rest."""
        return 0.0

    @property
    def ratio(self) -> Ratio:
        """Impedance Z(s) without common factors, exact for the decimals typed."""
        return self._ratio

    def rational(self) -> "RationalFunction":
        """Impedance Z(s), exact for the decimals typed."""
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
    """Shortest decimal that gives this float, as it was typed."""
    return Fraction(repr(float(value)))


def _as_typed(value: float | str) -> Fraction | float | str:
    return exact(value) if isinstance(value, float) and math.isfinite(value) else value


class AnyResistance(AtNode):
    """Resistance from a node to the reference, zero and infinity included."""

    resistance: LoadResistance = required("effort over flow")


class BetweenResistance(RationalImpedance, Between):
    """Resistance between two nodes."""

    resistance: PositiveResistance = required("R")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([exact(self.resistance)], [1])


class Resistor(Placed, load=AnyResistance, link=BetweenResistance):
    """Resistance; at a node zero and infinity included."""

    kind: Literal["resistor"] = "resistor"
    if TYPE_CHECKING:  # of both
        resistance: Quantity = Quantity(0, "")


class Inductor(RationalImpedance):
    """Inductance, Z(s) = sL."""

    kind: Literal["inductor"] = "inductor"
    stores = True
    inductance: Inductance = required("L")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([exact(self.inductance), 0], [1])


class Capacitor(RationalImpedance):
    """Capacitance, Z(s) = 1/(sC), which blocks a steady flow.

    Examples
    --------
    >>> Capacitor(nodes=["driver", "line"], capacitance="100 nF").rational().at_zero()
    inf
    """

    kind: Literal["capacitor"] = "capacitor"
    stores = True
    capacitance: Capacitance = required("C")

    def _find_ratio(self) -> Ratio:
        return Ratio.of_fractions([1], [exact(self.capacitance), 0])


class _RLC(RationalImpedance):
    resistance: PositiveResistance | None = optional("R")
    inductance: Inductance | None = optional("L")
    capacitance: Capacitance | None = optional("C")

    def _exact_values(self) -> tuple[Fraction | None, Fraction | None, Fraction | None]:
        given = self.resistance, self.inductance, self.capacitance
        if given == (None, None, None):
            raise InputError("", "no element given", "at least one of resistance, inductance and capacitance")
        r, ind, c = [None if x is None else exact(x) for x in given]
        return r, ind, c


class Series(_RLC):
    """R, L and C in series, Z(s) = R + sL + 1/(sC); those not given are absent."""

    kind: Literal["series"] = "series"
    stores = True

    @property
    def series(self) -> float:  # noqa: D102
        return float(self.resistance or 0.0)

    def _find_ratio(self) -> Ratio:
        r, ind, c = self._exact_values()
        if c is None:
            return Ratio.of_fractions([ind or 0, r or 0], [1])
        return Ratio.of_fractions([c * (ind or 0), c * (r or 0), 1], [c, 0])


class Parallel(_RLC):
    """R, L and C in parallel, 1/Z(s) = 1/R + 1/(sL) + sC; those not given are absent."""

    kind: Literal["parallel"] = "parallel"
    stores = True

    @property
    def beside(self) -> float:  # noqa: D102
        return float(1 / self.resistance) if self.resistance else 0.0

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


class Impedance(RationalImpedance):
    """Rational Z(s): an expression with its parameters, or coefficients with the highest power first.

    Examples
    --------
    >>> Impedance(at="far", expression="R + s*L", parameters={"R": 5, "L": "2 nH"}).rational()(0j)
    (5+0j)
    """

    kind: Literal["impedance"] = "impedance"
    expression: str | None = optional("Z(s) in SI, such as 'R + s*L'")
    parameters: dict[str, Parameter] = Field(default_factory=dict, description="values of the names in the expression")
    numerator: list[Coefficient] | None = optional("coefficients, highest power first, SI")
    denominator: list[Coefficient] | None = optional("coefficients, highest power first, SI")

    def _find_ratio(self) -> Ratio:
        self._rational = self._read()
        ratio = Ratio.of(self._rational)
        _check_limits(ratio)
        return ratio

    @model_validator(mode="after")
    def _parts(self):
        if isinstance(self, Between) and self.ratio.is_zero:
            raise InputError("", "its impedance is zero", "one node in place of the two")
        return self

    @classmethod
    def from_system(cls, system: Any, at: str | None = None, nodes: tuple[str, str] | None = None) -> "Impedance":
        """Create Z(s) at a node, or between two, from a system of scipy.signal or python-control, flow to effort."""
        from passivity import RationalFunction

        Z = RationalFunction.from_system(system)
        sides: dict[str, Any] = {
            "numerator": [str(a) for a in Z.numerator],
            "denominator": [str(a) for a in Z.denominator],
        }
        return cls(**({"at": at} if nodes is None else {"nodes": nodes}), **sides)

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


def _check_limits(impedance: Ratio) -> None:
    for limit in (impedance.at_zero(), impedance.at_infinity()):
        if limit not in (0, math.inf) and not SMALLEST <= abs(limit) <= LARGEST:
            problem = "its resistance at low or high frequency is out of range"
            raise InputError("", problem, f"{SMALLEST:g} to {LARGEST:g}")
    if impedance.degree > MOST_STATES:
        raise InputError("", "its degree in s is too high", f"at most {MOST_STATES}", f"{impedance.degree}")
