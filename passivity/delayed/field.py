"""Forms as quotients of polynomials in s and in generators: exponentials, square roots of primes, other functions.

Equal quotients are equal functions, whatever relations there are between the generators; the converse is not claimed.
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from math import gcd
from typing import NamedTuple, TypeAlias

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from passivity.budget import UndecidedError, spend
from passivity.delayed.form import ONE, Form, Function, Product, add, apply, constant, functions, multiply, of_rational
from passivity.rational.function import RationalFunction
from passivity.size import check_size

MAX_GENERATORS = 24
MAX_TERMS = 300
MAX_EXPONENT = 40  # of a sum
MAX_POWER = 4_000  # of s or a generator in a polynomial
MAX_UNITS = 2000  # of a delay, in its largest common measure with the others
_FACTORED = 16  # degree
_PRIME_BITS = 64  # of numbers that are split into primes

Monomial: TypeAlias = dict[Function, Fraction]


class TooLargeError(UndecidedError):
    """The polynomials would grow too large."""


class Element(NamedTuple):
    """A quotient of polynomials in the generators."""

    n: fmpz_mpoly
    d: fmpz_mpoly


class Field:
    """The rational functions of s and of all generators in the given forms.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> a, b = of_text("sinh(s)/cosh(s)"), of_text("(1 - exp(-2*s))/(1 + exp(-2*s))")
    >>> Field(a, b).equal(a, b)
    True
    """

    def __init__(self, *forms: Form):
        units: dict[Function, Fraction] = {}
        for function in (f for form in forms for f in functions(form)):
            for g, e in monomial(function)[1].items():
                units[g] = _common(units.get(g, e), e)
        if len(units) > MAX_GENERATORS:
            raise TooLargeError
        self.units, self.generators = units, list(units)
        self.ring = fmpz_mpoly_ctx.get(["s", *(f"g{k}" for k in range(len(units)))], Ordering.lex)
        self.s, *self.gens = self.ring.gens()
        self.index = {g: k for k, g in enumerate(self.generators)}
        one = self.ring.constant(1)
        self.one = Element(one, one)

    def equal(self, a: Form, b: Form) -> bool:
        """Whether the two are the same quotient."""
        x, y = self.of(a), self.of(b)
        return not self.reduced(self.product(x.n, y.d) - self.product(y.n, x.d))

    def of(self, form: Form) -> Element:
        """The quotient that a form is."""
        total = Element(self.ring.constant(0), self.ring.constant(1))
        for term in form.terms:
            x = self._term(term)
            n = self.product(total.n, x.d) + self.product(x.n, total.d)
            total = self.cancelled(Element(n, self.product(total.d, x.d)))
        return total

    def _term(self, term: Product) -> Element:
        result = Element(self.univariate(term.rational.p), self.univariate(term.rational.q))
        for base, e in term.factors:
            x = self.of(base) if isinstance(base, Form) else self._function(base)
            if abs(e) > MAX_EXPONENT and len(x.n) + len(x.d) > 2:
                raise TooLargeError
            n, d = (self.power_of(f, abs(e)) for f in (x if e > 0 else reversed(x)))
            result = self.times(result, Element(n, d))
        return result

    def power_of(self, f: fmpz_mpoly, e: int) -> fmpz_mpoly:
        """A polynomial to a power, if it is not too large."""
        if len(f) == 1:
            check_size(0, e * _bits(f))
            return self.reduced(f**e)
        result = self.ring.constant(1)
        for _ in range(e):
            result = self.product(result, f)
        return result

    def _function(self, function: Function) -> Element:
        if (rational := _hyperbolic(function)) is not None:
            return self.of(rational)
        r, powers = monomial(function)
        n, d = self.univariate(r.p), self.univariate(r.q)
        for g, e in powers.items():
            k = int(e / self.units[g])
            if abs(k) > MAX_UNITS:
                raise TooLargeError
            generator = self.gens[self.index[g]] ** abs(k)
            n, d = (n * generator, d) if k > 0 else (n, d * generator)
        return Element(n, d)

    def univariate(self, f: fmpz_poly) -> fmpz_mpoly:
        """A polynomial in s, as one in s and the generators."""
        zeros = (0,) * len(self.gens)
        return self.ring.from_dict({(k, *zeros): c for k, c in enumerate(f.coeffs()) if c})

    def times(self, x: Element, y: Element) -> Element:
        """The product of two elements."""
        return self.cancelled(Element(self.product(x.n, y.n), self.product(x.d, y.d)))

    def product(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
        """The product of two polynomials, if it is not too large."""
        if len(f) * len(g) > MAX_TERMS * 40:
            raise TooLargeError
        spend(5_000 + len(f) * len(g) * (500 + _bits(f) + _bits(g)), "multiplying out")
        return self.reduced(f * g)

    def reduced(self, f: fmpz_mpoly) -> fmpz_mpoly:
        """Squares of square roots replaced by what they are."""
        for k, g in enumerate(self.generators, 1):
            if g.name != "sqrt" or (inside := g.argument.rational) is None or inside.q != 1:
                continue
            if f and f.degrees()[k] > 1:
                relation = self.univariate(inside.p)
                parts: dict[int, dict] = {}
                for exponents, c in f.to_dict().items():
                    e = exponents[k]
                    parts.setdefault(e, {})[(*exponents[:k], e % 2, *exponents[k + 1 :])] = c
                f = sum(
                    (self.ring.from_dict(p) * relation ** (e // 2) for e, p in parts.items()), self.ring.constant(0)
                )
        if len(f) > MAX_TERMS or max(f.degrees(), default=0) > MAX_POWER:
            raise TooLargeError
        return f

    def cancelled(self, x: Element) -> Element:
        """The quotient without common factors."""
        if not x.n:
            return Element(x.n, self.ring.constant(1))
        spend(20_000 + 300 * len(x.n) * len(x.d) * (1 + _bits(x.n) // 64 + _bits(x.d) // 64), "a common factor")
        common = x.n.gcd(x.d)
        return Element(x.n // common, x.d // common)

    def form(self, x: Element) -> Form:
        """The element written as a form."""
        return self.polynomial(x.n) / self.polynomial(x.d)

    def polynomial(self, f: fmpz_mpoly) -> Form:
        """The polynomial written as a form."""
        by_generators: dict[tuple, dict[int, int]] = {}
        for exponents, c in f.to_dict().items():
            by_generators.setdefault(exponents[1:], {})[int(exponents[0])] = int(c)
        terms = []
        for exponents, powers in by_generators.items():
            coefficients = [powers.get(k, 0) for k in range(max(powers) + 1)]
            r = of_rational(RationalFunction(fmpz_poly(coefficients), fmpz_poly([1])))
            factors = (self.power(g, e) for g, e in zip(self.generators, exponents, strict=True) if e)
            terms += multiply([(r, 1), *((x, 1) for x in factors)]).terms
        return add(terms)

    def power(self, g: Function, e: int) -> Form:
        """A generator, in its unit, to a power; those of exp as one exp."""
        if g.name == "exp":
            return apply("exp", g.argument * constant(int(e) * self.units[g]))
        return multiply([(g, int(e))])


def _bits(f: fmpz_mpoly) -> int:
    return max((abs(c).bit_length() for c in f.coeffs()), default=0)


def _common(a: Fraction, b: Fraction) -> Fraction:
    """The largest number that both are whole multiples of."""
    return Fraction(gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator)


@lru_cache(maxsize=1000)
def monomial(function: Function) -> tuple[RationalFunction, Monomial]:
    """A function as a rational function times rational powers of generators."""
    if function.name == "exp":
        return ONE, _exponential(function.argument, Fraction(1))
    if function.name == "sqrt" and (inside := function.argument.rational) is not None:
        return _root(function, inside)
    if function.name == "log" or function.name == "sqrt":
        return ONE, {function: Fraction(1)}
    return ONE, _exponential(function.argument, Fraction(1))


def _exponential(argument: Form, c: Fraction) -> Monomial:
    powers: Monomial = {}
    for term in argument.terms:
        for factor, r in _split(term.rational):
            g = Function("exp", Form((Product(r, term.factors),)))
            powers[g] = powers.get(g, Fraction(0)) + c * factor
    return powers


def _split(r: RationalFunction) -> Iterator[tuple[Fraction, RationalFunction]]:
    """A rational function as numbers times powers of s, or times a primitive one; signs turned to exp(-...)."""
    one = fmpz_poly([1])
    if r.q.degree() == 0:
        for k, c in enumerate(r.p.coeffs()):
            if c:
                yield -Fraction(int(c), int(r.q[0])), RationalFunction(fmpz_poly([0] * k + [-1]), one)
        return
    up, down = r.p.content() * (1 if r.p.leading_coefficient() > 0 else -1), r.q.content()
    yield -Fraction(int(up), int(down)), RationalFunction(-(r.p // up), r.q // down)


def _root(function: Function, inside: RationalFunction) -> tuple[RationalFunction, Monomial]:
    """Root of a rational function as roots of its prime factors, where the arguments cannot add up to a half turn."""
    if inside.degree > _FACTORED:
        return ONE, {function: Fraction(1)}
    unit, factors = (inside.p * inside.q).factor()
    turns = sum(e * _quarter_turns(f) for f, e in inside.p.factor()[1] + inside.q.factor()[1])
    if turns > 2 or unit <= 0 or unit.bit_length() > _PRIME_BITS:
        return ONE, {function: Fraction(1)}
    rational = RationalFunction(fmpz_poly([1]), inside.q)
    powers: Monomial = {}
    primes = [(fmpz_poly([p]), e) for p, e in unit.factor()]
    for f, e in [*primes, *factors]:
        rational = rational * RationalFunction(f ** (e // 2), fmpz_poly([1]))
        if e % 2:
            powers[Function("sqrt", of_rational(RationalFunction(f, fmpz_poly([1]))))] = Fraction(1)
    return rational.reduced(), powers


def _quarter_turns(f: fmpz_poly) -> int:
    """A bound of |arg f| in Re s > 0, in quarter turns, f prime with a positive leading coefficient; 9 for none."""
    if f.degree() == 1 and f[0] >= 0:
        return 1
    return 2 if f.degree() == 2 and all(c >= 0 for c in f.coeffs()) else 9


def _hyperbolic(function: Function) -> Form | None:
    """A hyperbolic function in exp(-x), or exp(-2x) where that is enough."""
    x, one, two = function.argument, constant(1), constant(2)
    y = apply("exp", x * constant(-1))
    y2 = apply("exp", x * constant(-2))
    match function.name:
        case "tanh":
            return (one - y2) / (one + y2)
        case "coth":
            return (one + y2) / (one - y2)
        case "sinh":
            return (one - y2) / (two * y)
        case "cosh":
            return (one + y2) / (two * y)
        case "sech":
            return two * y / (one + y2)
        case "csch":
            return two * y / (one - y2)
    return None
