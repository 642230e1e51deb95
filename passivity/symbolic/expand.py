"""An expression as the pair (p : q) of two polynomials in s, e = exp(-tau s) and the parameters, with size limits."""

from collections.abc import Mapping
from fractions import Fraction
from functools import reduce
from math import gcd, lcm
from typing import NamedTuple

from flint import fmpz_mpoly

from passivity.budget import UndecidedError, spend
from passivity.errors import ExpressionError
from passivity.expression.tree import Add, Call, Divide, Line, Multiply, Negate, Node, Number, Power, Symbol
from passivity.size import bits_of
from passivity.symbolic.domain import Domain

MAX_PARAMETERS = 40
MAX_TERMS = 20_000  # of one polynomial
MAX_DEGREE = 400  # in s or any parameter
MAX_BITS = 10_000  # of one coefficient
MAX_WORK = 3_000_000  # products of terms in one expression
_MAX_REDUCED = 2_000  # terms of a pair that is freed of common factors


class ExpansionError(UndecidedError):
    """The expression has no expansion, or one that is too large; the message says why."""


class Pair(NamedTuple):
    """p/q; open circuit (1 : 0) and short circuit (0 : 1) included."""

    p: fmpz_mpoly
    q: fmpz_mpoly

    def inverse(self) -> "Pair":
        """q/p."""
        return Pair(self.q, self.p)

    def reduced(self) -> "Pair":
        """The pair without common factors."""
        if len(self.p) + len(self.q) > _MAX_REDUCED:
            raise ExpansionError(f"the expanded function has over {_MAX_REDUCED} terms")
        words = 1 + (bits(self.p) + bits(self.q)) // 64
        spend(100_000 + 300 * len(self.p) * len(self.q) * words, "a common factor")
        common = self.p.gcd(self.q)
        return Pair(self.p / common, self.q / common)


class Expanded(NamedTuple):
    """A function of s and e = exp(-tau s), tau free of s.

    Parameters
    ----------
    whole, function : Pair
        As the expression gives it, and without common factors.
    tau : Pair
        0 where there is no delay.
    """

    whole: Pair
    function: Pair
    tau: Pair


class Expansion:
    """Turns trees into pairs, until all together they are too large.

    Parameters
    ----------
    domain : Domain
        Of the parameters without a value.
    numbers : mapping of str to Fraction
        The others.
    """

    def __init__(self, domain: Domain, numbers: Mapping[str, Fraction]):
        self.domain, self.numbers, self.work = domain, dict(numbers), 0
        s, self.e, *parameters = domain.context.gens()
        self.one = domain.context.constant(1)
        named = zip((r.name for r in domain.ranges), parameters, strict=True)
        self.values = {name: self.number(x) for name, x in numbers.items()}
        self.values |= {name: Pair(gen, self.one) for name, gen in named} | {"s": Pair(s, self.one)}
        self.powers: dict[Node, int] = {}  # of e, for each argument of exp

    def number(self, x: Fraction) -> Pair:
        """A number as a pair."""
        if bits_of(x) > MAX_BITS:
            raise ExpansionError(f"a number has over {MAX_BITS} bits")
        return Pair(self.one * x.numerator, self.one * x.denominator)

    def function(self, tree: Node) -> Expanded:
        """The expression freed of common factors, all its delays being whole multiples of one tau.

        Raises
        ------
        ExpansionError
            If it is neither rational nor a delay, or passes one of the limits above.
        ExpressionError
            For 0/0 whatever the parameters are.
        """
        if len(self.domain.ranges) > MAX_PARAMETERS:
            raise ExpansionError(f"functions of over {MAX_PARAMETERS} parameters are not expanded")
        arguments = list(_arguments(tree))
        delays = [self.delay(argument) for argument in arguments]
        base = next((d for d in delays if d.p), None)
        if base is None:
            self.powers = dict.fromkeys(arguments, 0)
            whole = self.of(tree)
            return Expanded(whole, whole.reduced(), self.number(Fraction(0)))
        ratios = [_ratio(d, base) for d in delays]
        unit = Fraction(reduce(gcd, (r.numerator for r in ratios)), reduce(lcm, (r.denominator for r in ratios)))
        self.powers = {argument: int(r / unit) for argument, r in zip(arguments, ratios, strict=True)}
        if max(map(abs, self.powers.values())) > MAX_DEGREE:
            raise ExpansionError(f"the longest delay is over {MAX_DEGREE} times their common measure")
        whole = self.of(tree)
        return Expanded(whole, whole.reduced(), self.product(base, self.number(unit)).reduced())

    def delay(self, argument: Node) -> Pair:
        """tau of an argument -tau s of exp."""
        p, q = self.of(argument).reduced()
        s = self.values["s"].p
        if q.degrees()[0] > 0 or (p and p.degrees()[0] != 1) or p.subs({"s": 0}):
            raise ExpansionError("one exp(...) is no delay exp(-T*s) with T free of s")
        return Pair(-p / s, q)

    def of(self, node: Node) -> Pair:
        """The pair of a tree."""
        match node:
            case Number(value):
                return self.number(value)
            case Symbol(name):
                return self.values[name]
            case Negate(operand):
                p, q = self.of(operand)
                return Pair(-p, q)
            case Divide(numerator, denominator):
                return self.product(self.of(numerator), self.of(denominator).inverse())
            case Power(base, exponent):
                return self.power(self.of(base), exponent)
            case Multiply(factors):
                return reduce(self.product, map(self.of, factors))
            case Add(terms):
                return reduce(self.sum, map(self.of, terms))
            case Call("exp", argument) if argument in self.powers:
                k = self.powers[argument]
                return Pair(self.e**k, self.one) if k >= 0 else Pair(self.one, self.e**-k)
            case Call() | Line():
                name = node.name if isinstance(node, Call) else "line"
                raise ExpansionError(f"{name}(...) is not rational, nor a delay")

    def power(self, a: Pair, exponent: int) -> Pair:
        """a to a whole power."""
        base = a if exponent >= 0 else a.inverse()
        return reduce(self.product, [base] * abs(exponent), Pair(self.one, self.one))

    def product(self, a: Pair, b: Pair) -> Pair:
        """a b."""
        return _valid(Pair(self.times(a.p, b.p), self.times(a.q, b.q)))

    def sum(self, a: Pair, b: Pair) -> Pair:
        """a + b."""
        if a.q == b.q:
            return Pair(a.p + b.p, a.q) if a.q else a  # two open circuits in series
        return _valid(Pair(self.times(a.p, b.q) + self.times(b.p, a.q), self.times(a.q, b.q)))

    def times(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
        """f g, if it is not too large."""
        size = len(f) * len(g)
        self.work += size
        if self.work > MAX_WORK or size > 100 * MAX_TERMS:
            raise ExpansionError(f"to expand the function takes over {MAX_WORK} products")
        spend(2_000 + size * (50 + (bits(f) + bits(g)) // 8), "the expansion")
        found = f * g
        if len(found) > MAX_TERMS or bits(found) > MAX_BITS or max(found.degrees()) > MAX_DEGREE:
            limits = f"{MAX_TERMS} terms, or numbers of over {MAX_BITS} bits, or a degree over {MAX_DEGREE}"
            raise ExpansionError(f"the expanded function has over {limits}")
        return found


def _valid(pair: Pair) -> Pair:
    if not pair.p and not pair.q:
        raise ExpressionError("", "0/0 has no value", "a numerator or a denominator that is not zero")
    return pair


def bits(f: fmpz_mpoly) -> int:
    """Length of the longest coefficient."""
    return max((abs(int(c)).bit_length() for c in f.coeffs()), default=0)


def _arguments(tree: Node) -> set[Node]:
    """All arguments of exp."""
    found, stack = set(), [tree]
    while stack:
        match stack.pop():
            case Call(name, argument):
                if name == "exp":
                    found.add(argument)
                stack.append(argument)
            case Add(children) | Multiply(children):
                stack += children
            case Divide(numerator, denominator):
                stack += [numerator, denominator]
            case Negate(child) | Power(child, _):
                stack.append(child)
    return found


def _ratio(a: Pair, b: Pair) -> Fraction:
    """The number a/b."""
    over, under = a.p * b.q, a.q * b.p
    ratio = Fraction(int(over.leading_coefficient()), int(under.leading_coefficient())) if over else Fraction(0)
    if over * ratio.denominator != under * ratio.numerator:
        raise ExpansionError("the delays are not whole multiples of one")
    return ratio
