"""The exact value of a finite real number."""

from fractions import Fraction
from typing import Any

from passivity.errors import ExpressionError


def fraction(number: Any, where: str) -> Fraction:
    """Exact value of an int, a float, a Fraction or one of numpy's; `where` names it in the error.

    Examples
    --------
    >>> fraction(0.5, "R")
    Fraction(1, 2)
    """
    try:
        return Fraction(getattr(number, "item", lambda: number)())  # the number in a numpy scalar
    except (TypeError, ValueError, OverflowError):
        raise not_a_number(number, where) from None


def not_a_number(value: object, where: str) -> ExpressionError:
    """The error for a value that is none."""
    expected = "a finite int, float or Fraction, or text such as '0.1' or '10 nH'"
    return ExpressionError(where, "not a number", expected, repr(value)[:60])
