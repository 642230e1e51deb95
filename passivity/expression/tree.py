"""The tree of an impedance expression: its nodes and the names in it."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Number:
    """Exact number: ``0.1`` is 1/10, ``10 nH`` is 1/10**8; `text` is its spelling."""

    value: Fraction
    text: str


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name: the Laplace variable ``s`` or a parameter."""

    name: str


@dataclass(frozen=True, slots=True)
class Negate:
    """Minus the operand."""

    operand: "Node"


@dataclass(frozen=True, slots=True)
class Add:
    """The sum of two or more terms; a subtracted term is a `Negate`."""

    terms: "tuple[Node, ...]"


@dataclass(frozen=True, slots=True)
class Multiply:
    """The product of two or more factors."""

    factors: "tuple[Node, ...]"


@dataclass(frozen=True, slots=True)
class Divide:
    """A quotient; ``a/b*c/d`` is one quotient, a*c over b*d."""

    numerator: "Node"
    denominator: "Node"


@dataclass(frozen=True, slots=True)
class Power:
    """The base to a whole exponent."""

    base: "Node"
    exponent: int


@dataclass(frozen=True, slots=True)
class Call:
    """A function, such as ``exp`` or ``sqrt``, at an argument."""

    name: str
    argument: "Node"


@dataclass(frozen=True, slots=True)
class Line:
    """The input impedance of a line: ``line(z0, gamma, load)``, gamma the propagation along all of it."""

    z0: "Node"
    propagation: "Node"
    load: "Node"


Node: TypeAlias = Number | Symbol | Negate | Add | Multiply | Divide | Power | Call | Line


def nodes(tree: Node) -> Iterator[Node]:
    """A tree and all that is in it."""
    stack = [tree]
    while stack:
        yield (node := stack.pop())
        for name in node.__slots__:
            part = getattr(node, name)
            stack += [x for x in (part if isinstance(part, tuple) else (part,)) if isinstance(x, Node)]


def symbols(node: Node) -> set[str]:
    """All names in a tree, the Laplace variable included.

    Examples
    --------
    >>> sorted(symbols(Add((Symbol("R"), Multiply((Symbol("s"), Symbol("L")))))))
    ['L', 'R', 's']
    """
    return {each.name for each in nodes(node) if isinstance(each, Symbol)}


def is_rational(node: Node) -> bool:
    """Whether no function is in a tree."""
    return not any(isinstance(each, Call | Line) for each in nodes(node))
