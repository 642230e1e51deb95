"""How far a function is from the border between passive and active, and at which frequency."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from flint import fmpz_poly

from passivity.budget import ASIDE, budget
from passivity.errors import ExpressionError, shown
from passivity.expression.number import double
from passivity.one_port.axis import allowance, product
from passivity.one_port.infimum import Infimum, infimum
from passivity.one_port.verdict import Verdict
from passivity.rational.evaluate import Exact, exact
from passivity.status import Kind


class Margin(NamedTuple):
    """An extreme value on the imaginary axis.

    Parameters
    ----------
    low, high : Fraction or float
        The value lies between them; equal where it is known exactly; infinite where it is.
    frequency : float
        Angular frequency where it is attained, rad/s; ``math.inf`` for the limit.
    """

    low: Fraction | float
    high: Fraction | float
    frequency: float

    @property
    def value(self) -> float:
        """The number to print."""
        return double(self.middle)

    @property
    def middle(self) -> Fraction | float:
        """The middle of the enclosure."""
        return self.low if isinstance(self.low, float) else (self.low + self.high) / 2


class Margins(NamedTuple):
    """The margins of a function; None where the question makes no sense.

    Parameters
    ----------
    input : Margin or None
        Smallest Re Z(jw): a resistance that may be taken away in series; negative: that must be added.
    output : Margin or None
        Smallest Re 1/Z(jw): the same for a conductance in parallel.
    reflection : Margin or None
        Largest |H(jw)|, where H = (Z - z0)/(Z + z0), or the given reflection itself.
    """

    input: Margin | None
    output: Margin | None
    reflection: Margin | None


def margins(verdict: Verdict, z0: Exact = 1) -> Margins:
    """The margins of the function of a verdict, in whatever unit it is given.

    Parameters
    ----------
    verdict : Verdict
        Any; proved or not.
    z0 : int, float, Fraction, Decimal or str
        Reference impedance of the reflection, above zero; without effect where a reflection is given.

    Raises
    ------
    ExpressionError
        If z0 is not above zero.
    UndecidedError
        If the budget for finding a minimum runs out.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real
    >>> found = check_positive_real(RationalFunction.from_expression("3 + s/(s^2 + s + 1)")).margins
    >>> found.input, found.reflection.value, found.reflection.frequency
    (Margin(low=Fraction(3, 1), high=Fraction(3, 1), frequency=0.0), 0.6, 1.0)
    """
    with budget(ASIDE):
        return _margins(verdict, z0)


def _margins(verdict: Verdict, z0: Exact) -> Margins:
    p, q, reference = verdict.function.p, verdict.function.q, exact(z0, "z0")
    if reference <= 0:
        raise ExpressionError("z0", "not positive", "more than 0", shown(z0))
    if verdict.kind is Kind.BR:
        return Margins(None, None, _reflection(p, q))
    a = allowance(Kind.PR, p, q)
    one, unit = p * reference.denominator, q * reference.numerator
    return Margins(_smallest(a, product(q, q)), _smallest(a, product(p, p)), _reflection(one - unit, one + unit))


def _smallest(num: fmpz_poly, den: fmpz_poly) -> Margin | None:
    return _margin(infimum(num, den)) if den else None


def _margin(found: Infimum) -> Margin:
    return Margin(*found)


def _reflection(p: fmpz_poly, q: fmpz_poly) -> Margin | None:
    if not q:
        return None
    low, high, frequency = infimum(-product(p, p), product(q, q), guess=-1)
    if low == -math.inf:
        return Margin(math.inf, math.inf, frequency)
    return Margin(_root(-high, math.floor), _root(-low, math.ceil), frequency)


def _root(x: Fraction | float, rounding: Callable[[Fraction], int]) -> Fraction:
    """Square root; exact for squares, else so near that its distance to 1 has 60 bits."""
    exact = Fraction(x)
    up, down = math.isqrt(exact.numerator), math.isqrt(exact.denominator)
    if up * up == exact.numerator and down * down == exact.denominator:
        return Fraction(up, down)
    near = abs(exact - 1)
    bits = 60 + max(near.denominator.bit_length() - near.numerator.bit_length(), 0)
    shift = bits - (exact.numerator.bit_length() - exact.denominator.bit_length()) // 2
    scaled = exact * Fraction(4) ** shift
    root = math.isqrt(math.floor(scaled)) + (rounding is math.ceil)
    return root / Fraction(2) ** shift
