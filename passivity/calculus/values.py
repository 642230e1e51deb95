"""Values of the nodes of a graph: in balls, or in floats at an array of points.

Points near zeros of a part are known, however near, by the small value b that the part has there, not by their digits.
Where a part is analytic in a disc and turns around 0 along its edge, on which it is larger than b, it takes the value b
at some point in it, by Rouché's theorem. There exp(-T s)/b is large for any T: b is exact, the rest a ball on the disc.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from flint import acb, arb, ctx

from passivity.ball import of_fraction, of_point
from passivity.budget import bits_of, spend
from passivity.calculus.graph import ONE, Graph, Value
from passivity.expression.number import double

Array = Any  # of numpy, which is loaded only when it is needed
Names = Mapping[str, Fraction]

_MOST_BITS = 4096
_ARCS = 32  # of the edge
_SPARE = 128  # bits beyond those of the radius


def needed(graph: Graph, *roots: int, known: Iterable[int] = ()) -> list[int]:
    """List the nodes needed to evaluate `roots`, in order, without 1, known nodes, and those only known ones need."""
    seen: set[int] = set()
    stack = list(roots)
    while stack:
        n = stack.pop()
        if n and n not in seen and n not in known:
            seen.add(n)
            stack += graph.inner(n)
    return sorted(seen)


def in_ball(graph: Graph, value: Value, s: acb, names: Names | None = None) -> acb:
    """A ball with the values at all points of a ball, constants for the names; not finite where it may hold a pole."""
    return in_balls(graph, [value], s, names)[0]


def in_balls(
    graph: Graph,
    values: Sequence[Value],
    s: acb,
    names: Names | None = None,
    known: Mapping[int, acb] | None = None,
    order: list[int] | None = None,
) -> list[acb]:
    """Evaluate several values in balls, common parts once, from nodes known; `order` lists the nodes needed.

    What is known of ~n is z0 + load of the line n.
    """
    numbers = {name: acb(of_fraction(x)) for name, x in (names or {}).items()}
    at = _Evaluation(graph, numbers, s, acb(1), lambda name, x: getattr(x, name)(), of_fraction)
    order = needed(graph, *(n for _, n in values), known=known or ()) if order is None else order
    at.closing = {~n: x for n, x in (known or {}).items() if n < 0}
    return at.values(values, order, known)


def at_point(graph: Graph, value: Value, re: Fraction, im: Fraction, names: Names | None = None) -> acb:
    """Value at a rational point, to 60 certain bits where some thousand bits, or four times its own, give them."""
    bits, size, most = 128, len(needed(graph, value[1])), max(_MOST_BITS, 4 * bits_of(re), 4 * bits_of(im))
    while True:
        # the precision is global to the process: the accuracy found counts, not the one asked for
        spend(size * (4_000 + bits * 40), "a value")
        with ctx.workprec(bits):
            found = in_ball(graph, value, of_point(re, im), names)
        if bits >= most or all(x.rel_accuracy_bits() >= 60 or x == 0 for x in (found.real, found.imag)):
            return found
        bits *= 2


def in_floats(
    graph: Graph, value: Value, s: Array, names: Mapping[str, float], order: list[int] | None = None
) -> Array:
    """Evaluate a value at an array of points, in complex doubles; an overflow gives a number that is not finite."""
    import numpy as np

    order = needed(graph, value[1]) if order is None else order
    spend((1 + len(order)) * (10_000 + 20 * s.size), "a search for a counterexample")
    with np.errstate(all="ignore"):
        known = {name: np.float64(x) for name, x in names.items()}  # 1/0 is infinite
        at = _Evaluation(graph, known, s, np.ones_like(s), lambda name, x: getattr(np, name)(x), double)
        return at.values([value], order)[0] * np.ones_like(s)


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


class _Evaluation:
    """Nodes at one point, or at an array of them, in any arithmetic."""

    def __init__(self, graph: Graph, names: Mapping[str, Any], s: Any, one: Any, function: Callable, exact: Callable):
        self.graph, self.names, self.s, self.one, self.function, self.exact = graph, names, s, one, function, exact
        self.closing: dict[int, Any] = {}  # z0 + load of lines, where it is given

    def values(self, values: Sequence[Value], order: list[int], known: Mapping[int, Any] | None = None) -> list[Any]:
        """Some values, the nodes that they need one after the other."""
        at: dict[int, Any] = {0: self.one, **(known or {})}
        for n in order:
            at[n] = self._node(n, at)
        return [at[n] * self.exact(c) for c, n in values]

    def _node(self, n: int, at: dict[int, Any]) -> Any:
        kind, parts = self.graph.nodes[n]
        exact = self.exact
        if kind == "s":
            return self.s
        if kind == "name":
            return self.names[parts[0]]
        if kind == "sum":
            return sum((at[m] if c == 1 else at[m] * exact(c) for c, m in parts[1:]), at[parts[0][1]])
        if kind == "mul":
            found = self.one
            for m, e in parts:
                found = found * at[m] if e == 1 else found / at[m] if e == -1 else found * at[m] ** e
            return found
        scaled = [at[m] * exact(c) for c, m in parts]
        if kind == "line":
            z0, propagation, load = scaled
            if n in self.closing:  # the wave there and that which comes back, as z0 + load is known better than load
                there = self.closing[n]
                back = self.function("exp", -2 * propagation) * (there - 2 * z0)
                return z0 * (there + back) / (there - back)
            wave = self.function("tanh", propagation)
            return z0 * (load + z0 * wave) / (z0 + load * wave)
        return self.function(kind, scaled[0])
