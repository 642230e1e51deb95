"""Proofs in ball arithmetic for functions that are rational in s and in delays, where the property holds strictly.

Z = a0 s + 1/(a1 s + 1/(... + 1/(ak s + Z1))), where Z1 has the value A > 0 for s to infinity without its delays. Then
X = (Z1 - A)/(Z1 + A) = n/d is analytic with |X| < 1 in Re s > 0, and so Z is positive real, if |n| < |d|

  - far out, |s| >= R, where the delays may be any numbers in the unit disc; where all are multiples of one, for
    powers of one number z, and the least |D| - |N| of the leading parts is found on |z| = 1,
  - on the pieces of the axis up to R, each in a ball; at 0 |n| = |d| will do, as where Z has a pole or a zero there, if
    |d|^2 - |n|^2, which is even in w, has a second derivative above 0 on the first piece,

and d does not turn around zero along the half disc of radius R: then it has no zero in it, and |X| is
largest on the edge.

Such a proof is a step of the rule `balls`, with the radius and the cuts; `passivity.verifier` does not know it.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

from flint import acb, arb, arb_poly, ctx, fmpz_mpoly

from passivity.ball import of_fraction, of_point
from passivity.budget import UndecidedError
from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.calculus.fact import CLAIMS, Fact
from passivity.calculus.graph import Graph, Value
from passivity.calculus.values import in_ball, needed
from passivity.delayed.roots import (
    BITS,
    QuasiPolynomial,
    cuts_of_axis,
    least_difference,
    least_radius,
    on_axis,
    pieces,
    winding,
)
from passivity.errors import ExpressionError
from passivity.expression.number import written
from passivity.status import Kind
from passivity.verifier import Graph as Nodes, scaled

_PLACES = ((Fraction(37, 29), Fraction(17, 23)), (Fraction(5, 3), Fraction(0)), (Fraction(1, 7), Fraction(9, 11)))
_DIGITS = 4096  # binary, of the comparison: enough for a term of 1e-400 and its square
_MAX_POLES = 4  # at infinity, split off one after the other
_NO_VALUE = "no positive value far out, where delays have died away"


class UnresolvedError(UndecidedError):
    """Question that balls did not resolve; `frequency`: place on the axis that is not clear."""

    frequency: float | None = None


def prove_in_balls(kind: Kind, graph: Graph, value: Value) -> dict[str, Any]:
    """Prove that a value has the property strictly; return the data of a step about its node, or UnresolvedError."""
    with ctx.workprec(BITS):
        x = reflection(kind, graph, value)
        room = least_difference(x.n, x.d)
        radius = least_radius(lambda r: _is_small_far_out(x.n, x.d, r, room))
        if radius is None:
            raise UnresolvedError("no room left far out: |H| comes to 1, or Re Z to 0, for s to infinity")
        cuts = cuts_of_axis(_Axis(x.n, x.d).is_clear, radius, partial(_room, x.n, x.d))
    told = {"kind": kind.name, "factor": written(value[0])}
    return told | {"radius": written(radius), "cuts": [written(cut) for cut in cuts]}


def holds(kind: Kind, graph: Graph, value: Value, radius: Fraction, cuts: list[Fraction]) -> bool:
    """Whether the radius and the cuts of a proof make one, of a reflection that leads back to the function."""
    if not cuts or cuts[0] != 0 or cuts[-1] != radius or sorted(set(cuts)) != cuts:
        return False
    try:
        with ctx.workprec(2 * BITS):
            x = reflection(kind, graph, value)
            small = _is_small_far_out(x.n, x.d, radius, least_difference(x.n, x.d)) and all(
                map(_Axis(x.n, x.d).is_clear, pieces(cuts))
            )
            if not small or winding(x.d, radius, cuts):
                return False
        with ctx.workprec(_DIGITS):
            x = reflection(kind, graph, value)
            points = [of_point(re * r, im * r) for re, im in _PLACES for r in (radius, radius / 2**20)]
            pairs = [(x.given(kind, s), in_ball(graph, value, s)) for s in points]
            known = [(a, b) for a, b in pairs if a.is_finite() and b.is_finite()]
            return bool(known) and all(a.overlaps(b) for a, b in known)
    except (UndecidedError, ExpressionError):
        return False


def rule_balls(nodes: Nodes, n: int, known: list[Any], data: dict[str, Any]) -> list[Fact]:
    """c times a node without names is positive or bounded real: the radius and the cuts make a proof in balls."""
    graph = Graph.of(nodes)
    if any(graph.nodes[m][0] == "name" for m in needed(graph, n)):
        raise ValueError("a function with names")
    kind, c, cuts = Kind[data["kind"]], Fraction(data["factor"]), [Fraction(x) for x in data["cuts"]]
    fact = scaled(CLAIMS[kind], 1 / c) if holds(kind, graph, (c, n), Fraction(data["radius"]), cuts) else None
    return [fact] if fact else []


def _is_small_far_out(n: QuasiPolynomial, d: QuasiPolynomial, radius: Fraction, room: arb | None) -> bool:
    leading, rest = d.far(radius, d.degree)
    other, more = n.far(radius, d.degree)
    if room is not None:  # what is less than the highest power is less than the difference of the leading parts
        beside = sum((abs(c) for f in (n, d) if f.degree == d.degree for c in f.leading()[1:]), arb(0))
        return bool(more + rest - beside < room)
    return n.degree <= d.degree and bool(abs(other) + more < abs(leading) - rest)


class _Axis:
    """Comparison of |n| with |d| on pieces of the axis, and at 0."""

    def __init__(self, n: QuasiPolynomial, d: QuasiPolynomial):
        self.each = tuple((f, f.derivative(), f.derivative().derivative()) for f in (n, d))
        at_0, whole = (f(acb(0)).real for f in (n, d))
        self.touches = at_0 * at_0 == whole * whole and whole != 0  # which balls say of exact numbers alone

    def is_clear(self, s: acb) -> bool:
        """Whether |n| < |d| on a piece of the axis, except at 0."""
        (n, *_), (d, *_) = self.each
        if abs(n(s)) < abs(d(s)):
            return True
        if not (self.touches and s.contains(0)):
            return False
        bent = ((f(s), first(s), second(s)) for f, first, second in self.each)
        less, more = (first * first.conjugate() - (f.conjugate() * second) for f, first, second in bent)
        return bool(more.real > less.real)


def _room(n: QuasiPolynomial, d: QuasiPolynomial, low: Fraction, high: Fraction) -> UnresolvedError:
    room = 1 - abs(n(on_axis(low, high))) / abs(d(on_axis(low, high)))
    error = UnresolvedError(
        f"for ω from {float(low):.6g} to {float(high):.6g} the room 1 - |X(jω)|, X = (Z - A)/(Z + A), "
        f"is only known to lie between {float(room.lower()):.3g} and {float(room.upper()):.3g}"
    )
    error.frequency = float((low + high) / 2)
    return error


@dataclass(frozen=True)
class Reflection:
    """X = n/d, the slopes a0 ... ak and A."""

    n: QuasiPolynomial
    d: QuasiPolynomial
    slopes: tuple[Fraction, ...]
    far: Fraction

    def given(self, kind: Kind, s: acb) -> acb:
        """The function that was given, Z or H = (Z - 1)/(Z + 1), back from X at a point."""
        x = self.n(s) / self.d(s)
        z = (1 + x) / (1 - x) * of_fraction(self.far) + s * of_fraction(self.slopes[-1])
        for slope in self.slopes[-2::-1]:
            z = s * of_fraction(slope) + 1 / z
        return z if kind is Kind.PR else (z - 1) / (z + 1)


def reflection(kind: Kind, graph: Graph, value: Value) -> Reflection:
    """X of an impedance, or of the impedance (1 + H)/(1 - H), at the present precision; or UnresolvedError."""
    expansion = Expansion(graph, value[1])
    try:
        z = expansion.of(value).reduced()
        if kind is Kind.BR:
            z = Pair(z.q + z.p, z.q - z.p).reduced()
        if not z.q:
            raise UnresolvedError("infinite everywhere")
        z, slopes, a = _without_poles(expansion, z)
        up, down = a.numerator, a.denominator
        both = [expansion.without_squares(z.p * down - z.q * up), expansion.without_squares(z.p * down + z.q * up)]
    except ExpansionError:
        raise UnresolvedError("multiplied out, the function is too large") from None
    used = {k for f in both for k, degree in enumerate(f.degrees()[1:]) if degree}
    meaning = [_meaning(expansion, k) if k in used else (arb(0), arb(1)) for k in range(expansion.domain.others)]
    return Reflection(_quasi(meaning, both[0]), _quasi(meaning, both[1]), slopes, a)


def _without_poles(expansion: Expansion, z: Pair) -> tuple[Pair, tuple[Fraction, ...], Fraction]:
    """Z1, the slopes and A."""
    slopes = [Fraction(0)]
    for _ in range(_MAX_POLES):
        (m, a), (n, b) = _leading(z.p), _leading(z.q)
        if m == n:
            if a * b > 0:
                return z, tuple(slopes), Fraction(a, b)
            break
        if m < n:
            z, m, a, n, b = z.inverse(), n, b, m, a
            slopes.append(Fraction(0))
        if m != n + 1 or a * b < 0:
            break
        slopes[-1] = Fraction(a, b)
        pole = expansion.s * z.q
        z = Pair(z.p * b - pole * a, z.q * b).reduced()
        if not z.p:
            break
    raise UnresolvedError(_NO_VALUE)


def _leading(f: fmpz_mpoly) -> tuple[int, int]:
    """Highest power of s and its coefficient, among the terms without generators."""
    plain = [(int(x[0]), int(c)) for x, c in f.to_dict().items() if not any(x[1:])]
    if not plain:
        raise UnresolvedError(_NO_VALUE)
    return max(plain)


def _meaning(expansion: Expansion, k: int) -> tuple[arb, arb]:
    """T and c of a generator c exp(-T s)."""
    graph, whole = expansion.graph, expansion.generator(k)
    if not graph.moves[whole[1]]:
        return arb(0), _real(graph, whole)
    delay = expansion.delay(k)
    if delay is not None and (t := _real(graph, delay)) > 0:
        return t, arb(1)
    raise UnresolvedError("not rational in s and delays")


def _real(graph: Graph, constant: Value) -> arb:
    """A constant that is known to have no imaginary part."""
    ball = in_ball(graph, constant, acb(1))
    if not (ball.is_finite() and ball.imag == 0):  # not "!= 0", which is only true of balls without 0
        raise UnresolvedError("it has constants that are not known to be real numbers")
    return ball.real


def _quasi(meaning: list[tuple[arb, arb]], f: fmpz_mpoly) -> QuasiPolynomial:
    """A polynomial in s and the generators as one in s for each delay, no delay first."""
    parts: dict[tuple, dict[int, arb]] = {(0,) * len(meaning): {}}
    for x, c in f.to_dict().items():
        key = tuple(int(e) if t > 0 else 0 for e, (t, _) in zip(x[1:], meaning, strict=True))
        coefficient = arb(c)
        for e, (_, factor) in zip(x[1:], meaning, strict=True):
            coefficient *= factor ** int(e)
        powers = parts.setdefault(key, {})
        powers[int(x[0])] = powers.get(int(x[0]), arb(0)) + coefficient
    orders = tuple(map(sum, parts)) if sum(bool(t > 0) for t, _ in meaning) < 2 else ()
    delays = {key: sum((t * e for e, (t, _) in zip(key, meaning, strict=True)), arb(0)) for key in parts}
    return QuasiPolynomial(
        tuple(
            (delays[key], arb_poly([p.get(k, 0) for k in range(max(p, default=-1) + 1)])) for key, p in parts.items()
        ),
        orders,
    )
