"""Proofs in ball arithmetic for functions that are rational in s and in delays, where the property holds strictly.

Z = a0 s + 1/(a1 s + 1/(... + 1/(ak s + Z1))), where Z1 has the value A > 0 for s to infinity without its delays. Then
X = (Z1 - A)/(Z1 + A) = n/d is analytic with |X| < 1 in Re s > 0, and so Z is positive real, if |n| < |d|

  - far out, |s| >= R, where the delays stand for any number in the unit disc,
  - on the pieces of the axis up to R, each in a ball,

and d does not turn around zero along the half disc of radius R: then it has no zero in it, and |X| is
largest on the edge.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from typing import Any

from flint import acb, arb, arb_poly, ctx, fmpz_mpoly

from passivity.ball import of_fraction, of_point
from passivity.budget import UndecidedError
from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.calculus.graph import Graph, Value
from passivity.calculus.read import read
from passivity.calculus.values import in_ball
from passivity.delayed.roots import BITS, QuasiPolynomial, cuts_of_axis, least_radius, on_axis, pieces, winding
from passivity.errors import ExpressionError
from passivity.expression.number import written
from passivity.status import Kind

FORMAT = "passivity proof in balls 1"

_PLACES = ((Fraction(37, 29), Fraction(17, 23)), (Fraction(5, 3), Fraction(0)), (Fraction(1, 7), Fraction(9, 11)))
_DIGITS = 4096  # binary, of the comparison: a term of 1e-400 is seen, and so is its square
_MAX_POLES = 4  # at infinity, split off one after the other
_NO_VALUE = "no positive value far out, where delays have died away"


class UnresolvedError(UndecidedError):
    """What could not be resolved in balls; `frequency` where the axis is not clear."""

    frequency: float | None = None


@dataclass(frozen=True)
class BallProof:
    """All that `holds` needs to repeat a proof in balls: the function, the radius R and the cuts of the axis."""

    kind: Kind
    text: str
    numbers: Mapping[str, Fraction]
    radius: Fraction = Fraction(1)
    cuts: tuple[Fraction, ...] = ()

    def read(self) -> tuple[Graph, Value]:
        """The function."""
        graph = Graph()
        return graph, read(graph, self.text, self.numbers)

    @cached_property
    def file(self) -> dict[str, Any]:
        """What `from_file` reads."""
        told: dict[str, Any] = {"format": FORMAT, "statement": f"{self.text} is {self.kind}", "text": self.text}
        told |= {"kind": self.kind.name, "numbers": {name: written(x) for name, x in self.numbers.items()}}
        return told | {"radius": written(self.radius), "cuts": [written(cut) for cut in self.cuts]}


def from_file(told: dict[str, Any]) -> BallProof:
    """The proof that a file tells of; KeyError, TypeError or ValueError if there is none."""
    numbers = {name: Fraction(x) for name, x in told["numbers"].items()}
    cuts = tuple(map(Fraction, told["cuts"]))
    return BallProof(Kind[told["kind"]], told["text"], numbers, Fraction(told["radius"]), cuts)


def prove_in_balls(kind: Kind, text: str, numbers: Mapping[str, Fraction] | None = None) -> BallProof:
    """A proof that a function has the property strictly, or UnresolvedError.

    Examples
    --------
    >>> proof = prove_in_balls(Kind.PR, "(s + 2 - exp(-s))/(s + 3 + exp(-s)/(1 + s))")
    >>> len(proof.cuts), holds(proof)
    (12, True)
    """
    asked = BallProof(kind, text, dict(numbers or {}))
    with ctx.workprec(BITS):
        x = reflection(kind, *asked.read())
        radius = least_radius(lambda r: _is_small_far_out(x.n, x.d, r))
        if radius is None:
            raise UnresolvedError("no room left far out: |H| comes to 1, or Re Z to 0, for s to infinity")
        cuts = cuts_of_axis(lambda s: abs(x.n(s)) < abs(x.d(s)), radius, partial(_room, x.n, x.d))
    proof = BallProof(kind, text, asked.numbers, radius, tuple(cuts))
    if not holds(proof):
        raise UnresolvedError("Z + A has zeros in Re s > 0, or their number is not resolved")
    return proof


def holds(proof: BallProof) -> bool:
    """Whether the radius and the cuts of a proof make one, of a reflection that leads back to the function."""
    cuts = list(proof.cuts)
    if not cuts or cuts[0] != 0 or cuts[-1] != proof.radius or sorted(set(cuts)) != cuts:
        return False
    try:
        graph, value = proof.read()
        with ctx.workprec(2 * BITS):
            x = reflection(proof.kind, graph, value)
            small = _is_small_far_out(x.n, x.d, proof.radius) and all(abs(x.n(s)) < abs(x.d(s)) for s in pieces(cuts))
            if not small or winding(x.d, proof.radius, cuts):
                return False
        with ctx.workprec(_DIGITS):
            x = reflection(proof.kind, graph, value)
            points = [of_point(re * r, im * r) for re, im in _PLACES for r in (proof.radius, proof.radius / 2**20)]
            pairs = [(x.given(proof.kind, s), in_ball(graph, value, s)) for s in points]
            known = [(a, b) for a, b in pairs if a.is_finite() and b.is_finite()]
            return bool(known) and all(a.overlaps(b) for a, b in known)
    except (UndecidedError, ExpressionError):
        return False


def _is_small_far_out(n: QuasiPolynomial, d: QuasiPolynomial, radius: Fraction) -> bool:
    leading, rest = d.far(radius, d.degree)
    other, more = n.far(radius, d.degree)
    return n.degree <= d.degree and bool(abs(other) + more < abs(leading) - rest)


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
    """X of an impedance, or of the impedance (1 + H)/(1 - H), at the present precision; or UnresolvedError.

    Examples
    --------
    >>> graph = Graph()
    >>> found = reflection(Kind.PR, graph, read(graph, "2*s + 3 + exp(-s)/(1 + s)"))
    >>> found.slopes, found.far
    ((Fraction(2, 1),), Fraction(3, 1))
    """
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
    delays = {key: sum((t * e for e, (t, _) in zip(key, meaning, strict=True)), arb(0)) for key in parts}
    return QuasiPolynomial(
        tuple((delays[key], arb_poly([p.get(k, 0) for k in range(max(p, default=-1) + 1)])) for key, p in parts.items())
    )
