"""Exact rational functions of the Laplace variable: pairs of integer polynomials, their arithmetic and values."""

import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from typing import TYPE_CHECKING, Self, TypeAlias

from flint import acb, ctx, fmpq, fmpq_poly, fmpz_poly

from passivity.budget import powered
from passivity.errors import ExpressionError, shown
from passivity.expression.number import fraction

if TYPE_CHECKING:
    from passivity.rational.evaluate import Exact

Number: TypeAlias = int | float | Fraction


def _with_numbers(
    operation: "Callable[[RationalFunction, RationalFunction], RationalFunction]",
) -> "Callable[[RationalFunction, RationalFunction | Number], RationalFunction]":
    """Accept a number as the second operand, as a constant function."""

    def either(self: "RationalFunction", other: "RationalFunction | Number") -> "RationalFunction":
        if isinstance(other, Real):
            other = self.constant(fraction(other, "number"))
        if not isinstance(other, RationalFunction):
            return NotImplemented
        return operation(self, other)

    return either


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RationalFunction:
    """A rational function p(s)/q(s) with exact coefficients: the pair (p : q) of two integer polynomials.

    Open circuit (1 : 0) and short circuit (0 : 1) are ordinary values; there is one infinity, without a sign.
    Factors common to p and q stay until `reduced` is called: they are modes that the terminals do not show.
    ``+ - * /`` take another function or a number; ``**`` takes an integer; ``==`` compares as functions.

    Parameters
    ----------
    p, q : flint.fmpz_poly
        Numerator and denominator, not both zero. The pair is divided by its integer content, and its sign is
        chosen so that q (p if q is zero) has a positive leading coefficient.

    Raises
    ------
    ExpressionError
        If both are zero.

    Examples
    --------
    >>> z = RationalFunction.from_expression("R + s*L", {"R": "50 ohm", "L": "10 nH"})
    >>> print(z, z.parallel(z) == z / 2)
    (s + 5000000000)/(100000000) True
    >>> z.at_zero(), z.at_infinity()
    (Fraction(50, 1), inf)
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
    def from_coefficients(cls, numerator: "Iterable[Exact]", denominator: "Iterable[Exact]") -> Self:
        """Rational function with the given coefficients, highest power first.

        Parameters
        ----------
        numerator, denominator : iterable of int, float, Fraction, Decimal or str
            At least one each. A float counts as its exact binary value, text as the exact decimal written,
            with prefix and unit if any. Leading zeros are fine.

        Raises
        ------
        ExpressionError
            Naming the coefficient that is not a finite real number; or if both polynomials are zero.

        Examples
        --------
        >>> print(RationalFunction.from_coefficients([1, "0.5"], [2]))
        (2*s + 1)/(4)
        """
        p, q = _polynomial(numerator, "numerator"), _polynomial(denominator, "denominator")
        return cls(p.numer() * q.denom(), q.numer() * p.denom())

    @classmethod
    def from_expression(cls, text: str, parameters: "Mapping[str, Exact] | None" = None) -> Self:
        """Rational function written as an expression in ``s``.

        Parameters
        ----------
        text : str
            Syntax of `passivity.expression.parse.parse`, without exp and sqrt; degree at most MAX_DEGREE.
        parameters : mapping of str to number or text, optional
            A value for every name in the expression but ``s``, and for no other; as in `from_coefficients`.

        Raises
        ------
        ExpressionError
            A syntax error of `parse`; a missing or unused parameter; exp or sqrt; 0/0; more than MAX_DEGREE.

        Examples
        --------
        >>> print(RationalFunction.from_expression("1/(s*C)", {"C": "4 pF"}))
        (250000000000)/(s)
        """
        from passivity.rational.evaluate import evaluate

        value = evaluate(text, parameters or {})
        return cls(value.p, value.q)

    @classmethod
    def from_system(cls, system: object) -> Self:
        """Rational function of a scipy.signal.lti or python-control system.

        Parameters
        ----------
        system : object
            Continuous, one input, one output: transfer function, state space, or zeros, poles and gain.
            Transfer function and state space are taken exactly as the floats they hold (hidden modes of a
            state space stay as common factors); zeros and poles pass through their own rounding ``to_tf()``.

        Raises
        ------
        ExpressionError
            For a discrete system, more than one input or output, or any other object.

        Examples
        --------
        >>> from scipy.signal import lti
        >>> print(RationalFunction.from_system(lti([1, 0], [2, 1])))
        (s)/(2*s + 1)
        """
        from passivity.rational.state_space import StateSpace, from_system

        if (dt := getattr(system, "dt", None)) not in (None, 0):
            got = f"{type(system).__name__} with dt={dt}"
            raise ExpressionError("system", "discrete in time", "a continuous system", got)
        network = from_system(system)
        if network.size != 1:
            got = f"{network.size} of {type(system).__name__}"
            raise ExpressionError("system", "too many ports", "one input and one output", got)
        function = (network.transfer if isinstance(network, StateSpace) else network).rows[0][0]
        return cls(function.p, function.q)

    @staticmethod
    def constant(value: Fraction) -> "RationalFunction":
        """A number as a function."""
        return RationalFunction(fmpz_poly([value.numerator]), fmpz_poly([value.denominator]))

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
    def __add__(self, other: "RationalFunction") -> "RationalFunction":
        if self.is_infinite and other.is_infinite:
            return self  # two open circuits in series
        return RationalFunction(self.p * other.q + other.p * self.q, self.q * other.q)

    @_with_numbers
    def __sub__(self, other: "RationalFunction") -> "RationalFunction":
        return self + -other

    @_with_numbers
    def __mul__(self, other: "RationalFunction") -> "RationalFunction":
        return RationalFunction(self.p * other.p, self.q * other.q)

    @_with_numbers
    def __truediv__(self, other: "RationalFunction") -> "RationalFunction":
        """Divide; a factor of both denominators comes from the writing and is cancelled, others are kept."""
        if self.is_infinite or other.is_infinite:
            return self * other.inverse()
        shared = self.q.gcd(other.q)
        return RationalFunction(self.p * (other.q // shared), self.q // shared * other.p)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Number) -> "RationalFunction":
        return -self + other

    def __rtruediv__(self, other: Number) -> "RationalFunction":
        return self.inverse() * other

    def __neg__(self) -> "RationalFunction":
        return RationalFunction(-self.p, self.q)

    def __pow__(self, exponent: int) -> "RationalFunction":
        base, size = self if exponent >= 0 else self.inverse(), abs(exponent)
        return RationalFunction(*(powered(f, size, f.degree(), f.height_bits()) for f in (base.p, base.q)))

    def inverse(self) -> "RationalFunction":
        """The admittance of an impedance; open and short circuit change places."""
        return RationalFunction(self.q, self.p)

    def parallel(self, other: "RationalFunction") -> "RationalFunction":
        """Impedance of this beside the other, 1/(1/self + 1/other), open and short circuits included.

        Examples
        --------
        >>> s = RationalFunction.from_expression("s")
        >>> print((2 * s).parallel(1 / (3 * s)))
        (2*s)/(6*s^2 + 1)
        """
        return (self.inverse() + other.inverse()).inverse()

    def reduced(self) -> "RationalFunction":
        """Cancel the common factors of p and q."""
        common = self.p.gcd(self.q)
        return RationalFunction(self.p // common, self.q // common)

    def bilinear(self, sign: int = 1) -> "RationalFunction":
        """The function at (1 + x)/(1 - x) in place of s, or at its reciprocal: outside the unit disc for Re x > 0.

        Examples
        --------
        >>> print(RationalFunction.from_expression("s^2").bilinear())
        (s^2 + 2*s + 1)/(s^2 - 2*s + 1)
        """
        n, turned = self.degree, fmpz_poly([-1, 2])  # (1 + x)/(1 - x) = 2/(1 - x) - 1
        both = ((n - f.degree()) * [0] + f(turned).coeffs()[::-1] for f in (self.p, self.q))
        return RationalFunction(*(fmpz_poly(c)(fmpz_poly([1, -sign])) for c in both))

    def __eq__(self, other: object) -> bool:
        return self.p * other.q == other.p * self.q if isinstance(other, RationalFunction) else NotImplemented

    def __hash__(self) -> int:
        reduced = self.reduced()
        return hash(tuple(tuple(map(int, side.coeffs())) for side in (reduced.p, reduced.q)))

    def __call__(self, s: complex) -> complex:
        """Value at a finite `s`, each part within 2e-16 of its size: ball arithmetic, refined until it is.

        At a root common to p and q the reduced function is evaluated. At a pole, and for an open circuit, the
        value is ``complex(inf, 0)``. The sign of the real part can be trusted, however small it is.

        Examples
        --------
        >>> RationalFunction.from_expression("1/(1 + s)")(1j)
        (0.5-0.5j)
        """
        s = complex(s)
        if not (math.isfinite(s.real) and math.isfinite(s.imag)):
            raise ExpressionError("s", "no value here", "a finite complex number", f"{s}")
        point, bits = acb(s.real, s.imag), 64
        while True:
            # the precision is global to the process: the accuracy found counts, not the one asked for
            with ctx.workprec(bits):
                p, q = self.p(point), self.q(point)
                if q == 0 and (p == 0 or p != 0):  # certain: a ball may hold 0 without being 0
                    return self.reduced()(s) if p == 0 else complex(math.inf, 0)
                over, size = p * q.conjugate(), q.real * q.real + q.imag * q.imag
                parts = over.real / size, over.imag / size
                if all(part.rel_accuracy_bits() >= 54 for part in parts):
                    return complex(*map(float, parts))
            bits *= 2

    def at_zero(self) -> Fraction | float:
        """Value at s = 0, the resistance to steady flow: a Fraction, or ``math.inf`` (without a sign)."""
        return self._limit(range(self.degree + 1))

    def at_infinity(self) -> Fraction | float:
        """Limit for s to infinity, which acts on a front: a Fraction, or ``math.inf`` (without a sign)."""
        return self._limit(range(self.degree, -1, -1))

    def _limit(self, powers: Iterable[int]) -> Fraction | float:
        power = next(i for i in powers if self.p[i] or self.q[i])
        return Fraction(int(self.p[power]), int(self.q[power])) if self.q[power] else math.inf

    def to_floats(self) -> tuple[list[float], list[float]]:
        """Numerator and denominator as floats, highest power first, scaled to a largest magnitude of 1.

        Refused if a coefficient is below the smallest normal float on that scale.

        Examples
        --------
        >>> RationalFunction.from_expression("5 + 1e-9*s").to_floats()
        ([2e-10, 1.0], [0.2])
        """
        sizes = [abs(c) for c in self.numerator + self.denominator if c]
        if float(min(sizes) / max(sizes)) < sys.float_info.min:
            expected = "at most 307 decades; measure time in another unit"
            raise ExpressionError("coefficients", "too far apart for floats", expected)
        p, q = ([float(c / max(sizes)) for c in side] for side in (self.numerator, self.denominator))
        return p, q

    def __reduce__(self):
        return self.from_coefficients, (self.numerator, self.denominator)

    def __str__(self) -> str:
        text = re.sub(r"\((-\d+)\)", r"\1", f"({self.p})/({self.q})")  # flint writes negative numbers as (-1)
        return text.replace("+ -", "- ").replace("x", "s")

    def __repr__(self) -> str:
        return f"RationalFunction.from_expression({str(self)!r})"


def _fractions(polynomial: fmpz_poly) -> tuple[Fraction, ...]:
    return tuple(Fraction(int(c)) for c in reversed(polynomial.coeffs())) or (Fraction(0),)


def _polynomial(given: "Iterable[Exact]", name: str) -> fmpq_poly:
    from passivity.rational.evaluate import exact

    if isinstance(given, str) or not isinstance(given, Iterable):
        expected = "a sequence of numbers, highest power first"
        raise ExpressionError(name, "not coefficients", expected, shown(given, repr))
    values = [exact(value, f"{name}[{i}]") for i, value in enumerate(given)]
    if not values:
        raise ExpressionError(name, "no coefficients", "at least one number")
    return fmpq_poly([fmpq(x.numerator, x.denominator) for x in reversed(values)])
