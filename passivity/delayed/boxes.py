"""Proofs in ball arithmetic for functions that are rational in s and in delays, where the property holds strictly.

Z = a s + Z1, and so on for 1/Z1, until Z1 has a value A > 0 for s to infinity without its delays. Then
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

from flint import ctx

from passivity.ball import of_point
from passivity.budget import UndecidedError
from passivity.calculus.graph import Graph, Value
from passivity.calculus.read import read
from passivity.calculus.values import in_ball
from passivity.delayed.quasi import BITS, QuasiPolynomial, cuts_of_axis, least_radius, on_axis, pieces, winding
from passivity.delayed.reflection import Reflection, UnresolvedError, reflection
from passivity.errors import ExpressionError
from passivity.expression.number import written
from passivity.status import Kind

FORMAT = "passivity proof in balls 1"

_PLACES = ((Fraction(37, 29), Fraction(17, 23)), (Fraction(5, 3), Fraction(0)), (Fraction(1, 7), Fraction(9, 11)))
_DIGITS = 4096  # binary, of the comparison: a term of 1e-400 is seen, and so is its square


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
    """A proof that a function has the property strictly.

    Raises
    ------
    UnresolvedError
        If the function is not of this kind, or what is not resolved within MAX_PIECES.

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
    """Whether the radius and the cuts of a proof make one."""
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
            return _is_of(reflection(proof.kind, graph, value), proof, graph, value)
    except (UndecidedError, ExpressionError):
        return False


def _is_of(x: Reflection, proof: BallProof, graph: Graph, value: Value) -> bool:
    """Whether X leads back to the values of the function, at a few points and to many digits."""
    sizes = [proof.radius / far for far in (1, 2**20)]
    points = [of_point(re * size, im * size) for re, im in _PLACES for size in sizes]
    pairs = [(x.given(proof.kind, s), in_ball(graph, value, s)) for s in points]
    known = [(a, b) for a, b in pairs if a.is_finite() and b.is_finite()]
    return bool(known) and all(a.overlaps(b) for a, b in known)


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
