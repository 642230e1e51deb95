"""Where on the imaginary axis a Hermitian matrix has a negative eigenvalue."""

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from flint import fmpq, fmpz_poly

from passivity.budget import ASIDE, if_affordable
from passivity.one_port.polynomial_sign import squarefree
from passivity.one_port.real_roots import positive_roots

MOST_NAMED = 4  # bands in one sentence


def violations(sums: Sequence[fmpz_poly]) -> list[tuple[float, float]]:
    """Intervals of w = sqrt(x) where at least one of some polynomials in x is negative, to double precision.

    Examples
    --------
    >>> violations([fmpz_poly([1, 1]), fmpz_poly([3, -4, 1])])  # (x - 1)(x - 3)
    [(1.0, 1.7320508075688772)]
    """
    given = [a for a in sums if a]
    odd = [f for a in given for f, power in squarefree(a) if power % 2 and f[0]]
    edges = {root.frequency for f in odd for root in positive_roots(f)} - {0.0, math.inf}
    found: list[tuple[float, float]] = []
    for low, high in pairwise([0.0, *sorted(edges), math.inf]):
        middle = 2 * Fraction(low) + 1 if high == math.inf else (Fraction(low) + Fraction(high)) / 2
        x = fmpq(middle.numerator, middle.denominator) ** 2
        if any(a(x) < 0 for a in given):
            found.append((found.pop()[0] if found and found[-1][1] == low else low, high))
    return found


def bands(sums: Sequence[fmpz_poly]) -> str:
    """The same in words.

    Examples
    --------
    >>> bands([fmpz_poly([3, -4, 1])])
    'for 1 < ω < 1.73205'
    """
    return if_affordable(ASIDE, lambda: in_words(violations(sums))) or "in bands that take too long to find"


def in_words(intervals: Sequence[tuple[float, float]]) -> str:
    """Intervals of w, the first MOST_NAMED of them."""
    found = [_band(low, high) for low, high in intervals]
    more = len(found) - MOST_NAMED
    return ", ".join(found[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "") or "in a very narrow band"


def _band(low: float, high: float) -> str:
    if f"{low:.6g}" == f"{high:.6g}":
        return f"in a narrow band at ω = {low:.12g}"
    if low == 0:
        return "for all ω" if high == math.inf else f"for ω < {high:.6g}"
    return f"for ω > {low:.6g}" if high == math.inf else f"for {low:.6g} < ω < {high:.6g}"
