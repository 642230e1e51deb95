"""Expressions as sums of products: a rational function times whole powers of sums and of functions of sums.

Rational subtrees are rational functions here; nothing else is multiplied out. s is the Laplace variable, all functions
are principal branches.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import isqrt
from typing import TypeAlias

from flint import fmpz_poly

from passivity.errors import ExpressionError
from passivity.rational.function import RationalFunction
from passivity.size import check_size

ONE = RationalFunction.constant(Fraction(1))
_INVERSES = {"tanh": "coth", "coth": "tanh", "sinh": "csch", "csch": "sinh", "cosh": "sech", "sech": "cosh"}


@dataclass(frozen=True)
class Function:
    """One of `passivity.expression.parse.FUNCTIONS` at an argument."""

    name: str
    argument: "Form"

    def __str__(self) -> str:
        return f"{self.name}({self.argument})"


@dataclass(frozen=True)
class Product:
    """A rational function times powers of what is not rational, in order of their texts."""

    rational: RationalFunction
    factors: "tuple[tuple[Base, int], ...]" = ()

    def __str__(self) -> str:
        if not self.factors and self.rational.q == 1:
            return _polynomial(self.rational.p)
        above = [_power(base, e) for base, e in self.factors if e > 0]
        below = [_power(base, -e) for base, e in self.factors if e < 0]
        p, q, sign = self.rational.p, self.rational.q, ""
        if p == -1 and above:
            p, sign = -p, "-"
        if p != 1 or not above:
            above.insert(0, _enclosed(_polynomial(p)))
        if q != 1:
            below.insert(0, _enclosed(_polynomial(q)))
        bottom = "*".join(below)
        if "*" in bottom and (len(below) > 1 or bottom[0] != "("):
            bottom = f"({bottom})"
        return sign + "*".join(above) + (f"/{bottom}" if bottom else "")


@dataclass(frozen=True)
class Form:
    """The sum of products; no terms make zero, and at most one term is rational."""

    terms: tuple[Product, ...]

    @cached_property
    def _hash(self) -> int:
        return hash(self.terms)

    def __hash__(self) -> int:
        return self._hash

    @property
    def rational(self) -> RationalFunction | None:
        """The rational function that this is, if it is one."""
        if not self.terms:
            return RationalFunction.constant(Fraction(0))
        (term, *more) = self.terms
        return term.rational if not more and not term.factors else None

    def __add__(self, other: "Form") -> "Form":
        return add((*self.terms, *other.terms))

    def __sub__(self, other: "Form") -> "Form":
        return self + other * constant(-1)

    def __mul__(self, other: "Form") -> "Form":
        return multiply([(self, 1), (other, 1)])

    def __truediv__(self, other: "Form") -> "Form":
        return multiply([(self, 1), (other, -1)])

    @cached_property
    def depth(self) -> int:
        """How deep functions and sums are nested."""
        bases = [base for term in self.terms for base, _ in term.factors]
        return max((1 + (b.argument if isinstance(b, Function) else b).depth for b in bases), default=0)

    @cached_property
    def size(self) -> int:
        """Number of coefficients and powers in it."""
        bases = [base for term in self.terms for base, _ in term.factors]
        inner = sum(1 + (b.argument if isinstance(b, Function) else b).size for b in bases)
        return inner + sum(len(term.rational.p) + len(term.rational.q) for term in self.terms)

    @cached_property
    def _text(self) -> str:
        return " + ".join(map(str, self.terms)).replace("+ -", "- ") or "0"

    def __str__(self) -> str:
        return self._text


Base: TypeAlias = Form | Function


def constant(value: Fraction | int) -> Form:
    """A number as a form."""
    return of_rational(RationalFunction.constant(Fraction(value)))


def of_rational(function: RationalFunction) -> Form:
    """A rational function as a form."""
    return Form(()) if function.is_zero else Form((Product(function.reduced()),))


def add(terms: Iterable[Product]) -> Form:
    """The sum, terms with the same factors united, inner sums opened."""
    total: dict[tuple, RationalFunction] = {}
    for term in terms:
        opened = _opened(term)
        for part in opened:
            old = total.get(part.factors)
            total[part.factors] = _kept(part.rational if old is None else (old + part.rational).reduced())
    return Form(tuple(Product(r, factors) for factors, r in total.items() if not r.is_zero))


def _opened(term: Product) -> tuple[Product, ...]:
    if len(term.factors) == 1 and term.rational.degree == 0:
        ((base, e),) = term.factors
        if isinstance(base, Form) and e == 1:
            return tuple(Product((part.rational * term.rational).reduced(), part.factors) for part in base.terms)
    return (term,)


def multiply(powers: Iterable[tuple[Base, int]]) -> Form:
    """The product of powers; a division by zero is refused."""
    rational, factors = ONE, {}
    stack = list(powers)
    while stack:
        base, e = stack.pop()
        if isinstance(base, Form) and len(base.terms) <= 1:
            if not base.terms and e < 0:
                raise ExpressionError("", "division by zero", "a denominator that is not zero everywhere")
            if not base.terms and e > 0:
                return Form(())
            for term in base.terms:
                rational = _kept((rational * term.rational**e).reduced())
                stack += [(inner, e * k) for inner, k in term.factors]
        elif isinstance(base, Function) and base.name == "sqrt" and e % 2 == 0:
            stack.append((base.argument, e // 2))
        else:
            factors[base] = factors.get(base, 0) + e
            if isinstance(base, Function) and base.name == "sqrt" and factors[base] % 2 == 0:
                stack.append((base.argument, factors.pop(base) // 2))
    for base in [base for base, e in factors.items() if e < 0 and isinstance(base, Function)]:
        if base.name in _INVERSES:
            inverse = Function(_INVERSES[base.name], base.argument)
            factors[inverse] = factors.get(inverse, 0) - factors.pop(base)
    check_size(max(map(abs, factors.values()), default=0), 0)
    kept = sorted(((base, e) for base, e in factors.items() if e), key=lambda item: str(item[0]))
    if rational.is_zero:
        return Form(())
    return add([Product(rational, tuple(kept))])


def apply(name: str, argument: Form) -> Form:
    """A function at an argument; exp(0), log(1) and roots of squares are numbers."""
    r = argument.rational
    if r is not None and r.degree == 0:
        p, q = int(r.p[0]), int(r.q[0])
        if q == 0:
            raise ExpressionError("", "division by zero", "a denominator that is not zero everywhere")
        if name == "sqrt" and p >= 0 and isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
            return constant(Fraction(isqrt(p), isqrt(q)))
        if (name, p, q) in (("exp", 0, 1), ("cosh", 0, 1), ("sech", 0, 1)):
            return constant(1)
        if (name, p, q) in (("log", 1, 1), ("sinh", 0, 1), ("tanh", 0, 1)):
            return constant(0)
        if (name, p, q) in (("log", 0, 1), ("coth", 0, 1), ("csch", 0, 1)):
            raise ExpressionError("", f"{name}({p}) has no value", "another argument")
    return Form((Product(ONE, ((Function(name, argument), 1),)),))


def functions(form: Form) -> Iterator[Function]:
    """All functions in a form, those in arguments before those around them."""
    for term in form.terms:
        for base, _ in term.factors:
            inner = base.argument if isinstance(base, Function) else base
            yield from functions(inner)
            if isinstance(base, Function):
                yield base


def depends_on_s(form: Form) -> bool:
    """Whether s occurs in a form."""
    return any(
        t.rational.degree > 0 or any(depends_on_s(b.argument if isinstance(b, Function) else b) for b, _ in t.factors)
        for t in form.terms
    )


def _kept(r: RationalFunction) -> RationalFunction:
    check_size(r.degree, r.bits)
    return r


def _power(base: Base, e: int) -> str:
    text = f"({base})" if isinstance(base, Form) else str(base)
    return text if e == 1 else f"{text}^{e}"


def _polynomial(f: fmpz_poly) -> str:
    text = str(f).replace("(-1)*", "-").replace("(-", "-").replace(")", "").replace("+ -", "- ").replace("x", "s")
    return text.replace("- 1*", "- ")


def _enclosed(text: str) -> str:
    return f"({text})" if " " in text else text
