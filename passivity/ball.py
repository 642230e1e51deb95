"""Between balls and exact numbers: the one place where a ball becomes a fraction, which FLINT would write out in full.

A ball may hold exp(exp(100)), whose digits fill no memory.
"""

from fractions import Fraction

from flint import acb, arb, fmpq

from passivity.budget import MAX_BITS

_FARTHEST, _NEAREST = Fraction(2) ** MAX_BITS, Fraction(1, 2**MAX_BITS)


def of_fraction(x: Fraction) -> arb:
    """The ball around a number, at the present precision."""
    return arb(fmpq(x.numerator, x.denominator))


def of_point(re: Fraction, im: Fraction) -> acb:
    """The ball around a point of the plane."""
    return acb(of_fraction(re), of_fraction(im))


def near(ball: arb) -> Fraction:
    """Midpoint of a ball, clipped to numbers of MAX_BITS; 0 if it is not finite or too small."""
    middle = ball.mid()
    if not middle.is_finite() or abs(middle) < of_fraction(_NEAREST):
        return Fraction(0)
    if abs(middle) > of_fraction(_FARTHEST):
        return _FARTHEST if middle > 0 else -_FARTHEST
    ratio = middle.fmpq()
    return Fraction(int(ratio.p), int(ratio.q))
