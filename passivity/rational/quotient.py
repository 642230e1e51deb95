"""Quotients of two integer polynomials, and their exact arithmetic."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from typing import Self, TypeAlias, TypeVar

from flint import fmpz_poly

from passivity.errors import ExpressionError
from passivity.expression.number import fraction
from passivity.size import powered

Number: TypeAlias = int | float | Fraction
Q = TypeVar("Q", bound="Quotient")


def _with_numbers(operation: Callable[[Q, Q], Q]) -> "Callable[[Q, Q | Number], Q]":
    """Let a number stand for a constant as the second operand."""

    def either(self: Q, other: Q | Number) -> Q:
        if isinstance(other, Real):
            other = self.constant(fraction(other, "number"))
        if not isinstance(other, Quotient):
            return NotImplemented
        return operation(self, other)

    return either


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Quotient:
    """The pair (p : q) of two integer polynomials in ``s``.

    Open circuit (1 : 0) and short circuit (0 : 1) are ordinary values; there is one infinity, without a sign.
    Factors common to p and q stay until `reduced` is called: they are modes that the terminals do not show.
    ``+ - * /`` take another quotient or a number; ``**`` takes an integer; ``==`` compares as functions.

    Parameters
    ----------
    p, q : flint.fmpz_poly
        Numerator and denominator, not both zero. The pair is divided by its integer content, and its sign is
        chosen so that q (p if q is zero) has a positive leading coefficient.

    Raises
    ------
    ExpressionError
        If both are zero.
    """

    p: fmpz_poly
    q: fmpz_poly

    def __post_init__(self):
        unit = self.p.content().gcd(self.q.content())
        if unit == 0:
            raise ExpressionError("", "0/0 has no value", "a numerator or a denominator that is not zero")
        if (self.q or self.p).leading_coefficient() < 0:
            unit = -unit
        object.__setattr__(self, "p", self.p // unit)
        object.__setattr__(self, "q", self.q // unit)

    @classmethod
    def constant(cls, value: Fraction) -> Self:
        """The quotient of two whole numbers."""
        return cls(fmpz_poly([value.numerator]), fmpz_poly([value.denominator]))

    @property
    def numerator(self) -> tuple[Fraction, ...]:
        """Coefficients of p, highest power first; ``(0,)`` for a short circuit."""
        return _fractions(self.p)

    @property
    def denominator(self) -> tuple[Fraction, ...]:
        """Coefficients of q, highest power first; ``(0,)`` for an open circuit."""
        return _fractions(self.q)

    @property
    def degree(self) -> int:
        """The larger degree of p and q, common factors counted."""
        return max(self.p.degree(), self.q.degree())

    @property
    def bits(self) -> int:
        """Length of the longest coefficient."""
        return max(self.p.height_bits(), self.q.height_bits())

    @property
    def is_zero(self) -> bool:
        """Whether this is the short circuit."""
        return not self.p

    @property
    def is_infinite(self) -> bool:
        """Whether this is the open circuit."""
        return not self.q

    @_with_numbers
    def __add__(self, other: Self) -> Self:
        if self.is_infinite and other.is_infinite:
            return self  # two open circuits in series
        return type(self)(self.p * other.q + other.p * self.q, self.q * other.q)

    @_with_numbers
    def __sub__(self, other: Self) -> Self:
        return self + -other

    @_with_numbers
    def __mul__(self, other: Self) -> Self:
        return type(self)(self.p * other.p, self.q * other.q)

    @_with_numbers
    def __truediv__(self, other: Self) -> Self:
        """The quotient; what both denominators share came with the writing, and is no common factor of the whole."""
        if self.is_infinite or other.is_infinite:
            return self * other.inverse()
        shared = self.q.gcd(other.q)
        return type(self)(self.p * (other.q // shared), self.q // shared * other.p)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Number) -> Self:
        return -self + other

    def __rtruediv__(self, other: Number) -> Self:
        return self.inverse() * other

    def __neg__(self) -> Self:
        return type(self)(-self.p, self.q)

    def __pow__(self, exponent: int) -> Self:
        base, size = self if exponent >= 0 else self.inverse(), abs(exponent)
        return type(self)(*(powered(f, size, f.degree(), f.height_bits()) for f in (base.p, base.q)))

    def inverse(self) -> Self:
        """The admittance of an impedance; open and short circuit change places."""
        return type(self)(self.q, self.p)

    def parallel(self, other: Self) -> Self:
        """Impedance of this beside the other, 1/(1/self + 1/other), open and short circuits included.

        Examples
        --------
        >>> from passivity import RationalFunction
        >>> s = RationalFunction.from_expression("s")
        >>> print((2 * s).parallel(1 / (3 * s)))
        (2*s)/(6*s^2 + 1)
        """
        return (self.inverse() + other.inverse()).inverse()

    def reduced(self) -> Self:
        """The same function without factors common to p and q."""
        common = self.p.gcd(self.q)
        return type(self)(self.p // common, self.q // common)

    def __eq__(self, other: object) -> bool:
        return self.p * other.q == other.p * self.q if isinstance(other, Quotient) else NotImplemented

    def __hash__(self) -> int:
        reduced = self.reduced()
        return hash(tuple(tuple(map(int, side.coeffs())) for side in (reduced.p, reduced.q)))


def _fractions(polynomial: fmpz_poly) -> tuple[Fraction, ...]:
    return tuple(Fraction(int(c)) for c in reversed(polynomial.coeffs())) or (Fraction(0),)
