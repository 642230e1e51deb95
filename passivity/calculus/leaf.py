"""What the exact test proves of a rational node: discs with its values, and bounds of its argument."""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from flint import fmpz_poly

from passivity.budget import UndecidedError
from passivity.calculus.graph import BOUNDED_REAL, POSITIVE_REAL, Fact, Graph
from passivity.calculus.values import needed
from passivity.errors import ExpressionError
from passivity.exact.margin import Margin, margins
from passivity.exact.verdict import Verdict
from passivity.expression.number import written
from passivity.polynomial.roots import routh_column
from passivity.polynomial.sign import allowance, find_sign
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status

MAX_DEGREE = 16  # above, only Re >= 0 and modulus <= 1 are tried

_S = RationalFunction(fmpz_poly([0, 1]), fmpz_poly([1]))


def rational_facts(graph: Graph, n: int, sharp: bool = True) -> Iterator[tuple[Fact, dict[str, Any]]]:
    """Facts, the sharpest discs where found and wanted, each with the data that the rule `rational` asks for.

    Examples
    --------
    >>> graph = Graph()
    >>> n = graph.inverse(graph.sum([graph.s, (Fraction(1), 0)]))[1]
    >>> [tuple(map(str, fact)) for fact, _ in rational_facts(graph, n)][:2]
    [('disc', '0', '1'), ('disc', '0', 'inf')]
    """
    try:
        r = function_of(graph, n)
    except ExpressionError:  # its degree is too high, or its numbers are too long
        return
    for disc in _candidates(r) if sharp else (POSITIVE_REAL, BOUNDED_REAL):
        if data := _proof(_moved(r, disc)):
            yield disc, data
    for turns, candidate in ((1, r), (2, r / _S), (2, r * _S)):
        if not r.is_zero and (data := _proof(candidate)):
            yield ("arg", Fraction(turns)), data
            return


def function_of(graph: Graph, n: int) -> RationalFunction:
    """A node that is rational in s as such a function."""
    known = {0: RationalFunction.constant(Fraction(1))}
    for k in needed(graph, n):
        kind, parts = graph.nodes[k]
        if kind == "s":
            total = _S
        else:
            total = RationalFunction.constant(Fraction(1 if kind != "sum" else 0))
            for x, m in parts:
                total = total + known[m] * x if kind == "sum" else total * known[x] ** m
            total = total.reduced()
        known[k] = total
    return known[n]


def _proof(z: RationalFunction) -> dict[str, Any] | None:
    """The exact test's proof that a function is positive real; no witness if it is not, for that takes longer."""
    r = z.reduced()
    try:
        sign = find_sign(allowance(Kind.PR, r.p, r.q))
    except UndecidedError:
        return None
    if isinstance(sign, Fraction) or routh_column(r.p + r.q) is None:
        return None
    p, q = ([str(x) for x in f.coeffs()] for f in (r.p, r.q))
    factors = [[[str(x) for x in f.coeffs()], e] for f, e in sign.factors]
    return {"p": p, "q": q, "factors": factors, "breaks": [written(x) for x in sign.breaks]}


def _moved(r: RationalFunction, disc: Fact) -> RationalFunction:
    """What must be positive real, for the values of r to lie in a disc that is not a point."""
    _, low, high = disc
    if high == math.inf:
        return r - low
    return high - r if low == -math.inf else (r - low) / (high - r)


def _candidates(r: RationalFunction) -> list[Fact]:
    """The half-planes and discs that the extremes on the axis suggest."""
    if r.degree > MAX_DEGREE:
        return [POSITIVE_REAL, BOUNDED_REAL]
    try:
        low, high = (_end(margins(Verdict(Kind.PR, f, Status.UNDECIDED)).input) for f in (r, -r))
        most = _end(margins(Verdict(Kind.BR, r, Status.UNDECIDED)).reflection, upper=True)
    except UndecidedError:
        return [POSITIVE_REAL, BOUNDED_REAL]
    found: list[Fact] = [("disc", low, -high)] if low is not None and high is not None and low < -high else []
    found += [("disc", low, math.inf)] if low is not None else []
    found += [("disc", -math.inf, -high)] if high is not None else []
    return [*found, *([("disc", -most, most)] if most else [])]


def _end(margin: Margin | None, upper: bool = False) -> Fraction | None:
    """The end of a margin's enclosure that is not passed."""
    end = math.inf if margin is None else margin.high if upper else margin.low
    return None if end in (math.inf, -math.inf) else Fraction(end)
