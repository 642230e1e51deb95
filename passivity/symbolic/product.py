"""A function as a product of a constant, a power of s, sums and functions; which products are Cayley transforms."""

from collections.abc import Iterator
from dataclasses import dataclass

from passivity.expression.tree import Add, Negate, Node
from passivity.symbolic import write
from passivity.symbolic.expand import Pair

_SHOWN = 60  # characters of a function in a claim


@dataclass(frozen=True)
class Monomial:
    """c s^power times powers of sums and functions; c is free of s."""

    constant: Pair
    power: int
    atoms: dict[Node, int]

    def __str__(self) -> str:
        p, q = self.constant
        over = [write.factor(p)] if str(p) != "1" else []
        under = [write.factor(q)] if str(q) != "1" else []
        for name, k in [("s", self.power), *((write.atom(x), k) for x, k in self.atoms.items())]:
            if k:
                (over if k > 0 else under).append(name if abs(k) == 1 else f"{name}^{abs(k)}")
        text = "*".join(over) or "1"
        below = "*".join(under)
        if under:
            text += f"/{below}" if len(under) == 1 and ("*" not in below or below.startswith("(")) else f"/({below})"
        return write.cut(text, _SHOWN)


def pairs(atoms: dict[Node, int]) -> Iterator[tuple[Node, Node]]:
    """A factor above and one below the line."""
    for above, k in atoms.items():
        for below, n in atoms.items():
            if k > 0 > n:
                yield above, below


def cayley(atoms: dict[Node, int]) -> Iterator[tuple[Node, Node]]:
    """a and b if the product is (a - b)/(a + b): its two sums differ only in the signs of terms."""
    for above, below in pairs(atoms):
        if not (isinstance(above, Add) and isinstance(below, Add) and set(atoms.values()) == {1, -1}):
            continue
        signs = {_unsigned(t): _sign(t) for t in above.terms}
        if len(signs) == len(above.terms) == len(below.terms) and signs.keys() == set(map(_unsigned, below.terms)):
            same = tuple(t for t in below.terms if signs[_unsigned(t)] == _sign(t))
            other = tuple(t for t in below.terms if signs[_unsigned(t)] != _sign(t))
            if same and other:
                yield _sum(same), _sum(other)


def _sum(terms: tuple[Node, ...]) -> Node:
    return terms[0] if len(terms) == 1 else Add(terms)


def _unsigned(term: Node) -> Node:
    return term.operand if isinstance(term, Negate) else term


def _sign(term: Node) -> int:
    return -1 if isinstance(term, Negate) else 1
