"""Between balls and exact numbers: the one place where a ball becomes a fraction, which FLINT would write out in full.

A ball may hold exp(exp(100)), whose digits fill no memory.
"""

import math
from fractions import Fraction
from typing import TypeAlias

from flint import acb, arb, fmpq

from passivity.budget import MAX_BITS

Real: TypeAlias = Fraction | float  # a float is an infinity

MAX_EXPONENT = 4096  # bounds made of balls lie between 2^-4096 and 2^4096, or are 0
_TOP, _BOTTOM = Fraction(2) ** MAX_EXPONENT, Fraction(1, 2**MAX_EXPONENT)
_FARTHEST, _NEAREST = Fraction(2) ** MAX_BITS, Fraction(1, 2**MAX_BITS)


def of_fraction(x: Real) -> arb:
    """The ball around a number, at the present precision; an infinity is one."""
    return arb(x) if isinstance(x, float) else arb(fmpq(x.numerator, x.denominator))


def of_point(re: Fraction, im: Fraction) -> acb:
    """The ball around a point of the plane."""
    return acb(of_fraction(re), of_fraction(im))


def ends(ball: arb) -> tuple[Real, Real]:
    """Numbers between which all of a ball lies; infinite, 0 or 2^-MAX_EXPONENT where its own ends are out of range.

    Examples
    --------
    >>> low, high = ends((-arb(10) ** 6).exp())
    >>> low, high == Fraction(1, 2**MAX_EXPONENT)
    (Fraction(0, 1), True)
    >>> ends((arb(10) ** 30).exp())[1]
    inf
    """
    if not ball.is_finite():
        return -math.inf, math.inf
    return -_not_below(-ball.lower()), _not_below(ball.upper())


def _not_below(x: arb) -> Real:
    """A number of reasonable size that is at least x, a ball without radius."""
    if x > of_fraction(_TOP):
        return math.inf
    if x < of_fraction(-_TOP):
        return -_TOP
    if abs(x) < of_fraction(_BOTTOM):
        return _BOTTOM if x > 0 else Fraction(0)
    return _exact(x)


def near(ball: arb) -> Fraction:
    """The middle of a ball, or what of a length of MAX_BITS is nearest to it; 0 where there is none."""
    middle = ball.mid()
    if not middle.is_finite() or abs(middle) < of_fraction(_NEAREST):
        return Fraction(0)
    if abs(middle) > of_fraction(_FARTHEST):
        return _FARTHEST if middle > 0 else -_FARTHEST
    return _exact(middle)


def _exact(x: arb) -> Fraction:
    ratio = x.fmpq()
    return Fraction(int(ratio.p), int(ratio.q))
