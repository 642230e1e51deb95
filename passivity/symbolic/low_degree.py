"""Exactly when (A s^2 + B s + C)/(D s^2 + E s + F) is positive real.

On the axis p conj q has the real part A D x^2 + M x + C F, x = w^2, M = B E - A F - C D. It is >= 0 for all x >= 0 if
and only if A D >= 0, C F >= 0 and (M >= 0 or 4 A D C F >= M^2). If all coefficients are >= 0, that is
sqrt(B E) >= |sqrt(A F) - sqrt(C D)|, and all.

In general the roots of p + q = a s^2 + b s + c must lie in Re s <= 0 too: no two of a, b, c have opposite signs (what
lies on the axis then cancels). A root in Re s > 0 does no harm if p and q have it in common. Then either p and q are
proportional, or it is the only one, and a c <= 0. With m1 = A E - B D, m2 = A F - C D, m3 = B F - C E a common root
satisfies m2^2 = m1 m3 and is -m2/m1 = -m3/m2. Terms that are missing are no exception: open circuit and short circuit,
constants and degree one are included.

References
----------
M. Z. Q. Chen, M. C. Smith, IEEE Transactions on Automatic Control 54 (2009), 390-393, for the test that is solved here.
"""

from math import isqrt, prod

from flint import fmpz_mpoly

from passivity.calculus.expand import Pair
from passivity.symbolic import write
from passivity.symbolic.domain import Domain, coefficients, factored, is_small
from passivity.symbolic.formula import Claim, Formula, Joined, claim, join, narrowed


def low_degree_condition(z: Pair, domain: Domain) -> Formula | bool:
    """When p/q, of degree two in s at most, is positive real: for all parameters of the domain but those with 0/0."""
    found = _condition(z, domain)
    parts = found.parts if isinstance(found, Joined) and found.word == "and" else (found,)
    limits = [part for part in parts if isinstance(part, Claim) and part.interval()]
    return join("and", [*limits, _condition(z, narrowed(domain, join("and", limits)))]) if limits else found


def _condition(z: Pair, domain: Domain) -> Formula | bool:
    (c, b, a), (f, e, d) = ((coefficients(g) + [0 * g] * 2)[:3] for g in z)
    m = b * e - a * f - c * d
    found: list[Formula | bool] = []
    for g in (a * d, c * f):
        found.append(claim(g, ">=", domain))
        domain = narrowed(domain, found[-1])
    found.append(_middle(m, 4 * a * d * c * f, domain))
    if found[-1] is False:
        return False
    return join("and", [*found, _roots((a, b, c), (d, e, f), narrowed(domain, found[-1]))])


def _middle(m: fmpz_mpoly, outer: fmpz_mpoly, domain: Domain) -> Formula | bool:
    """M >= 0 or 4 A D C F >= M^2; with a root r >= 0 of the left side that is M + r >= 0."""
    root = _root(outer)
    for r in () if root is None else (root, -root):
        if -1 not in domain.signs(r):
            return claim(m + r, ">=", domain)
    written = f"{write.polynomial(outer)} >= ({write.polynomial(m)})^2" if len(m) > 1 else ""
    return join("or", [claim(m, ">=", domain), claim(outer - m * m, ">=", domain, written)])


def _root(f: fmpz_mpoly) -> fmpz_mpoly | None:
    """The polynomial whose square is f, if there is one."""
    if not f:
        return f
    if not is_small(f):
        return None
    unit, factors = factored(f)
    if unit < 0 or isqrt(int(unit)) ** 2 != unit or any(power % 2 for _, power in factors):
        return None
    return prod((g ** (power // 2) for g, power in factors), start=f.context().constant(isqrt(int(unit))))


def _roots(p: tuple[fmpz_mpoly, ...], q: tuple[fmpz_mpoly, ...], domain: Domain) -> Formula | bool:
    """When p/q has no pole or p + q no root, in Re s > 0 that stays after cancelling; Re p conj q >= 0 on the axis."""
    (a, b, c), (d, e, f) = p, q
    if all(-1 not in domain.signs(g) for g in (a, c, d, f)) and {1} in (domain.signs(b), domain.signs(e)):
        return True  # b e >= (sqrt(a f) - sqrt(c d))^2, so b >= 0 and e >= 0
    sums = (a + d, b + e, c + f)
    one_sign = [claim(g * h, ">=", domain) for g, h in ((sums[0], sums[1]), (sums[1], sums[2]), (sums[0], sums[2]))]
    m1, m2, m3 = a * e - b * d, a * f - c * d, b * f - c * e
    proportional = join("and", [claim(m, "=", domain) for m in (m1, m2, m3)])
    common = [claim(m2 * m2 - m1 * m3, "=", domain), claim(-sums[0] * sums[2], ">=", domain)]
    right = join("or", [claim(-m1 * m2, ">", domain), claim(-m2 * m3, ">", domain)])
    return join("or", [join("and", one_sign), proportional, join("and", [*common, right])])
