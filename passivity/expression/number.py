"""The exact value of a finite real number, and the way back: to a double, to text."""

import math
import sys
from decimal import Context, Decimal
from fractions import Fraction
from typing import Any

from flint import fmpq

from passivity.budget import bits_of, check_size
from passivity.errors import ExpressionError, shown

_LONGEST = 40  # characters of a complex number that is written exactly


def fraction(number: Any, where: str) -> Fraction:
    """Exact value of an int, a float, a Fraction or one of numpy's; `where` names it in the error."""
    try:
        found = Fraction(getattr(number, "item", lambda: number)())  # the number in a numpy scalar
    except (TypeError, ValueError, OverflowError):
        raise not_a_number(number, where) from None
    check_size(0, bits_of(found), where)
    return found


def not_a_number(value: object, where: str) -> ExpressionError:
    """Make the error for a value that is not a number."""
    expected = "a finite int, float or Fraction, or text such as '0.1' or '10 nH'"
    return ExpressionError(where, "not a number", expected, shown(value, repr))


def double(x: Fraction | float) -> float:
    """The nearest double; infinite beyond the largest."""
    try:
        return float(x)
    except OverflowError:
        return math.inf if x > 0 else -math.inf


def square_root(x: Fraction) -> Fraction | None:
    """The square root of a fraction, if it is one itself.

    Examples
    --------
    >>> square_root(Fraction(4, 9)), square_root(Fraction(2)), square_root(Fraction(-1))
    (Fraction(2, 3), None, None)
    """
    root = Fraction(math.isqrt(x.numerator), math.isqrt(x.denominator)) if x >= 0 else x
    return root if root * root == x else None


def written(x: Fraction | float) -> str:
    """A number in full, of any length; Python refuses to write more than 4300 digits.

    Examples
    --------
    >>> written(Fraction(-1, 3)), len(written(Fraction(10**5000))), written(math.inf)
    ('-1/3', 5001, 'inf')
    """
    return str(x) if isinstance(x, float) else str(fmpq(x.numerator, x.denominator))


def digits(x: Fraction | float, count: int = 6) -> str:
    """A number rounded to some digits, also beyond the range of doubles.

    Examples
    --------
    >>> digits(Fraction(1, 3)), digits(-Fraction(2, 10**400)), digits(math.inf)
    ('0.333333', '-2e-400', 'inf')
    """
    near = double(x)
    if isinstance(x, float) or not x or sys.float_info.min <= abs(near) < math.inf:
        return f"{near:.{count}g}"
    return f"{Context(prec=count).divide(Decimal(x.numerator), Decimal(x.denominator)).normalize():g}"


def beside_one(x: Fraction | float) -> str:
    """Six digits, and more where they would hide on which side of 1 a number lies."""
    text = digits(x)
    return f"1 {'-' if x < 1 else '+'} {digits(abs(Fraction(x) - 1), 3)}" if text == "1" and x != 1 else text


def complex_text(re: Fraction, im: Fraction) -> str:
    """An exact complex number if it is short, else a rounded one.

    Examples
    --------
    >>> complex_text(Fraction(1, 2), Fraction(-3))
    '1/2 - 3j'
    """
    sign = "-" if im < 0 else "+"
    exact = f"{written(re)} {sign} {written(abs(im))}j"
    if len(exact) <= _LONGEST:
        return exact
    return f"{digits(re, 12)} {sign} {digits(abs(im), 12)}j  (rounded; exactly: --json)"
