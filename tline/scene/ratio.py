"""Rational impedances as whole numbers: what most scenes need of them, without the arithmetic of `passivity`."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import chain
from math import inf, lcm
from operator import attrgetter
from sys import float_info
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from passivity import RationalFunction


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
        """That of exact coefficients; leading ones may be zero."""
        common, whole = lcm(*map(attrgetter("denominator"), chain(*sides))), []
        for side in sides:
            first = 0
            while first < len(side) - 1 and not side[first]:
                first += 1
            whole.append(tuple([a.numerator * (common // a.denominator) for a in side[first:]]))
        return cls(*whole)

    @classmethod
    def of(cls, function: "RationalFunction") -> "Ratio":
        """That of a function."""
        reduced = function.reduced()
        return cls(*(tuple(map(int, side)) for side in (reduced.numerator, reduced.denominator)))

    @property
    def function(self) -> "RationalFunction":
        """The same for exact arithmetic."""
        from passivity import RationalFunction

        return RationalFunction.from_coefficients(self.numerator, self.denominator)

    @property
    def degree(self) -> int:
        """The larger degree of both."""
        return max(map(len, self)) - 1

    @property
    def is_zero(self) -> bool:
        """Whether this is a short circuit."""
        return not any(self.numerator)

    def at_zero(self) -> float:
        """The resistance to a steady flow."""
        return _quotient(self.numerator[-1], self.denominator[-1]) if self.denominator[-1] else inf

    def at_infinity(self) -> float:
        """The limit at high frequency."""
        more = len(self.numerator) - len(self.denominator)
        if more or not self.denominator[0]:
            return inf if more >= 0 else 0.0
        return _quotient(self.numerator[0], self.denominator[0])

    def parallel(self, other: "Ratio") -> "Ratio":
        """The impedance of this beside another."""
        return Ratio.of(self.function.parallel(other.function))


def _quotient(a: int, b: int) -> float:
    """a/b, the largest or smallest float where it is beyond floats and yet neither infinite nor zero."""
    try:
        value = a / b
    except OverflowError:
        value = inf
    size = min(max(abs(value), float_info.min), float_info.max) if a else 0.0
    return size if (a < 0) == (b < 0) else -size
