"""Functions multiplied out: quotients (p : q) of polynomials in s, in parameters, and in exponentials and other atoms.

exp of a sum is a product of powers of exp(-unit w), one for each term w that occurs; a function neither rational nor
made of exponentials is an atom of its own. Equal quotients are equal functions; the converse is not claimed.
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import reduce
from math import gcd
from typing import NamedTuple

from flint import fmpz_mpoly

from passivity.budget import UndecidedError, bits_of, spend
from passivity.calculus.graph import Graph, Value
from passivity.calculus.values import needed
from passivity.symbolic.assumption import Range
from passivity.symbolic.domain import Domain

MAX_PARAMETERS = 40
MAX_TERMS = 20_000  # of one polynomial
MAX_DEGREE = 400  # in s or any parameter
MAX_UNITS = 2_000  # of a delay, in its largest common measure with the others
MAX_BITS = 10_000  # of one coefficient
MAX_WORK = 3_000_000  # products of terms in one expression
_MAX_DEPTH = 150  # of parts within parts
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
        spend(20_000 + 300 * len(self.p) * len(self.q) * words, "a common factor")
        common = self.p.gcd(self.q)
        return Pair(self.p / common, self.q / common)


class Expansion:
    """Turns the nodes that a root is made of into pairs, until all together they are too large.

    Parameters
    ----------
    graph : Graph
    root : int
        A node; only the nodes it is made of can be multiplied out.
    ranges : iterable of Range
        Of the parameters.

    Examples
    --------
    >>> graph = Graph()
    >>> c, n = graph.function("tanh", graph.s)
    >>> Expansion(graph, n).of((c, n))
    Pair(p=-exp(0) + 1, q=exp(0) + 1)
    """

    def __init__(self, graph: Graph, root: int, ranges: Iterable[Range] = ()):
        self.graph, self.work, ranges = graph, 0, tuple(ranges)
        self.units: dict[int, Fraction] = {}  # of exp(-unit w), by w
        self.atoms: list[int] = []
        self._collect(root, {r.name for r in ranges})
        if _depth(graph, root) > _MAX_DEPTH:
            raise ExpansionError(f"functions of over {_MAX_DEPTH} parts within parts are not expanded")
        self.domain = Domain(ranges, max(len(self.units) + len(self.atoms), 1))
        if len(self.domain.ranges) > MAX_PARAMETERS:
            raise ExpansionError(f"functions of over {MAX_PARAMETERS} parameters are not expanded")
        self.s, *gens = self.domain.context.gens()
        self.one = self.domain.context.constant(1)
        self.of_unit = dict(zip(self.units, gens, strict=False))
        others, gens = gens[len(self.units) :], gens[self.domain.others :]
        self.known: dict[int, Pair] = {n: Pair(x, self.one) for n, x in zip(self.atoms, others, strict=False)}
        self.known |= {graph.s[1]: Pair(self.s, self.one), 0: Pair(self.one, self.one)}
        for r, x in zip(self.domain.ranges, gens, strict=True):
            self.known[graph.name(r.name)[1]] = Pair(x, self.one)

    def _collect(self, root: int, parameters: set[str]) -> None:
        graph, stack, seen = self.graph, [root], set()
        while stack:
            n = stack.pop()
            if n in seen:
                continue
            seen.add(n)
            kind, parts = graph.nodes[n]
            if kind in ("sqrt", "log") or (kind == "name" and parts[0] not in parameters):
                self.atoms.append(n)
            elif kind in ("exp", "cosh", "tanh", "line"):
                c, m = parts[1] if kind == "line" else parts[0]
                for k, x in graph.terms(m, c if kind in ("exp", "cosh") else 2 * c).items():
                    self.units[k] = _common(self.units.get(k, x), x)
                stack += [m for _, m in (parts[0], parts[2])] if kind == "line" else []
            else:
                stack += graph.inner(n)

    def of(self, value: Value) -> Pair:
        """The pair of a value."""
        c, n = value
        p, q = self._node(n)
        if bits_of(c) > MAX_BITS:
            raise ExpansionError(f"a number has over {MAX_BITS} bits")
        return Pair(p * c.numerator, q * c.denominator)

    def _node(self, n: int) -> Pair:
        if n not in self.known:
            kind, parts = self.graph.nodes[n]
            if kind == "sum":
                found = self._sum(self.of(part) for part in parts)
            elif kind == "mul":
                factors: list[Pair] = []
                for m, e in parts:
                    x = self._node(m) if e > 0 else self._node(m).inverse()
                    if abs(e) * max(self._highest(f) for f in x) > MAX_DEGREE:
                        raise ExpansionError(f"the expanded function has a degree over {MAX_DEGREE}")
                    left = abs(e)
                    while left and _cancel(factors, x):
                        left -= 1
                    factors += [x] * left
                found = reduce(self.product, factors, Pair(self.one, self.one))
            elif kind == "line":
                found = self._line(self.of(parts[0]), self.of(parts[2]), self.wave(parts[1], 2))
            else:
                found = self._function(kind, parts[0])
            self.known[n] = found
        return self.known[n]

    def _function(self, kind: str, argument: Value) -> Pair:
        """exp, tanh and cosh by exponentials that die away."""
        if kind == "exp":
            return self.wave(argument, -1)
        y = self.wave(argument, 2 if kind == "tanh" else 1)
        if kind == "tanh":
            return Pair(y.q - y.p, y.q + y.p)
        return Pair(self.times(y.p, y.p) + self.times(y.q, y.q), 2 * self.times(y.p, y.q))

    def _line(self, z0: Pair, load: Pair, wave: Pair) -> Pair:
        up, down = wave.q + wave.p, wave.q - wave.p
        a, b = self.product(load, z0.inverse())
        over = self.times(a, up) + self.times(b, down)
        return self.product(z0, Pair(over, self.times(b, up) + self.times(a, down)))

    def wave(self, argument: Value, times: int) -> Pair:
        """exp(-times w)."""
        found = Pair(self.one, self.one)
        for m, x in self.graph.terms(argument[1], argument[0]).items():
            k = int(times * x / self.units[m])
            if abs(k) > MAX_UNITS:
                raise ExpansionError(f"the longest delay is over {MAX_UNITS} times their common measure")
            one = Pair(self.of_unit[m] ** abs(k), self.one)
            found = self.product(found, one if k > 0 else one.inverse())
        return found

    def product(self, a: Pair, b: Pair) -> Pair:
        """a b."""
        return Pair(self.times(a.p, b.p), self.times(a.q, b.q))

    def _sum(self, pairs: Iterable[Pair]) -> Pair:
        total = Pair(0 * self.one, self.one)
        for a in pairs:
            if a.q == total.q:
                total = Pair(total.p + a.p, a.q)
            else:
                over = self.times(total.p, a.q) + self.times(a.p, total.q)
                total = Pair(over, self.times(total.q, a.q))
        return total

    def times(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
        """f g, if it is not too large."""
        size = len(f) * len(g)
        self.work += size
        if self.work > MAX_WORK or size > 100 * MAX_TERMS:
            raise ExpansionError(f"to expand the function takes over {MAX_WORK} products")
        spend(2_000 + 1_500 * (len(f) + len(g)) + size * (50 + (bits(f) + bits(g)) // 8), "the expansion")
        found = self.without_squares(f * g)
        if len(found) > MAX_TERMS or bits(found) > MAX_BITS or self._highest(found) > MAX_DEGREE:
            limits = f"{MAX_TERMS} terms, or numbers of over {MAX_BITS} bits, or a degree over {MAX_DEGREE}"
            raise ExpansionError(f"the expanded function has over {limits}")
        return found

    def _highest(self, f: fmpz_mpoly) -> int:
        """The highest power of s or a parameter."""
        degrees = f.degrees()
        return max(degrees[:1] + degrees[1 + self.domain.others :])

    def without_squares(self, f: fmpz_mpoly) -> fmpz_mpoly:
        """Replace squares of square roots by their radicands, where these are polynomials."""
        for k, n in enumerate(self.atoms, 1 + len(self.units)):
            kind, parts = self.graph.nodes[n]
            if kind == "sqrt" and f and f.degrees()[k] > 1 and self.graph.is_rational[parts[0][1]]:
                inside = self.of(parts[0])
                if inside.q != 1:
                    continue
                found = 0 * f
                for exponents, c in f.to_dict().items():
                    e = int(exponents[k])
                    rest = f.context().from_dict({(*exponents[:k], e % 2, *exponents[k + 1 :]): c})
                    found += rest * inside.p ** (e // 2)
                f = found
        return f

    def generator(self, k: int) -> Value:
        """Return the function represented by a generator after s, parameters not counted."""
        if k < len(self.units):
            m, unit = list(self.units.items())[k]
            return self.graph.function("exp", (-unit, m))
        return Fraction(1), self.atoms[k - len(self.units)]

    def delay(self, k: int) -> Value | None:
        """T of a generator exp(-T s), T free of s; None if it is no such."""
        if k >= len(self.units):
            return None
        m, unit = list(self.units.items())[k]
        found = self.graph.product([(unit, m), self.graph.s], [1, -1])
        return None if self.graph.moves[found[1]] else found


def _cancel(factors: list[Pair], x: Pair) -> bool:
    """Multiply a pair into the first factor with which it cancels, denominator by numerator; return if there is one."""
    spend(300 * len(factors), "the expansion")
    for k, y in enumerate(factors):
        for a, b in ((x, y), (y, x)):
            if len(a.q) == len(b.p) > 1:
                c, d = a.q.leading_coefficient(), b.p.leading_coefficient()
                if a.q * d == b.p * c:
                    factors[k] = Pair(a.p * d, b.q * c)
                    return True
    return False


def _depth(graph: Graph, root: int) -> int:
    depth = {0: 0}
    for n in needed(graph, root):
        depth[n] = 1 + max((depth[m] for m in graph.inner(n)), default=0)
    return depth[root]


def bits(f: fmpz_mpoly) -> int:
    """Length of the longest coefficient."""
    return max((abs(int(c)).bit_length() for c in f.coeffs()), default=0)


def _common(a: Fraction, b: Fraction) -> Fraction:
    """The largest number that both are whole multiples of."""
    return Fraction(gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator)
