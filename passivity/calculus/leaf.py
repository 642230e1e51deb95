"""Facts that the exact test proves of a rational node: discs with its values, and bounds of its argument."""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from flint import fmpz_poly

from passivity.budget import UndecidedError
from passivity.calculus.expand import Expansion
from passivity.calculus.fact import BOUNDED_REAL, POSITIVE_REAL, Fact
from passivity.calculus.graph import ONE, Graph
from passivity.calculus.values import needed
from passivity.errors import ExpressionError
from passivity.exact.margin import Margin, margins
from passivity.expression.number import written
from passivity.polynomial.roots import routh_column
from passivity.polynomial.sign import allowance, find_sign
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.verdict import Verdict

MAX_DEGREE = 16  # above, only Re >= 0 and modulus <= 1 are tried
_LONGEST = 150_000_000_000_000  # degree^4 bits^2 of what the verifier brings into Routh's scheme in some ten seconds

_S = RationalFunction(fmpz_poly([0, 1]), fmpz_poly([1]))


def rational_facts(graph: Graph, n: int, sharp: bool = True) -> Iterator[tuple[Fact, dict[str, Any]]]:
    """Facts, the sharpest discs where found and wanted, each with the data that the rule `rational` asks for."""
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
    """Convert a node that is rational in s to a RationalFunction."""
    known = {0: RationalFunction.constant(Fraction(1))}
    for k in needed(graph, n):
        kind, parts = graph.nodes[k]
        known[k] = _S if kind == "s" else _combined(kind, parts, known)
    return known[n]


def _combined(kind: str, parts: tuple, known: dict[int, RationalFunction]) -> RationalFunction:
    total = RationalFunction.constant(Fraction(1 if kind != "sum" else 0))
    for x, m in parts:
        total = total + known[m] * x if kind == "sum" else total * known[x] ** m
    return total.reduced()


def wave_facts(graph: Graph, n: int) -> Iterator[tuple[Fact, dict[str, Any]]]:
    """Facts about a node that `in_waves` finds rational, each with the data that the rule `rational` asks for."""
    if found := in_waves(graph, n):
        for disc in (POSITIVE_REAL, ("disc", -math.inf, Fraction(0)), BOUNDED_REAL):
            if data := _proof(_moved(found[1], disc)):
                yield disc, data | {"unit": written(found[0])}


def in_waves(graph: Graph, n: int) -> tuple[Fraction, RationalFunction] | None:
    """A node that is rational in y = exp(-T s), as lines of commensurate delays are: T, and it of (1 - y)/(1 + y)."""
    try:
        expansion = Expansion(graph, n)
        pair = None if expansion.atoms or [*expansion.units] != [graph.s[1]] else expansion.of((ONE, n)).reduced()
    except UndecidedError:
        return None
    if pair is None or any(f.degrees()[0] for f in pair):
        return None
    both = [fmpz_poly([int(f[0, k]) for k in range(int(f.degrees()[1]) + 1)]) for f in pair]
    found = RationalFunction(*both)
    return (expansion.units[graph.s[1]], found.bilinear(-1)) if found.degree else None


def _proof(z: RationalFunction) -> dict[str, Any] | None:
    """The exact test's proof that a function is positive real; no witness if it is not, for that takes longer."""
    r = z.reduced()
    if r.degree**4 * r.bits**2 > _LONGEST:
        return None
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
    """Return the function that must be positive real for the values of r to lie in a disc that is not a point."""
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
    """Return the lower or upper end of a margin's enclosure; None if it is infinite or there is no margin."""
    end = math.inf if margin is None else margin.high if upper else margin.low
    return None if end in (math.inf, -math.inf) else Fraction(end)
