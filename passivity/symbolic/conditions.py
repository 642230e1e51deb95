"""The exact test with coefficients that are polynomials of the parameters: for all of these, or exactly for which.

Z = p/q is positive real if Re p(jw) conj q(jw) >= 0 and p + q has its roots in Re s < 0. Both are asked of all
parameters: A(w^2) is one more polynomial in x = w^2 >= 0, and for p + q all coefficients and every other Hurwitz
determinant must be positive (Lienard and Chipart). It is enough that these are nowhere negative and not identically
zero: then they are positive on a dense set of parameters, and Re p conj q >= 0 in Re s > 0 holds in the limit too.

Of (A s^2 + B s + C)/(D s^2 + E s + F) p conj q has the real part A D x^2 + M x + C F on the axis, M = B E - A F - C D.
It is >= 0 for all x >= 0 if and only if A D >= 0, C F >= 0 and (M >= 0 or 4 A D C F >= M^2). If all coefficients are
>= 0, that is sqrt(B E) >= |sqrt(A F) - sqrt(C D)|, and all. In general the roots of p + q = a s^2 + b s + c must lie in
Re s <= 0 too: no two of a, b, c have opposite signs (roots on the axis then cancel). A root in Re s > 0 does no
harm if p and q have it in common. Then either p and q are proportional, or it is the only one, and a c <= 0. With
m1 = A E - B D, m2 = A F - C D, m3 = B F - C E a common root satisfies m2^2 = m1 m3 and is -m2/m1 = -m3/m2. Terms that
are missing are no exception: open circuit and short circuit, constants and degree one are included.

References
----------
F. R. Gantmacher, "The Theory of Matrices", vol. 2, chapter XV.
M. Z. Q. Chen, M. C. Smith, IEEE Transactions on Automatic Control 54 (2009), 390-393.
"""

from math import isqrt, prod

from flint import fmpz_mpoly

from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.status import Kind
from passivity.symbolic.domain import Domain, Signs, coefficients, factored, is_small
from passivity.symbolic.formula import Claim, Formula, Joined, claim, join, narrowed, polynomial_text

MAX_DEGREE = 12


def as_impedance(kind: Kind, function: Pair) -> Pair:
    """The pair whose positive realness is asked for: p/q itself, or (1 + H)/(1 - H) of a reflection H = p/q."""
    p, q = function
    return function if kind is Kind.PR else Pair(q + p, q - p)


def positivity_condition(z: Pair, domain: Domain, expansion: Expansion) -> Formula | bool | None:
    """Return True if p/q is found positive real for all parameters, else the exact condition, or None if unknown.

    A condition is found where one factor decides, as with one resistor of any sign among coils and capacitors, or a
    gain: A(x) = c B(x), B >= 0 and not identically zero, c free of x. Where c < 0, A is negative somewhere.
    """
    a = allowance(z, expansion)
    decisive = True if -1 not in domain.signs(a) else _decisive_factor(a, domain)
    if decisive is False or decisive is None:
        return decisive
    inner = narrowed(domain, decisive)
    strictly = decisive is not True and inner is domain  # the claim need not hold on an open set
    return decisive if is_hurwitz(z.p + z.q, inner, expansion, strictly=strictly) else None


def _decisive_factor(a: fmpz_mpoly, domain: Domain) -> Formula | bool | None:
    if not is_small(a):
        return None
    unit, factors = factored(a)
    c, b = 0 * a + unit, 0 * a + 1
    for f, power in factors:
        if f.degrees()[0]:
            b *= f**power
        else:
            c *= f**power
    for sign in (1, -1):
        if -sign not in domain.signs(b) and any(domain.signs(g) == {sign} for g in coefficients(b)):
            return claim(sign * c, ">=", domain)
    return None


def allowance(z: Pair, expansion: Expansion) -> fmpz_mpoly:
    """A(x) = Re p(jw) conj q(jw), x = w^2, in place of s."""
    x, (a, b), (c, d) = z.p.context().gens()[0], _parts(z.p), _parts(z.q)
    return expansion.times(a, c) + x * expansion.times(b, d)


def _parts(f: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """u and v with f(jw) = u(x) + j w v(x)."""
    x, zero = f.context().gens()[0], 0 * f
    c = coefficients(f)
    even, odd = (sum(((-x) ** k * a for k, a in enumerate(c[start::2])), zero) for start in (0, 1))
    return even, odd


def is_hurwitz(f: fmpz_mpoly, domain: Domain, expansion: Expansion, *, strictly: bool = False) -> bool:
    """Return whether all roots of f in s are shown to lie in Re s < 0, on a dense set of parameters or strictly all."""
    c = coefficients(f)
    if len(c) > MAX_DEGREE + 1:
        raise ExpansionError(f"the degree in s is over {MAX_DEGREE}")
    seen = [domain.signs(a) for a in c]
    for sign in (1, -1):
        if all(_is(sign, s, strictly) for s in seen):
            chosen = [sign * a for a in c]
            return all(_is(1, domain.signs(d), strictly) for d in _determinants(chosen, expansion))
    return False


def _is(sign: int, signs: Signs, strictly: bool) -> bool:
    allowed = {sign} if strictly else {0, sign}
    return sign in signs and signs <= allowed


def _determinants(c: list[fmpz_mpoly], expansion: Expansion) -> list[fmpz_mpoly]:
    """Every other Hurwitz determinant, the last but one among them: by elimination without fractions (Bareiss)."""
    n = len(c) - 1
    zero = 0 * c[0]
    descending = c[::-1]
    rows = [[descending[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else zero for j in range(n)] for i in range(n)]
    minors, last = [], 1 + zero
    for k in range(n - 1):
        pivot = rows[k][k]
        minors.append(pivot)
        if not pivot:
            return [pivot]
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                cross = expansion.times(rows[i][j], pivot) - expansion.times(rows[i][k], rows[k][j])
                rows[i][j] = cross / last
        last = pivot
    return minors[n - 2 :: -2] if n > 1 else []


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
    written = f"{polynomial_text(outer)} >= ({polynomial_text(m)})^2" if len(m) > 1 else ""
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
