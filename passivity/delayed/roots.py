"""Zeros of 1 + H1 and 1 - H1 in the right half plane, H1 = exp(-2Ts) H2: what a line with its ends does when driven.

1 + H1 = 0 are the modes of a line whose input effort is held, 1 - H1 = 0 of one whose input flow is.
"""

import math
from fractions import Fraction

from flint import arb, arb_poly, ctx, fmpz_poly

from passivity.delayed.quasi import BITS, QuasiPolynomial, zeros_right
from passivity.errors import ExpressionError, shown
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction


def roots_right(h2: RationalFunction, delay: Exact, sign: int) -> int | float:
    """Number of zeros of 1 + sign exp(-2Ts) H2(s) in Re s > 0, certified.

    Parameters
    ----------
    h2 : RationalFunction
        Reflection at the far end; the open circuit 1/0 of the pair is refused.
    delay : int, float, Fraction, Decimal or str
        T, time from end to end, at least zero.
    sign : int
        1: effort held at the input; -1: flow held.

    Returns
    -------
    int or float
        With multiplicities; ``math.inf`` where |H2| > 1 at high frequencies and T > 0.

    Raises
    ------
    UndecidedError
        If zeros lie on the axis, or so near that balls do not tell; always so where |H2| = 1 at high frequencies.
    ExpressionError
        For another delay or sign, or if the function is zero everywhere.

    Examples
    --------
    >>> h2 = RationalFunction.from_expression("2/(1 + s)")
    >>> roots_right(h2, "1/20", 1), roots_right(h2, "1/20", -1), roots_right(h2, 1, 1)
    (0, 1, 2)
    """
    p, q, travel = _checked(h2, delay, sign)
    if travel and (p.degree() > q.degree() or (p.degree() == q.degree() and _lead(p) > _lead(q))):
        return math.inf
    with ctx.workprec(BITS):
        if not travel:
            return zeros_right(QuasiPolynomial(((arb(0), arb_poly(q + p)),)))
        if not p:
            return zeros_right(QuasiPolynomial(((arb(0), arb_poly(q)),)))
        twice = 2 * arb(travel.numerator) / travel.denominator
        return zeros_right(QuasiPolynomial(((arb(0), arb_poly(q)), (twice, arb_poly(p)))))


def _checked(h2: RationalFunction, delay: Exact, sign: int) -> tuple[fmpz_poly, fmpz_poly, Fraction]:
    """Numerator, with the sign, and denominator of H2 in lowest terms, and T."""
    travel = exact(delay, "delay")
    if travel < 0:
        raise ExpressionError("delay", "negative", "at least 0", shown(delay))
    if sign not in (1, -1):
        raise ExpressionError("sign", "neither sign", "1 or -1", shown(sign, repr))
    if h2.is_infinite:
        raise ExpressionError("h2", "infinite everywhere", "a reflection with a denominator")
    reduced = h2.reduced()
    p, q = sign * reduced.p, reduced.q
    if not travel and not p + q:
        raise ExpressionError("h2", "the function is zero everywhere", "1 + H1 or 1 - H1 that is not")
    return p, q, travel


def _lead(f: fmpz_poly) -> int:
    return abs(int(f.leading_coefficient()))
