"""The same function written differently: so that its parts occur once, or that a line and its end stand apart."""

from collections.abc import Iterator
from fractions import Fraction

from passivity.calculus.graph import UNIT, Graph, Value
from passivity.errors import ExpressionError

Rewriting = tuple[bool, Value, list[int]]  # of the inverse instead; the value; nodes that are not looked into


def rewritings(graph: Graph, n: int) -> Iterator[Rewriting]:
    """Other ways to write a node, the promising first."""
    powers = graph.powers(n)
    sums = sorted((b for b in powers if graph.nodes[b][0] == "sum"), reverse=True)
    yield from _cayley(graph, powers, sums)
    yield from _conjugate(graph, n)
    if not graph.moves[n]:
        return
    sums = [b for b in sums if graph.moves[b]]
    yield from _lines(graph, n, sums)
    yield from _spread(graph, powers, sums)


def _conjugate(graph: Graph, n: int) -> Iterator[Rewriting]:
    """a + b, with rational squares, as (a^2 - b^2)/(a - b)."""
    kind, parts = graph.nodes[n]
    if kind == "sum" and len(parts) == 2:
        a, b = parts
        squares = [graph.product([x], [2]) for x in (a, b)]
        difference = graph.sum([squares[0], graph.scaled(squares[1], -1)])
        if difference[0] and all(graph.is_rational[m] for _, m in squares):
            less = graph.sum([a, graph.scaled(b, -1)])
            yield False, graph.product([difference, less], [1, -1]), []


def _cayley(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """c (P + Q)/(P - Q) as c (2/(1 - X) - 1), X = Q/P."""
    for a in sums:
        for b in sums:
            if powers[a] != 1 or powers[b] != -1 or len(powers) != 2:
                continue
            up, down = graph.terms(a), graph.terms(b)
            if up.keys() != down.keys() or any(abs(c) != abs(down[m]) for m, c in up.items()):
                continue
            same, other = (graph.sum((c, m) for m, c in up.items() if c == sign * down[m]) for sign in (1, -1))
            if same[0] and other[0]:
                x = graph.product([other, same], [1, -1])
                one = graph.sum([UNIT, graph.scaled(x, -1)])
                whole = graph.sum([graph.scaled(graph.inverse(one), 2), (Fraction(-1), 0)])
                yield False, whole, _atoms(graph, [same[1], other[1]])


def _spread(graph: Graph, powers: dict[int, int], sums: list[int]) -> Iterator[Rewriting]:
    """A sum above spread over its terms; one below, over the terms of the inverse."""
    for b in sums:
        e = powers[b]
        if e not in (1, -1) or len(powers) == 1:
            continue
        rest = [((Fraction(1), m), e * k) for m, k in powers.items() if m != b]
        terms = [graph.product([term, *(v for v, _ in rest)], [1, *(k for _, k in rest)]) for term in graph.nodes[b][1]]
        yield e < 0, graph.sum(terms), _atoms(graph, [b, *(m for (_, m), _ in rest)], deeper=b)


def _lines(graph: Graph, n: int, sums: list[int]) -> Iterator[Rewriting]:
    """A line with a load Z: w at tanh B = 0 is Z, at tanh B = 1 the characteristic impedance; or 1/w is one."""
    cut = sorted(
        {x for b in sums for m in graph.terms(b) for x in graph.powers(m) if graph.nodes[x][0] in ("sum", "line")}
    )
    for t in _hyperbolic(graph, n, sums):
        kind, parts = graph.nodes[t]
        through = parts[0] if kind == "tanh" else graph.scaled(parts[0], Fraction(-1, 2))
        for upside_down in (False, True):
            try:
                whole = graph.inverse((Fraction(1), n))[1] if upside_down else n
                load, z0 = (graph.replaced(whole, t, (Fraction(int(x == (kind == "tanh"))), 0)) for x in (0, 1))
            except ExpressionError:  # no load, or none that is not infinite
                continue
            lossy = any(graph.nodes[b][0] == "sqrt" for b in graph.powers(z0[1]))
            if through[0] > 0 and z0[0] > 0 and load[0] >= 0 and (lossy or not graph.moves[z0[1]]):
                yield upside_down, (Fraction(1), graph.node("line", (z0, through, load))), cut
                break


def _hyperbolic(graph: Graph, n: int, sums: list[int]) -> list[int]:
    """tanh and exp in the terms of the sums in a product, and tanh in its factors."""
    found = {b for b in graph.powers(n) if graph.nodes[b][0] == "tanh"} if len(graph.powers(n)) > 1 else set()
    for b in sums:
        for m in graph.terms(b):
            found |= {x for x in graph.powers(m) if graph.nodes[x][0] in ("tanh", "exp")}
    return sorted(found, reverse=True)


def _atoms(graph: Graph, nodes: list[int], deeper: int = -1) -> list[int]:
    """Sums within the factors of some nodes, where an equality need not look further."""
    found: set[int] = set()
    for n in nodes:
        for b in graph.powers(n):
            inner = graph.terms(b) if b in (deeper, n) and graph.nodes[b][0] == "sum" else {b: 1}
            found |= {x for m in inner for x in graph.powers(m) if graph.nodes[x][0] in ("sum", "line")}
    return sorted(found - {deeper})
