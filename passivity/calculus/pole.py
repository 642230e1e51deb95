"""Points near zeros of a part, however near: known by the small value b that the part has there, not by their digits.

Where a part is analytic in a disc and turns around 0 along its edge, on which it is larger than b, it takes the value b
at some point in it, by Rouché's theorem. There exp(-T s)/b is large for any T: b is exact, the rest a ball on the disc.
"""

from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

from flint import acb, arb, ctx

from passivity.ball import of_fraction, of_point
from passivity.budget import bits_of, spend
from passivity.calculus.graph import ONE, Graph, Value
from passivity.calculus.values import Names, in_balls, needed

_ARCS = 32  # of the edge
_SPARE = 128  # bits beyond those of the radius


class Spot(NamedTuple):
    """The point of a disc around s at which a node is j^turn 2^-exponent; z0 + load of the line n for the node ~n."""

    radius: Fraction
    node: int
    exponent: int
    turn: int


def value_at(graph: Graph, value: Value, re: Fraction, im: Fraction, spot: Spot, names: Names) -> acb:
    """A ball with the value there; not finite if it is not shown that there is such a point in Re s > 0."""
    radius, n, exponent, turn = spot
    part = (ONE, n)
    if n < 0:
        z0, _, load = graph.nodes[~n][1]
        part = graph.sum([load, z0])
    bits = _SPARE + 2 * max(map(bits_of, (re, im, radius)))
    spend((len(needed(graph, value[1])) + 2 * _ARCS * len(needed(graph, part[1]))) * (4_000 + 40 * bits), "a pole")
    with ctx.workprec(bits):
        unit, small = of_fraction(radius), acb(0, 1) ** turn * arb(2) ** -exponent
        place = of_point(re, im) + acb(arb(0, unit), arb(0, unit))
        if 0 < radius < re and _turns(graph, part, of_point(re, im), unit, names, abs(small)) > 0:
            return in_balls(graph, [value], place, names, {n: small})[0]
        return acb("nan")


def _turns(graph: Graph, part: Value, centre: acb, unit: arb, names: Names, least: arb) -> int:
    """How often a part turns around 0 along the edge of a disc; 0 if it may not be analytic, or comes below a size."""
    order = needed(graph, part[1])
    cut = [graph.nodes[m][1][0] for m in order if graph.nodes[m][0] in ("sqrt", "log")]
    whole, *inner = in_balls(graph, [part, *cut], centre + acb(arb(0, unit), arb(0, unit)), names)
    if not whole.is_finite() or not all(x.real > 0 or x.imag > 0 or x.imag < 0 for x in inner):  # beside branch cuts
        return 0

    def on_edge(angle: arb) -> acb:
        place = centre + unit * acb(0, angle * arb.pi()).exp()
        return in_balls(graph, [part], place, names, order=order)[0]

    cuts = [arb(2 * k) / _ARCS for k in range(_ARCS + 1)]
    if not all(abs(on_edge(low.union(high))) > least for low, high in pairwise(cuts)):
        return 0
    values = [on_edge(cut) for cut in cuts]
    turned = sum(((after / before).arg() for before, after in pairwise(values)), arb(0)) / (2 * arb.pi())
    return int(turned.unique_fmpz() or 0)
