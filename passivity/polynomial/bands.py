"""Where on the imaginary axis polynomials in x = w^2 are negative, in numbers and in words."""

import math
from collections.abc import Sequence
from itertools import pairwise

from flint import fmpz_poly

from passivity.polynomial.roots import positive_roots
from passivity.polynomial.sign import squarefree

MOST_NAMED = 4  # bands or frequencies in one sentence


def violations(sums: Sequence[fmpz_poly]) -> list[tuple[float, float]]:
    """Intervals of w = sqrt(x) where at least one of some polynomials in x is negative, to double precision.

    Examples
    --------
    >>> violations([fmpz_poly([1, 1]), fmpz_poly([3, -4, 1])])  # (x - 1)(x - 3)
    [(1.0, 1.7320508075688772)]
    """
    found: list[tuple[float, float]] = []
    for low, high in sorted(band for a in sums if a for band in _negative(a)):
        joined = found and low <= found[-1][1]
        if joined:
            low, before = found.pop()
            high = max(before, high)
        found.append((low, high))
    return found


def _negative(a: fmpz_poly) -> list[tuple[float, float]]:
    """The intervals of one polynomial: counted down from infinity, its sign changes at each root of odd order."""
    roots = [root for f, power in squarefree(a) if power % 2 and f[0] for root in positive_roots(f)]
    ends = [0.0, *sorted(root.frequency for root in roots), math.inf]
    negative = a.leading_coefficient() < 0
    return [band for k, band in enumerate(reversed(list(pairwise(ends)))) if (k % 2 == 0) == negative]


def in_words(intervals: Sequence[tuple[float, float]]) -> str:
    """Intervals of w, the first MOST_NAMED of them."""
    return listed([_band(low, high) for low, high in intervals])


def listed(items: Sequence[str]) -> str:
    """The first MOST_NAMED of some items, and how many more there are."""
    more = len(items) - MOST_NAMED
    return ", ".join(items[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _band(low: float, high: float) -> str:
    if f"{low:.6g}" == f"{high:.6g}":
        return f"in a narrow band at ω = {low:.12g}"
    if low == 0:
        return "for all ω" if high == math.inf else f"for ω < {high:.6g}"
    return f"for ω > {low:.6g}" if high == math.inf else f"for {low:.6g} < ω < {high:.6g}"
