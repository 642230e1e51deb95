"""A graph of functions of s in which equal nodes are one node: constants, names, sums, products, functions, lines.

A value is a pair (c, n), c times node n. Sums are flat and begin with the coefficient 1, products are flat and have no
coefficient, factors common to all terms of a sum stand before it; so (a - b) and (b - a) are multiples of one node.
"""

from collections.abc import Iterable
from fractions import Fraction
from typing import Any, TypeAlias

from passivity.budget import MAX_BITS, bits_of, check_size, spend
from passivity.calculus.fact import Fact
from passivity.errors import ExpressionError
from passivity.expression.number import square_root
from passivity.verifier import Graph as Nodes

Value: TypeAlias = tuple[Fraction, int]

ZERO: Value = (Fraction(0), 0)
ONE = Fraction(1)
UNIT: Value = (ONE, 0)


class Graph(Nodes):
    """Nodes that are made once each, in the order in which they are needed.

    Parameters
    ----------
    names : mapping of str to fact
        Assumption on each name: ``("real", low, high)`` of a parameter, ``("disc", low, high)`` of a function.

    Examples
    --------
    >>> graph = Graph({"Z2": ("disc", Fraction(0), float("inf"))})
    >>> z = graph.name("Z2")
    >>> graph.sum([z, graph.scaled(z, 2)])
    (Fraction(3, 1), 1)
    """

    def __init__(self, names: dict[str, Fact] | None = None):
        super().__init__(dict(names or {}))
        self._number: dict[tuple, int] = {("one", ()): 0}
        self._products: dict[tuple, Value] = {}
        self.moves, self.is_rational = [False], [True]  # whether s or an opaque function occurs; nothing but s does
        self._fractions: tuple[Iterable[int], dict[int, Any]] = [], {}  # known quotients, for the nodes that were cut

    @classmethod
    def of(cls, nodes: Nodes) -> "Graph":
        """The graph of the nodes of a file, with their numbers; ValueError if one of them is there twice."""
        graph = nodes if isinstance(nodes, Graph) else cls(nodes.names)
        if any(graph.node(*node) != k for k, node in enumerate(nodes.nodes) if graph is not nodes):
            raise ValueError("a node that is there twice")
        return graph

    def node(self, kind: str, parts: tuple) -> int:
        """The number of a node, which is made if it is new."""
        found = self._number.setdefault((kind, parts), len(self.nodes))  # fractions are slow to hash
        if found == len(self.nodes):
            self.nodes.append((kind, parts))
            ids = self.inner(found)
            opaque = kind == "name" and self.names[parts[0]][0] != "real"
            self.moves.append(kind == "s" or opaque or any(self.moves[n] for n in ids))
            plain = kind in ("s", "sum", "mul")
            self.is_rational.append(plain and all(self.is_rational[n] for n in ids))
        return found

    def inner(self, n: int) -> list[int]:
        """The nodes that a node is made of."""
        kind, parts = self.nodes[n]
        if kind == "mul":
            return [m for m, _ in parts]
        return [m for _, m in parts] if kind not in ("one", "s", "name") else []

    @property
    def s(self) -> Value:
        """The Laplace variable."""
        return ONE, self.node("s", ())

    def name(self, name: str) -> Value:
        """A parameter or an opaque function of `names`."""
        return ONE, self.node("name", (name,))

    def scaled(self, value: Value, c: Fraction | int) -> Value:
        """A multiple."""
        return (_checked(value[0] * c), value[1] if c else 0) if c != 1 else value

    def sum(self, values: Iterable[Value]) -> Value:
        """The sum of some values."""
        terms: dict[int, Fraction] = {}
        for c, n in values:
            kind, parts = self.nodes[n]
            if kind != "sum":
                parts = ((ONE, n),)
            for x, m in parts if c == 1 else ((c * x, m) for x, m in parts):
                terms[m] = terms[m] + x if m in terms else x
        terms = {n: _checked(c) for n, c in terms.items() if c}
        if len(terms) < 2:
            return next(((c, n) for n, c in terms.items()), ZERO)
        common = self._common(list(terms))
        if common:
            below = {b: -e for b, e in common.items()}
            inner = self.sum((c * x, m) for n, c in terms.items() for x, m in [self._product(self.powers(n), below)])
            return self.product([inner, self._product(common, {})])
        order = sorted(terms)
        first = terms[order[0]]
        if first == 1:
            return ONE, self.node("sum", tuple((terms[n], n) for n in order))
        return first, self.node("sum", tuple((terms[n] / first, n) for n in order))

    def _common(self, nodes: list[int]) -> dict[int, int]:
        """The powers that all products have in common."""
        found = self.powers(nodes[0])
        for n in nodes[1:]:
            if not found:
                break
            own = self.powers(n)
            found = {b: (min if e > 0 else max)(e, own[b]) for b, e in found.items() if own.get(b, 0) * e > 0}
        return {b: e for b, e in found.items() if self.nodes[b][0] != "exp"}

    def product(self, values: Iterable[Value], exponents: Iterable[int] | None = None) -> Value:
        """The product of some values to whole powers.

        Raises
        ------
        ExpressionError
            For a division by zero.
        """
        key = tuple(values), tuple(exponents or ())
        if (found := self._products.get(key)) is None:
            found = self._products[key] = self._powered(*key)
        return found

    def _powered(self, values: tuple[Value, ...], exponents: tuple[int, ...]) -> Value:
        powers: dict[int, int] = {}
        c = ONE
        for (x, n), e in zip(values, exponents, strict=True) if exponents else ((value, 1) for value in values):
            if x is not ONE and x != 1:
                if not x and e < 0:
                    raise ExpressionError("", "division by zero", "a denominator that is not zero everywhere")
                check_size(0, bits_of(x) * abs(e))
                c = _checked(c * (x if e == 1 else x**e))
            for b, k in self.powers(n).items():
                powers[b] = powers.get(b, 0) + k * e
        factor, n = self._product(powers, {}) if c else ZERO
        return (c, n) if factor is ONE or factor == 1 else (_checked(c * factor), n)

    def _product(self, powers: dict[int, int], more: dict[int, int]) -> Value:
        """A product in its one form: one exponential, roots of squares taken."""
        if more:
            powers = {b: powers.get(b, 0) + more.get(b, 0) for b in powers | more}
        arguments, folded = [], []
        for b, e in list(powers.items()):
            kind, parts = self.nodes[b]
            if kind == "exp" and e:
                arguments.append(self.scaled(parts[0], powers.pop(b)))
            elif kind == "sqrt" and abs(e) > 1:
                folded.append((parts[0], int(e / 2)))
                powers[b] -= 2 * int(e / 2)
        kept = {b: e for b, e in powers.items() if e}
        check_size(0, max(map(abs, kept.values()), default=0))
        if len(arguments) > 1 or (arguments and next(iter(arguments))[0] and folded):
            c, n = self.function("exp", self.sum(arguments))
            return self.product(
                [(c, n), self._product(kept, {}), *(v for v, _ in folded)], [1, 1, *(e for _, e in folded)]
            )
        if arguments:
            c, n = self.function("exp", arguments[0])
            kept |= {n: 1} if n else {}
        if folded:
            return self.product([self._product(kept, {}), *(v for v, _ in folded)], [1, *(e for _, e in folded)])
        if len(kept) == 1 and next(iter(kept.values())) == 1:
            return ONE, next(iter(kept))
        return ONE, self.node("mul", tuple(sorted(kept.items()))) if kept else 0

    def opposite(self, n: int) -> int | None:
        """Return the number of the node 1 over a node; None if it is not in the graph yet."""
        powers = {b: -e for b, e in self.powers(n).items()}
        if len(powers) == 1 and 1 in powers.values():
            return next(iter(powers))
        return self._number.get(("mul", tuple(sorted(powers.items()))))

    def inverse(self, value: Value) -> Value:
        """1 over a value."""
        return self.product([value], [-1])

    def function(self, name: str, value: Value) -> Value:
        """A function at a value: exp, log, sqrt, sinh, cosh, tanh, coth, sech, csch.

        Raises
        ------
        ExpressionError
            Where there is no value: log(0), coth(0).
        """
        c, n = value
        if not c and name in ("log", "coth", "csch"):
            raise ExpressionError("", f"{name}(0) has no value", "another argument")
        if name in ("coth", "sech", "csch", "sinh"):
            other = self.function({"sech": "cosh"}.get(name, "tanh"), value)
            if name in ("coth", "sech"):
                return self.inverse(other)
            return self.product([other, self.function("cosh", value)], [1, 1] if name == "sinh" else [-1, -1])
        if not c:
            return UNIT if name in ("exp", "cosh") else ZERO
        if n == 0 and name == "sqrt" and (root := square_root(c)) is not None:
            return root, 0
        if n == 0 and name == "log" and c == 1:
            return ZERO
        sign = -1 if name in ("tanh", "cosh") and c < 0 else 1
        if name in ("tanh", "cosh") and not self.moves[n]:  # by what dies away for x > 0
            once = self.function("exp", (-sign * c, n))
            square = self.product([once], [2])
            plus, minus = self.sum([UNIT, square]), self.sum([UNIT, self.scaled(square, -1)])
            if name == "cosh":
                return self.scaled(self.product([plus, once], [1, -1]), Fraction(1, 2))
            return self.scaled(self.product([minus, plus], [1, -1]), sign)
        return Fraction(sign if name == "tanh" else 1), self.node(name, ((sign * c, n),))

    def line(self, z0: Value, propagation: Value, load: Value) -> Value:
        """Input impedance of a line: characteristic impedance, propagation times length (T s if lossless), load."""
        if not propagation[0] or load == self.scaled(z0, -1):  # which passes through any line
            return load
        if not z0[0] and load[0]:
            return ZERO
        return ONE, self.node("line", (z0, propagation, load))

    def fraction(self, c: Fraction, n: int, cut: Iterable[int] = ()) -> Any:
        """Multiply out a node as the verifier does; a node that occurs twice in an equality is multiplied out once."""
        if cut != self._fractions[0]:
            self._fractions = cut, {}
        known = self._fractions[1]
        if n not in known:
            known[n] = super().fraction(ONE, n, cut)
        top, bottom = known[n]
        return top if c == 1 else {key: x * c for key, x in top.items() if c}, bottom

    def multiplied(self, f: dict, g: dict) -> dict:
        """The product of two polynomials in atoms, if it is affordable."""
        if len(f) == 1 or len(g) == 1:
            return super().multiplied(f, g)
        longest = max(map(len, f), default=0) + max(map(len, g), default=0)
        spend((5_000 + 2_000 * longest) * len(f) * len(g), "an equality")
        return super().multiplied(f, g)

    def share(self, other: "Graph") -> None:
        """Begin with the nodes of another graph."""
        self.nodes, self.moves, self.is_rational = list(other.nodes), list(other.moves), list(other.is_rational)
        self._number, self.roots = dict(other._number), dict(other.roots)


def _checked(c: Fraction) -> Fraction:
    if c.denominator.bit_length() > MAX_BITS or c.numerator.bit_length() > MAX_BITS:
        check_size(0, bits_of(c))
    return c
