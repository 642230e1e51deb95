"""Text to graph: an expression, or `let` statements and an expression at the end.

let h2 = (Z2 - z0)/(Z2 + z0); let h1 = exp(-2*T*s)*h2; (1 - h1)/(1 + h1)
"""

import re
from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from functools import lru_cache

from passivity.calculus.graph import Graph, Value
from passivity.errors import ExpressionError, shorten
from passivity.expression.parse import parse
from passivity.expression.tree import Add, Call, Divide, Line, Multiply, Negate, Node, Number, Power, Symbol, symbols

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
