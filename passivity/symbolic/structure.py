"""Proofs along the tree of an expression, which is never multiplied out: a ladder of any size, element by element.

A product is a constant c of parameters, times a power of s, times sums and functions X, Y, ... For Re s > 0:

    element     c, c s and c/s are positive real for c >= 0
    sum         so is Z1 + Z2; and X M is the sum of t M over the terms t of X
    inverse     so is 1/Z, for Re 1/Z = Re Z/|Z|^2; and M/X is the inverse of the sum of t/M
    root        so is sqrt(Z1 Z2), for its angle is the mean of two from -90 to 90 degrees
    Cayley      (a - b)/(a + b) is bounded real if b/a is positive real, and positive real if b/a is bounded real
    product     H1 H2 is bounded real, and c for |c| <= 1
    delay       so is exp(-Z), for |exp(-Z)| = exp(-Re Z)
    divider     so is 1/(c + Z) for c >= 1, for |c + Z| >= c + Re Z >= 1
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import chain

from passivity.budget import UndecidedError
from passivity.errors import ExpressionError
from passivity.expression.tree import Add, Call, Divide, Multiply, Negate, Node, Power, Symbol, symbols
from passivity.status import Kind
from passivity.symbolic.expand import Expansion, ExpansionError, Pair
from passivity.symbolic.product import Monomial, cayley, pairs

MAX_STEPS = 2_000
_ELEMENTS = ("a constant >= 0", "s times a constant >= 0", "1/s times a constant >= 0")  # for the powers 0, 1, -1


@dataclass(frozen=True)
class Proof:
    """That a product is positive real or bounded real: the rule, and the proofs of what it needs."""

    product: Monomial
    kind: Kind
    rule: str
    parts: tuple["Proof", ...] = ()

    def lines(self, depth: int = 0) -> list[str]:
        """One line for each claim, those it needs indented below it."""
        below = chain.from_iterable(part.lines(depth + 1) for part in self.parts)
        return [f"{'  ' * depth}{self.product} is {self.kind}: {self.rule}", *below]


class Structure:
    """The prover; it gives up after MAX_STEPS products."""

    def __init__(self, expansion: Expansion):
        self.expansion, self.signs, self.steps = expansion, expansion.domain.signs, 0
        self.unit = Monomial(Pair(expansion.one, expansion.one), 0, {})

    def prove(self, node: Node, kind: Kind) -> Proof | None:
        """A proof that a function is positive real or bounded real for all parameters; None if none is found.

        Values of the parameters that make the expression 0/0 are left out.
        """
        try:
            product = self.product(node)
            return self.positive(product) if kind is Kind.PR else self.bounded(product)
        except (UndecidedError, ExpressionError):  # 0/0 among them
            return None

    def positive(self, z: Monomial) -> Proof | None:
        """A proof that a product is positive real."""
        if not z.atoms:
            element = abs(z.power) <= 1 and self.nonnegative(z.constant)
            return Proof(z, Kind.PR, _ELEMENTS[z.power]) if element else None
        for atom, rest in self.apart(z, 1):
            if parts := self.all_positive([self.times(t, rest) for t in self.terms(atom)]):
                return Proof(z, Kind.PR, "sum", parts)
        for atom, rest in self.apart(z, -1):
            if parts := self.all_positive([self.times(t, rest, -1) for t in self.terms(atom)]):
                return Proof(z, Kind.PR, "inverse of a sum", parts)
        if z.power or not self.nonnegative(z.constant):
            return None
        if (proof := self.root(z)) or len(z.atoms) != 2:
            return proof
        for a, b in cayley(z.atoms):
            if proof := self.bounded(self.times(self.product(b), self.product(a), -1)):
                return Proof(z, Kind.PR, "Cayley", (proof,))
        return None

    def root(self, z: Monomial) -> Proof | None:
        """A proof for c sqrt(Z1 Z2) or c/sqrt(Z1 Z2)."""
        match list(z.atoms.items()):
            case [(Call("sqrt", argument), 1 | -1)]:
                inside = self.product(argument)
                factors = [Monomial(inside.constant, inside.power, {})] if inside.power or not inside.atoms else []
                factors += [Monomial(self.unit.constant, 0, {x: k}) for x, k in inside.atoms.items()]
                if len(factors) <= 2 and self.nonnegative(inside.constant) and (parts := self.all_positive(factors)):
                    return Proof(z, Kind.PR, "root", parts)
        return None

    def bounded(self, h: Monomial) -> Proof | None:
        """A proof that a product is bounded real."""
        p, q = (self.expansion.times(f, f) for f in h.constant)
        if not h.atoms and not h.power:
            return Proof(h, Kind.BR, "a constant c with |c| <= 1") if -1 not in self.signs(q - p) else None
        for atom, rest in self.apart(h, -1):
            if parts := self.divider([self.times(t, rest, -1) for t in self.terms(atom)]):
                return Proof(h, Kind.BR, "divider", parts)
        for one, proof in self.bounded_factors(h):
            rest = self.times(h, one, -1)
            if not rest.atoms and not rest.power and rest.constant == self.unit.constant:
                return proof
            if other := self.bounded(rest):
                return Proof(h, Kind.BR, "product", (proof, other))
        return None

    def bounded_factors(self, h: Monomial) -> Iterator[tuple[Monomial, Proof]]:
        """Factors of a product that are bounded real: delays and Cayley transforms."""
        for atom, k in h.atoms.items():
            if isinstance(atom, Call) and atom.name == "exp" and k > 0:
                one = Monomial(self.unit.constant, 0, {atom: k})
                gamma = self.positive(self.product(Negate(atom.argument)))
                if gamma:
                    yield one, Proof(one, Kind.BR, "delay", (gamma,))
        for above, below in pairs(h.atoms):
            one = Monomial(self.unit.constant, 0, {above: 1, below: -1})
            for a, b in cayley(one.atoms):
                if proof := self.positive(self.times(self.product(b), self.product(a), -1)):
                    yield one, Proof(one, Kind.BR, "Cayley", (proof,))

    def divider(self, terms: list[Monomial]) -> tuple[Proof, ...]:
        """Proofs that a sum is a constant >= 1 and a positive real function, of the latter's terms."""
        constant, rest = self.expansion.number(Fraction(-1)), []
        for t in terms:
            if t.atoms or t.power:
                rest.append(t)
            else:
                constant = self.expansion.sum(constant, t.constant)
        return self.all_positive(rest) if self.nonnegative(constant) else ()

    def all_positive(self, products: list[Monomial]) -> tuple[Proof, ...]:
        """A proof for each that it is positive real; none if one is missing."""
        proofs = []
        for one in products:
            if not (proof := self.positive(one)):
                return ()
            proofs.append(proof)
        return tuple(proofs)

    def apart(self, product: Monomial, power: int) -> Iterator[tuple[Add, Monomial]]:
        """Each sum with this power in a product, and X M/X = M or (M/X)/(1/X) = M, the rest."""
        for atom, k in product.atoms.items():
            if isinstance(atom, Add) and k == power:
                yield atom, self.times(product, Monomial(self.unit.constant, 0, {atom: k}), -1)

    def terms(self, sum_: Add) -> list[Monomial]:
        """The terms of a sum, all constants together being one."""
        constants = [t for t in sum_.terms if "s" not in symbols(t)]
        rest = [t for t in sum_.terms if "s" in symbols(t)]
        return [self.product(t) for t in ([Add(tuple(constants))] if constants else []) + rest]

    def product(self, node: Node) -> Monomial:
        """A tree as a product."""
        self.steps += 1
        if self.steps > MAX_STEPS:
            raise ExpansionError(f"a proof along the expression takes over {MAX_STEPS} steps")
        if "s" not in symbols(node):
            return Monomial(self.expansion.of(node).reduced(), 0, {})
        match node:
            case Symbol():
                return Monomial(self.unit.constant, 1, {})
            case Negate(operand):
                one = self.product(operand)
                return Monomial(Pair(-one.constant.p, one.constant.q), one.power, one.atoms)
            case Multiply(factors):
                return reduce(self.times, map(self.product, factors))
            case Divide(numerator, denominator):
                return self.times(self.product(numerator), self.product(denominator), -1)
            case Power(base, exponent):
                one = self.product(base)
                constant = self.expansion.power(one.constant, exponent)
                return Monomial(constant, one.power * exponent, {x: k * exponent for x, k in one.atoms.items()})
        return Monomial(self.unit.constant, 0, {node: 1})

    def times(self, a: Monomial, b: Monomial, sign: int = 1) -> Monomial:
        """a b, or a/b."""
        constant = self.expansion.product(a.constant, b.constant if sign > 0 else b.constant.inverse())
        atoms = {x: a.atoms.get(x, 0) + sign * b.atoms.get(x, 0) for x in a.atoms | b.atoms}
        return Monomial(constant.reduced(), a.power + sign * b.power, {x: k for x, k in atoms.items() if k})

    def nonnegative(self, constant: Pair) -> bool:
        """Whether a constant is >= 0 or infinite for all parameters."""
        return -1 not in self.signs(self.expansion.times(*constant))
