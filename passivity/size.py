"""How large numbers and polynomials may grow, and the only powers: asked before FLINT is, which ends the process."""

from fractions import Fraction
from typing import Any

from passivity.errors import ExpressionError

MAX_DEGREE = 400
MAX_BITS = 100_000  # of a number or a coefficient
MAX_TOTAL = 4_000_000  # bits of all coefficients together


def check_size(degree: int, bits: int, where: str = "") -> None:
    """Refuse what has too high a degree in s, or too long numbers.

    Examples
    --------
    >>> check_size(401, 1)
    Traceback (most recent call last):
    ...
    passivity.errors.ExpressionError: the degree in s is too high, expected at most 400, got 401
    """
    if degree > MAX_DEGREE:
        raise ExpressionError(where, "the degree in s is too high", f"at most {MAX_DEGREE}", f"{_count(degree)}")
    if bits > MAX_BITS:
        raise ExpressionError(where, "the numbers are too long", f"at most {MAX_BITS} bits", f"{_count(bits)}")
    if (degree + 1) * bits > MAX_TOTAL:
        problem = f"degree {degree} is too high for numbers of {bits} bits"
        raise ExpressionError(where, problem, f"at most {MAX_TOTAL} bits in all")


def _count(number: int) -> str:
    return f"{number}" if number.bit_length() < 64 else f"over 2^{number.bit_length() - 1}"


def bits_of(x: Fraction | int) -> int:
    """Length of the longer of numerator and denominator."""
    return max(x.numerator.bit_length(), x.denominator.bit_length())


def powered(base: Any, exponent: int, degree: int, bits: int) -> Any:
    """A number or polynomial of this degree, with numbers of this length, to a whole power, if that is not too large.

    Examples
    --------
    >>> powered(Fraction(2, 3), -2, 0, 2)
    Fraction(9, 4)
    """
    if bits > 1 or degree > 0:
        check_size(abs(exponent) * degree, abs(exponent) * bits)
    return base**exponent
