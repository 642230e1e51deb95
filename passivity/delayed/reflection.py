"""X = (Z1 - A)/(Z1 + A) of a function that is rational in s and in delays, as a quotient of quasi-polynomials.

Z = a0 s + 1/(a1 s + 1/(... + 1/(ak s + Z1))), where Z1 has the value A > 0 for s to infinity without its delays.
"""

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, arb_poly, fmpz_mpoly

from passivity.ball import of_fraction
from passivity.budget import UndecidedError
from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.calculus.graph import Graph, Value
from passivity.calculus.values import in_ball
from passivity.delayed.quasi import QuasiPolynomial
from passivity.status import Kind

_MAX_POLES = 4  # at infinity, split off one after the other


class UnresolvedError(UndecidedError):
    """What could not be resolved in balls; `frequency` where the axis is not clear."""

    frequency: float | None = None


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
    """X of an impedance, or of the impedance (1 + H)/(1 - H), at the present precision.

    Raises
    ------
    UnresolvedError
        If the function is not of this kind, or too large.

    Examples
    --------
    >>> from passivity.calculus.read import read
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
    used = {k for f in z for k, degree in enumerate(f.degrees()[1:]) if degree}
    others = range(expansion.domain.others)
    meaning = [_meaning(expansion, k) if k in used else (arb(0), arb(1)) for k in others]
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
    raise UnresolvedError("no positive value far out, where delays have died away")


def _leading(f: fmpz_mpoly) -> tuple[int, int]:
    """Highest power of s and its coefficient, among the terms without generators."""
    plain = [(int(x[0]), int(c)) for x, c in f.to_dict().items() if not any(x[1:])]
    if not plain:
        raise UnresolvedError("no positive value far out, where delays have died away")
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
    delays: dict[tuple, arb] = {}
    parts: dict[tuple, dict[int, arb]] = {(0,) * len(meaning): {}}
    for x, c in f.to_dict().items():
        key = tuple(int(e) if t > 0 else 0 for e, (t, _) in zip(x[1:], meaning, strict=True))
        coefficient = arb(c)
        for e, (_, factor) in zip(x[1:], meaning, strict=True):
            coefficient *= factor ** int(e)
        powers = parts.setdefault(key, {})
        powers[int(x[0])] = powers.get(int(x[0]), arb(0)) + coefficient
    for key in parts:
        delays[key] = sum((t * e for e, (t, _) in zip(key, meaning, strict=True)), arb(0))
    return QuasiPolynomial(
        tuple((delays[key], arb_poly([p.get(k, 0) for k in range(max(p, default=-1) + 1)])) for key, p in parts.items())
    )
