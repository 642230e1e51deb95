"""Questions as they are asked: text to graph, whether its value has a property, points where it fails, kept in files.

A text is an expression, or `let` statements and an expression at the end:
let h2 = (Z2 - z0)/(Z2 + z0); let h1 = exp(-2*T*s)*h2; (1 - h1)/(1 + h1)
"""

import re
from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, Self

from passivity.calculus.fact import BOUNDED_REAL, CLAIMS, Fact, in_texts
from passivity.calculus.graph import Graph, Value
from passivity.calculus.values import Spot, at_point, value_at
from passivity.errors import ExpressionError, shorten
from passivity.expression.number import written
from passivity.expression.parse import parse
from passivity.expression.tree import Add, Call, Divide, Line, Multiply, Negate, Node, Number, Power, Symbol, symbols
from passivity.status import Kind
from passivity.verdict import Witness
from passivity.verifier import read_fact

FORMAT = "passivity witness 1"
_LET = re.compile(r"let\s+([^\W\d]\w*)\s*=(.*)", re.DOTALL)


def statements(text: str) -> list[tuple[str, str]]:
    """The names that are defined, each with its text, and at last the expression with the name ''.

    Examples
    --------
    >>> statements("let z = 1 + s; 1/z")
    [('z', ' 1 + s'), ('', '1/z')]
    """
    found, defined = [], set()
    pieces = [piece.strip() for line in text.splitlines() for piece in line.partition("#")[0].split(";")]
    pieces = [piece for piece in pieces if piece]
    for k, piece in enumerate(pieces, 1):
        let = _LET.fullmatch(piece)
        if bool(let) == (k == len(pieces)):
            where = f"statement {k}"
            expected = "let NAME = EXPRESSION in all statements but the last, which is an expression"
            raise ExpressionError(where, "not the right kind of statement", expected, repr(shorten(piece)))
        name = let[1] if let else ""
        if name in defined or name == "s":
            raise ExpressionError(f"statement {k}", f"{name} is defined already", "another name")
        defined.add(name)
        found.append((name, let[2] if let else piece))
    return found or [("", text)]


@lru_cache(maxsize=8)
def trees(text: str) -> tuple[tuple[str, Node], ...]:
    """Return the name and the syntax tree of each statement of a text."""
    found, given = [], statements(text)
    for name, expression in given:
        with _within(name, len(given)):
            found.append((name, parse(expression, lines=True)))
    return tuple(found)


def is_discrete(text: str, known: Container[str]) -> bool:
    """Whether a text is about z, of which nothing is known, in place of s: a function of discrete time."""
    return "z" in free_names(text) and "z" not in known and not any("s" in symbols(tree) for _, tree in trees(text))


def free_names(text: str) -> set[str]:
    """The names in a text that it does not define, without s."""
    found: set[str] = set()
    defined = {"s"}
    for name, tree in trees(text):
        found |= symbols(tree) - defined
        defined.add(name)
    return found


@contextmanager
def _within(name: str, count: int) -> Iterator[None]:
    """Say in which of several statements a mistake is."""
    try:
        yield
    except ExpressionError as error:
        raise (error if count == 1 else error.within(f"let {name}" if name else "the last expression")) from error


def read(graph: Graph, text: str, values: Mapping[str, Fraction] | None = None) -> Value:
    """Return the value of a text, in a graph that knows the assumptions on its names.

    Parameters
    ----------
    graph : Graph
    text : str
        As `statements` reads it; each expression as `passivity.expression.parse.parse` does.
    values : mapping of str to Fraction, optional
        Numbers for names.

    Raises
    ------
    ExpressionError
        For any other text, for a name without value and assumption, and for a division by zero.
    """
    known: dict[str, Value] = {name: (x, 0) for name, x in (values or {}).items()}
    known |= {name: graph.name(name) for name in graph.names}
    known["s"] = graph.s
    value, given = graph.s, trees(text)
    for name, tree in given:
        with _within(name, len(given)):
            value = _Reader(graph, known).value(tree)
        if name:
            known[name] = value
    return value


class _Reader:
    """Evaluation of trees in a graph."""

    def __init__(self, graph: Graph, known: Mapping[str, Value]):
        self.graph, self.known = graph, known

    def value(self, node: Node) -> Value:
        """The value of a tree."""
        graph = self.graph
        match node:
            case Number(value, _):
                return value, 0
            case Symbol(name):
                if name not in self.known:
                    raise ExpressionError(
                        f"parameter {name:.60}", "no value and no assumption", f"such as {name:.60} > 0"
                    )
                return self.known[name]
            case Negate(operand):
                return graph.scaled(self.value(operand), -1)
            case Add(terms):
                return graph.sum(map(self.value, terms))
            case Multiply(factors):
                return graph.product(map(self.value, factors))
            case Divide(above, below):
                return graph.product([self.value(above), self.value(below)], [1, -1])
            case Power(base, e):
                return graph.product([self.value(base)], [e])
            case Call(name, argument):
                return graph.function(name, self.value(argument))
            case Line(z0, propagation, load):
                return graph.line(self.value(z0), self.value(propagation), self.value(load))
        raise AssertionError(node)


@dataclass(frozen=True)
class Question:
    """Whether a value has a property, as it was asked."""

    graph: Graph
    value: Value
    claim: Fact  # the property
    text: str  # from which the value was read
    numbers: Mapping[str, Fraction]  # of names in the text that the graph does not have

    @classmethod
    def of(cls, kind: Kind, text: str, numbers: Mapping[str, Fraction], names: Mapping[str, Fact]) -> Self:
        """Make the question about a text, with values of some names and assumptions on the others."""
        graph = Graph(dict(names))
        return cls(graph, read(graph, text, numbers), CLAIMS[kind], text, numbers)

    @property
    def kind(self) -> Kind:
        """Which property."""
        return Kind.BR if self.claim == BOUNDED_REAL else Kind.PR

    def fails(
        self, re: Fraction, im: Fraction, values: Mapping[str, Fraction], spot: Spot | None = None
    ) -> Witness | None:
        """The point, or that of a disc around it, as a witness, if balls show that the property fails there."""
        if re <= 0:
            return None
        if spot:
            found = value_at(self.graph, self.value, re, im, spot, values)
        else:
            found = at_point(self.graph, self.value, re, im, values)
        wrong = found.real < 0 if self.kind is Kind.PR else abs(found) > 1
        unreal = not im and not spot and (found.imag > 0 or found.imag < 0)
        shown = found.is_finite() and (wrong or unreal)
        return Witness(self.kind, re, im, found, names=dict(values), spot=spot) if shown else None

    def file(self, witness: Witness) -> dict[str, Any] | None:
        """Return the contents of a file for `check_file`, if balls show that a point is a witness."""
        found = self.fails(witness.re, witness.im, witness.names, witness.spot)
        return found and {
            "format": FORMAT,
            "text": self.text,
            "claim": in_texts(self.claim),
            "names": {name: in_texts(fact) for name, fact in self.graph.names.items()},
            "numbers": {name: written(x) for name, x in self.numbers.items()},
            "values": {name: written(x) for name, x in witness.names.items() if name in self.graph.names},
            "s": [written(witness.re), written(witness.im)],
            "value": found.found.str(20, radius=False),
            "spot": found.spot and [written(found.spot.radius), *found.spot[1:]],
        }


def check_file(witness: dict[str, Any]) -> str | None:
    """Return None if a witness, as read from its file, shows that its text lacks the property; else the fault found."""
    try:
        need = witness["format"] == FORMAT and witness["claim"] in map(in_texts, CLAIMS.values())
        names: dict[str, Fact] = {name: read_fact(fact) for name, fact in witness["names"].items()}
        numbers = {name: Fraction(x) for name, x in witness["numbers"].items()}
        kind = Kind.BR if read_fact(witness["claim"]) == BOUNDED_REAL else Kind.PR
        question = Question.of(kind, witness["text"], numbers, names)
        values = {name: Fraction(x) for name, x in witness["values"].items()}
        (re, im), told = map(Fraction, witness["s"]), witness.get("spot")
        spot = told and Spot(Fraction(told[0]), *map(int, told[1:]))
        allowed = all(_allows(names[name], x) for name, x in values.items())
        shown = need and allowed and question.fails(re, im, values, spot) is not None
        return None if shown else "balls do not show that the claim fails there"
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        return f"not a witness: {error}"


def _allows(fact: Fact, x: Fraction) -> bool:
    """Return whether a constant satisfies the assumption on a parameter or a function."""
    kind, low, high = fact
    return low <= x <= high and (kind in ("real", "disc"))
