"""The parameters without a value, where they may lie, and which signs a polynomial in them can have there.

Each parameter is written in variables u >= 0: x = a + u above a, x = b - u below b, x = (a + bu)/(1 + u) between a and
b, and x = u and x = -u if nothing is known. A polynomial without negative coefficients in u is nonnegative; with one
variable the question is decided exactly (`find_sign`).
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import TypeAlias

from flint import Ordering, fmpz, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from passivity.budget import spend
from passivity.polynomial.sign import SignProof, UndecidedError, find_sign
from passivity.symbolic.assumption import Range

_MAX_FACTORED = 250  # terms of a polynomial that is factored, or written in other variables
_MAX_FACTORED_BITS = 4_000
_MAX_DEGREES = 50  # of such a polynomial in all its variables together
_MAX_SUBSTITUTED = 5_000  # terms of a polynomial, times the parameters to be written in another way
_MAX_SPLIT = 4  # parameters of which nothing is known, in one polynomial
ALL = frozenset({-1, 0, 1})

Signs: TypeAlias = frozenset[int]  # -1, 0, 1: all that can occur, perhaps more


@dataclass(frozen=True)
class Domain:
    """The ranges of the free parameters.

    The polynomials have the generators s, which in a polynomial of x = w^2 denotes x >= 0; others such as
    e = exp(-tau s), one by default; and the parameters.
    """

    ranges: tuple[Range, ...]
    others: int = 1

    @cached_property
    def context(self) -> fmpz_mpoly_ctx:
        """The ring of all polynomials."""
        return fmpz_mpoly_ctx.get(
            ("s", *(f"exp({k})" for k in range(self.others)), *(r.name for r in self.ranges)), Ordering.lex
        )

    @cached_property
    def intervals(self) -> tuple[Range, ...]:
        """The range of each generator."""
        return (*[Range("x", Fraction(0))] * (1 + self.others), *self.ranges)

    def narrowed(self, to: Range) -> "Domain | None":
        """The domain with less room for one parameter; None if there is no interval left."""
        ranges = tuple(r.meet(to) if r.name == to.name else r for r in self.ranges)
        kept = tuple(r for r in ranges if r is not None and not r.is_point)
        return Domain(kept, self.others) if len(kept) == len(ranges) else None

    def signs(self, f: fmpz_mpoly) -> Signs:
        """A set that holds the sign of f at every point of the domain."""
        if not f:
            return frozenset({0})
        if found := self._by_coefficients(f):
            return found
        if not is_small(f):
            return ALL
        unit, factors = factored(f)
        found = frozenset({1 if unit > 0 else -1})
        for factor, power in factors:
            signs = self._of_irreducible(factor)
            found = times(found, frozenset(x**power for x in signs))
        return found

    def _by_coefficients(self, f: fmpz_mpoly) -> Signs | None:
        """The signs if all generators in f are nonnegative, and all coefficients of one sign."""
        terms = list(f.terms())
        if len({c > 0 for _, c in terms}) == 2:
            return None
        if any(d and not (r.low is not None and r.low >= 0) for d, r in zip(f.degrees(), self.intervals, strict=True)):
            return None
        sign = 1 if terms[0][1] > 0 else -1
        positive = [r.low is not None and (r.low > 0 or r.open_low) for r in self.intervals]
        strict = any(all(sure or not e for e, sure in zip(m, positive, strict=True)) for m, _ in terms)
        return frozenset({sign} if strict else {0, sign})

    def _of_irreducible(self, f: fmpz_mpoly) -> Signs:
        for sign in (1, -1):
            cases = self._in_u(f * sign)
            if cases and all(_is_nonnegative(case) for case, _ in cases):
                strict = all(map(_is_positive, cases)) and self._is_positive_at_the_tops(f * sign)
                return frozenset({sign} if strict else {0, sign})
        return ALL

    def _in_u(self, f: fmpz_mpoly) -> list[tuple[fmpz_mpoly, list[bool]]]:
        """f in the variables u, up to positive factors, with the u that are not 0; a list of cases."""
        used = [d > 0 for d in f.degrees()]
        choices = [_substitutions(r) if d else [None] for r, d in zip(self.intervals, used, strict=True)]
        others = sum(c != [None] for c in choices)
        if sum(len(c) == 2 for c in choices) > _MAX_SPLIT or others * len(f) > _MAX_SUBSTITUTED:
            return []
        gens, degrees = self.context.gens(), f.degrees()
        cases = []
        for choice in product(*choices):
            found = f
            for gen, u, degree, how in zip(range(len(gens)), gens, degrees, choice, strict=True):
                if how:
                    found = _substituted(found, gen, degree, how[0] + how[1] * u, how[2] + how[3] * u)
            cases.append((found, [r.open_low or (r.low is None and r.open_high) for r in self.intervals]))
        return cases

    def _is_positive_at_the_tops(self, f: fmpz_mpoly) -> bool:
        """Whether f > 0 where a parameter between two ends is at its upper one, u being infinite."""
        for gen, (r, d) in enumerate(zip(self.intervals, f.degrees(), strict=True)):
            if d and r.low is not None and r.high is not None and not r.open_high:
                top, one = (self.context.constant(n) for n in (r.high.numerator, r.high.denominator))
                if self.signs(_substituted(f, gen, d, top, one)) != {1}:
                    return False
        return True


def is_small(f: fmpz_mpoly) -> bool:
    """Whether a polynomial can be factored in a fraction of a second."""
    small = len(f) <= _MAX_FACTORED and sum(f.degrees()) <= _MAX_DEGREES
    return small and max((abs(c).bit_length() for c in f.coeffs()), default=0) <= _MAX_FACTORED_BITS


def factored(f: fmpz_mpoly) -> tuple[fmpz, list[tuple[fmpz_mpoly, int]]]:
    """Unit and irreducible factors of a small polynomial; itself where the library has no order for long factors."""
    spend(1_000 * len(f) ** 2 * (1 + sum(f.degrees())), "factors of a polynomial of the parameters")
    try:
        unit, found = f.factor()
    except OverflowError:
        return fmpz(1), [(f, 1)]
    return unit, [(factor, int(power)) for factor, power in found]


def times(a: Signs, b: Signs) -> Signs:
    """All signs of products."""
    return frozenset(x * y for x in a for y in b)


def _substitutions(r: Range) -> list[tuple[int, int, int, int] | None]:
    """The ways to write a parameter as (a + b u)/(c + d u), u >= 0, up to the unit of u; None for u itself."""
    low, high = r.low, r.high
    if low == 0 and high is None:
        return [None]
    if low is None and high is None:
        return [(0, 1, 1, 0), (0, -1, 1, 0)]
    if low is None:
        assert high is not None
        return [(high.numerator, -1, high.denominator, 0)]
    if high is None:
        return [(low.numerator, 1, low.denominator, 0)]
    over = low.denominator * high.denominator
    return [(low.numerator * high.denominator, high.numerator * low.denominator, over, over)]


def _substituted(f: fmpz_mpoly, gen: int, degree: int, above: fmpz_mpoly, below: fmpz_mpoly) -> fmpz_mpoly:
    """f with above/below for one generator, times below to the power `degree`."""
    parts = coefficients(f, gen)
    return sum((c * above**k * below ** (degree - k) for k, c in enumerate(parts)), 0 * f)


def coefficients(f: fmpz_mpoly, gen: int = 0) -> list[fmpz_mpoly]:
    """The coefficients of the powers of one generator, lowest first; at least one."""
    context = f.context()
    parts: list[dict] = [{} for _ in range(int(f.degrees()[gen]) + 1 if f else 1)]
    for monomial, c in f.terms():
        parts[int(monomial[gen])][(*monomial[:gen], 0, *monomial[gen + 1 :])] = c
    return [context.from_dict(part) for part in parts]


def _is_nonnegative(f: fmpz_mpoly) -> bool:
    if all(c >= 0 for c in f.coeffs()):
        return True
    gens = [gen for gen, d in enumerate(f.degrees()) if d]
    if len(gens) != 1:
        return False
    try:
        return isinstance(
            find_sign(fmpz_poly([c.leading_coefficient() if c else 0 for c in coefficients(f, gens[0])])), SignProof
        )
    except UndecidedError:
        return False


def _is_positive(case: tuple[fmpz_mpoly, list[bool]]) -> bool:
    """Whether a nonnegative polynomial is not 0: a term without the u that may be 0 is positive.

    In one variable that suffices too, for an irreducible polynomial has no double roots.
    """
    f, nonzero = case
    return any(c > 0 and all(sure or not e for e, sure in zip(m, nonzero, strict=True)) for m, c in f.terms())
