"""Conditions on parameters: polynomials that must be >= 0, > 0 or = 0, joined by "and" and "or".

They are simplified under the assumptions: factors of known sign are dropped, claims that always or never hold vanish.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import prod
from operator import eq, ge, gt
from typing import TypeAlias

from flint import fmpz_mpoly

from passivity.calculus.expand import Pair
from passivity.errors import ExpressionError, shorten, shown
from passivity.rational.evaluate import Exact, exact
from passivity.symbolic.assumption import Range
from passivity.symbolic.domain import Domain, coefficients, factored, is_small

_RELATIONS: dict[str, Callable[[Fraction | int, int], bool]] = {">=": ge, ">": gt, "=": eq}


@dataclass(frozen=True, eq=False)
class Claim:
    """A product of powers of polynomials, compared with 0."""

    factors: tuple[tuple[fmpz_mpoly, int], ...]
    relation: str  # >=, > or =
    written: str = ""  # how to write it, if not as the factors tell

    def holds(self, values: Mapping[str, Fraction]) -> bool:
        """Return whether the claim holds at these parameters."""
        product = prod((value(f, values) ** power for f, power in self.factors), start=Fraction(1))
        return _RELATIONS[self.relation](product, 0)

    def boundary(self) -> "Claim":
        """The claim that the product is 0."""
        return Claim(tuple((f, 1) for f, _ in self.factors), "=")

    def __str__(self) -> str:
        if self.written:
            return self.written
        if interval := self.interval():
            return str(interval)
        if len(self.factors) == 1 and self.factors[0][1] == 1:
            return _sides(self.factors[0][0], self.relation)
        return f"{'*'.join(factor_text(f, k) for f, k in self.factors)} {self.relation} 0"

    def interval(self) -> Range | None:
        """Return the claim as a range of one parameter, if it is one."""
        generators = {gen for f, _ in self.factors for gen, d in enumerate(f.degrees()) if d}
        linear = all(f.total_degree() == 1 and power == 1 for f, power in self.factors)
        if len(generators) != 1 or not linear or self.relation == "=":
            return None
        name = self.factors[0][0].context().names()[generators.pop()]
        roots = sorted(-value(f, {name: Fraction(0)}) / int(f.leading_coefficient()) for f, _ in self.factors)
        ends = [None, *roots, None]
        pieces = [pair for pair in pairwise(ends) if self.holds({name: _between(*pair)})]
        if len(pieces) != 1:
            return None
        strict = self.relation == ">"
        return Range(name, *pieces[0], strict, strict)


@dataclass(frozen=True, eq=False)
class Joined:
    """Formulas joined by ``and`` (all must hold) or ``or`` (one must)."""

    word: str
    parts: "tuple[Formula, ...]"

    def holds(self, values: Mapping[str, Fraction]) -> bool:
        """Return whether the formula holds at these parameters."""
        return (all if self.word == "and" else any)(part.holds(values) for part in self.parts)

    def __str__(self) -> str:
        return f" {self.word} ".join(f"({part})" if isinstance(part, Joined) else str(part) for part in self.parts)


Formula: TypeAlias = Claim | Joined


def claim(f: fmpz_mpoly, relation: str, domain: Domain, written: str = "") -> Formula | bool:
    """Simplify f >= 0, f > 0 or f = 0; `written` is the text of an f too large for that."""
    truths = {_RELATIONS[relation](sign, 0) for sign in domain.signs(f)}
    if len(truths) == 1:
        return truths.pop()
    if not is_small(f):
        return Claim(((f, 1),), relation, written)
    unit, found = factored(f)
    sign, kept = 1 if unit > 0 else -1, []
    for factor, power in found:
        known = domain.signs(factor)
        if known in ({1}, {-1}):
            sign *= 1 if 1 in known or power % 2 == 0 else -1
        else:
            kept.append((factor, 1 if relation == "=" else 2 - power % 2))
    if sign < 0 and relation != "=":
        odd = [k for k, (_, power) in enumerate(kept) if power == 1]
        if not odd:  # minus a square is >= 0
            return Claim(tuple(kept), ">=").boundary()
        turned = max(odd, key=lambda k: len(kept[k][0]))
        kept[turned] = (-kept[turned][0], 1)
    return Claim(tuple(kept), relation, written if len(found) == 1 else "")


def join(word: str, parts: Iterable[Formula | bool]) -> Formula | bool:
    """All (``and``) or one (``or``) of the parts, each named once."""
    decisive = word == "or"
    kept: dict[str, Formula] = {}
    for part in parts:
        if isinstance(part, bool):
            if part is decisive:
                return decisive
        else:
            inner = part.parts if isinstance(part, Joined) and part.word == word else (part,)
            kept |= {str(one): one for one in inner}
    if decisive:  # f >= 0 includes f = 0
        weak = {str(one.boundary()) for one in kept.values() if isinstance(one, Claim) and one.relation == ">="}
        kept = {text: one for text, one in kept.items() if text not in weak}
    if not kept:
        return not decisive
    return next(iter(kept.values())) if len(kept) == 1 else Joined(word, tuple(kept.values()))


def narrowed(domain: Domain, formula: Formula | bool) -> Domain:
    """The domain where a claim holds, if that is an interval of one parameter; otherwise the whole."""
    if isinstance(formula, Claim) and (interval := formula.interval()):
        return domain.narrowed(interval) or domain
    if isinstance(formula, Joined) and formula.word == "and":
        for part in formula.parts:
            domain = narrowed(domain, part)
    return domain


def value(f: fmpz_mpoly, values: Mapping[str, Fraction]) -> Fraction:
    """A polynomial at given parameters."""
    names = f.context().names()
    used = [(gen, values[names[gen]]) for gen, d in enumerate(f.degrees()) if d > 0]
    return sum((prod((x ** int(m[gen]) for gen, x in used), start=Fraction(int(c))) for m, c in f.terms()), Fraction(0))


def _between(low: Fraction | None, high: Fraction | None) -> Fraction:
    if low is None:
        return Fraction(0) if high is None else high - 1
    return low + 1 if high is None else (low + high) / 2


def _sides(f: fmpz_mpoly, relation: str) -> str:
    """f >= 0 with all terms on the side where they are positive."""
    terms = f.to_dict()
    context = f.context()
    left, right = (context.from_dict({m: abs(c) for m, c in terms.items() if (c > 0) == up}) for up in (True, False))
    return f"{polynomial_text(left)} {relation} {polynomial_text(right)}"


def polynomial_text(f: fmpz_mpoly, s: str = "s") -> str:
    """Write a polynomial in s, or a name for it, and the parameters, a positive term first if there is one."""
    names = (s, *f.context().names()[1:])
    text, terms = "", list(f.terms())
    first = next((k for k, (_, c) in enumerate(terms) if c > 0), 0)
    for monomial, c in [terms[first], *terms[:first], *terms[first + 1 :]] if terms else []:
        factors = [name if k == 1 else f"{name}^{k}" for name, k in zip(names, map(int, monomial), strict=True) if k]
        if abs(c) != 1 or not factors:
            factors = [str(abs(c)), *factors]
        text += (" - " if c < 0 else " + ") + "*".join(factors)
    return text[3:] if text.startswith(" + ") else "-" + text[3:] if text else "0"


def factor_text(f: fmpz_mpoly, power: int = 1) -> str:
    """A power of a polynomial as part of a product."""
    text = polynomial_text(f)
    text = f"({text})" if len(f) > 1 or (power > 1 and "*" in text) else text
    return text if power == 1 else f"{text}^{power}"


def quotient_text(p: fmpz_mpoly, q: fmpz_mpoly) -> str:
    """p/q."""
    over, under = factor_text(p), polynomial_text(q)
    if under == "1":
        return polynomial_text(p)
    return f"{over}/({under})" if len(q) > 1 or "*" in under else f"{over}/{under}"


@dataclass(frozen=True)
class Condition:
    """Necessary and sufficient condition on the parameters, besides the assumptions, for the property.

    Parameters
    ----------
    formula : Claim or Joined
        In the parameters, by their names.
    ranges : tuple of Range
        Assumptions on the parameters.
    function : Pair
        Numerator and denominator as the expression gives them when multiplied out.
    """

    formula: Formula
    ranges: tuple[Range, ...]
    function: Pair

    def holds(self, values: Mapping[str, Exact]) -> bool:
        """Return whether the condition holds at a value for each parameter, decided exactly.

        Raises
        ------
        ExpressionError
            If a parameter has no value, none that is a number, or one against the assumptions; and for 0/0.
        """
        numbers = {}
        for r in self.ranges:
            if r.name not in values:
                raise ExpressionError(f"parameter {r.name}", "no value", f"a number with {r}")
            numbers[r.name] = exact(values[r.name], f"parameter {r.name}")
            if numbers[r.name] not in r:
                raise ExpressionError(
                    f"parameter {r.name}", "against the assumption", str(r), shorten(shown(values[r.name]))
                )
        if all(_vanishes(f, numbers) for f in self.function):
            raise ExpressionError("parameters", "0/0 has no value", "a numerator or a denominator that is not zero")
        return self.formula.holds(numbers)

    def __str__(self) -> str:
        return str(self.formula)


def _vanishes(f: fmpz_mpoly, values: Mapping[str, Fraction]) -> bool:
    """Whether a polynomial is 0 for all s and delays."""
    return all(value(c, values) == 0 for part in coefficients(f) for c in coefficients(part, 1))
