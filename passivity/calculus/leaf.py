"""What the exact test proves of a rational node: discs with its values, and bounds of its argument."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from flint import fmpz_poly

from passivity.calculus.graph import Fact, Graph
from passivity.delayed.leaf import leaves
from passivity.rational.function import RationalFunction


def rational_facts(graph: Graph, n: int) -> Iterator[tuple[Fact, dict[str, Any]]]:
    """Facts, each with the data that the rule `rational` asks for."""
    for step in leaves(function_of(graph, n)):
        if c := step.certificate:
            claim = step.claim
            fact = ("arg", claim) if isinstance(claim, Fraction) else ("disc", claim.low, claim.high)
            yield (
                fact,
                {
                    "p": [str(x) for x in c.function.p.coeffs()],
                    "q": [str(x) for x in c.function.q.coeffs()],
                    "factors": [[[str(x) for x in f.coeffs()], e] for f, e in c.sign.factors],
                    "breaks": [str(x) for x in c.sign.breaks],
                },
            )


def function_of(graph: Graph, n: int) -> RationalFunction:
    """A node that is rational in s as such a function."""
    kind, parts = graph.nodes[n]
    if kind == "ratio":
        return RationalFunction(fmpz_poly(list(parts[0])), fmpz_poly(list(parts[1])))
    if kind == "s":
        return RationalFunction(fmpz_poly([0, 1]), fmpz_poly([1]))
    total = RationalFunction.constant(Fraction(1 if kind != "sum" else 0))
    if kind == "sum":
        for c, m in parts:
            total = total + function_of(graph, m) * c
    elif kind == "mul":
        for m, e in parts:
            total = total * function_of(graph, m) ** e
    return total.reduced()
