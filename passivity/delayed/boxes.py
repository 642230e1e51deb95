"""Proofs in ball arithmetic for functions that are rational in s and in delays, where the property holds strictly.

Z = a s + Z1, and so on for 1/Z1, until Z1 has a value A > 0 for s to infinity without its delays. Then
X = (Z1 - A)/(Z1 + A) = n/d is analytic with |X| < 1 in Re s > 0, and so Z is positive real, if |n| < |d|

  - far out, |s| >= R, where the delays stand for any number in the unit disc,
  - on the pieces of the axis up to R, each in a ball,

and d does not turn around zero along the half disc of radius R: then it has no zero in it, and |X| is
largest on the edge.
"""

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, arb_poly, ctx, fmpz_mpoly

from passivity.delayed.field import Element, Field, TooLargeError
from passivity.delayed.form import Form, Function, Product, depends_on_s, multiply, of_rational
from passivity.delayed.quasi import BITS, MAX_PIECES, QuasiPolynomial, on_axis, pieces, winding
from passivity.delayed.value import value
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.rational.function import RationalFunction
from passivity.status import Kind

_ONE = RationalFunction.constant(Fraction(1))
_S = of_rational(RationalFunction.from_coefficients([1, 0], [1]))
_MAX_POLES = 4  # at infinity, split off one after the other
_MAX_DOUBLINGS = 200


@dataclass(frozen=True)
class BallProof:
    """All that `holds` needs to repeat a proof in balls: n, d, the radius R and the cuts of the axis from 0 to R."""

    kind: Kind
    form: Form
    radius: Fraction
    cuts: tuple[Fraction, ...]


class UnresolvedError(UndecidedError):
    """What could not be resolved in balls; `frequency` where the axis is not clear."""

    frequency: float | None = None


def prove_in_balls(kind: Kind, form: Form) -> BallProof:
    """A proof that a function has the property strictly.

    Raises
    ------
    UnresolvedError
        If the function is not of this kind, or what is not resolved within MAX_PIECES.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> proof = prove_in_balls(Kind.PR, of_text("(s + 2 - exp(-s))/(s + 3 + exp(-s)/(1 + s))"))
    >>> len(proof.cuts), holds(proof)
    (12, True)
    """
    with ctx.workprec(BITS):
        n, d = _reflection(kind, form)
        radius = _radius(n, d)
        cuts = _cuts(n, d, radius)
    proof = BallProof(kind, form, radius, tuple(cuts))
    if not holds(proof):
        raise UnresolvedError("Z + A has zeros in Re s > 0, or their number is not resolved")
    return proof


def holds(proof: BallProof) -> bool:
    """Whether the radius and the cuts of a proof make one."""
    cuts = list(proof.cuts)
    if cuts[0] != 0 or cuts[-1] != proof.radius or sorted(set(cuts)) != cuts:
        return False
    with ctx.workprec(2 * BITS):
        try:
            n, d = _reflection(proof.kind, proof.form)
            small = _is_small_far_out(n, d, proof.radius) and all(abs(n(s)) < abs(d(s)) for s in pieces(cuts))
            return small and winding(d, proof.radius, cuts) == 0
        except UndecidedError:
            return False


def _reflection(kind: Kind, form: Form) -> tuple[QuasiPolynomial, QuasiPolynomial]:
    """Numerator and denominator of X."""
    field = Field(form)
    try:
        z = field.of(form)
        if kind is Kind.BR:
            z = field.cancelled(Element(z.d + z.n, z.d - z.n))
        if not z.d:
            raise UnresolvedError("infinite everywhere")
        z, a = _without_poles(field, z)
        up, down = a.numerator, a.denominator
        both = [field.reduced(z.n * down - z.d * up), field.reduced(z.n * down + z.d * up)]
    except TooLargeError:
        raise UnresolvedError("multiplied out, the function is too large") from None
    used = {k for f in z for k, degree in enumerate(f.degrees()[1:]) if degree}
    meaning = [_meaning(g, field.units[g]) if k in used else (arb(0), arb(1)) for k, g in enumerate(field.generators)]
    return _quasi(meaning, both[0]), _quasi(meaning, both[1])


def _without_poles(field: Field, z: Element) -> tuple[Element, Fraction]:
    """The function without its poles at infinity, and those of its inverse, and its value there without delays."""
    for _ in range(_MAX_POLES):
        (m, a), (n, b) = _leading(field, z.n), _leading(field, z.d)
        if m == n:
            if a / b > 0:
                return z, Fraction(a, b)
            break
        if m < n:
            z, m, a, n, b = Element(z.d, z.n), n, b, m, a
        if m != n + 1 or a / b < 0:
            break
        pole = field.s * z.d
        z = field.cancelled(Element(z.n * b - pole * a, z.d * b))
        if not z.n:
            break
    raise UnresolvedError("no positive value far out, where delays have died away")


def _leading(field: Field, f: fmpz_mpoly) -> tuple[int, int]:
    """Highest power of s and its coefficient, among the terms without generators."""
    plain = [(int(x[0]), int(c)) for x, c in f.to_dict().items() if not any(x[1:])]
    if not plain:
        raise UnresolvedError("no positive value far out, where delays have died away")
    return max(plain)


def _meaning(g: Function, unit: Fraction) -> tuple[arb, arb]:
    """T and c of a generator c exp(-T s)."""
    if not depends_on_s(Form((Product(_ONE, ((g, 1),)),))):
        return arb(0), value(multiply([(g, 1)]), acb(1)).real
    if g.name == "exp" and not depends_on_s(per := g.argument / _S):
        t = -value(per, acb(1)).real * unit.numerator / unit.denominator
        if t > 0:
            return t, arb(1)
    raise UnresolvedError("not rational in s and delays")


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


def _is_small_far_out(n: QuasiPolynomial, d: QuasiPolynomial, radius: Fraction) -> bool:
    leading, rest = d.far(radius, d.degree)
    other, more = n.far(radius, d.degree)
    return n.degree <= d.degree and bool(abs(other) + more < abs(leading) - rest)


def _radius(n: QuasiPolynomial, d: QuasiPolynomial) -> Fraction:
    radius = Fraction(1)
    for _ in range(_MAX_DOUBLINGS):
        if _is_small_far_out(n, d, radius):
            break
        radius *= 2
    else:
        raise UnresolvedError("no room left far out: |H| comes to 1, or Re Z to 0, for s to infinity")
    while radius > Fraction(1, 2**_MAX_DOUBLINGS) and _is_small_far_out(n, d, radius / 2):
        radius /= 2
    return radius


def _cuts(n: QuasiPolynomial, d: QuasiPolynomial, radius: Fraction) -> list[Fraction]:
    stack, cuts, count = [(Fraction(0), radius)], [Fraction(0)], 0
    while stack:
        low, high = stack.pop()
        count += 1
        s = on_axis(low, high)
        if abs(n(s)) < abs(d(s)):
            cuts.append(high)
        elif count > MAX_PIECES or high - low < radius / 2**50:
            room = 1 - abs(n(s)) / abs(d(s))
            error = UnresolvedError(
                f"for ω from {float(low):.6g} to {float(high):.6g} the room 1 - |X(jω)|, X = (Z - A)/(Z + A), "
                f"is only known to lie between {float(room.lower()):.3g} and {float(room.upper()):.3g}"
            )
            error.frequency = float((low + high) / 2)
            raise error
        else:
            middle = (low + high) / 2
            stack += [(middle, high), (low, middle)]
    return cuts
