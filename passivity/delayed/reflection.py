"""X = (Z1 - A)/(Z1 + A) of a function that is rational in s and in delays, as a quotient of quasi-polynomials.

Z = a0 s + 1/(a1 s + 1/(... + 1/(ak s + Z1))), where Z1 has the value A > 0 for s to infinity without its delays.
"""

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, arb_poly, fmpz_mpoly

from passivity.ball import of_fraction
from passivity.delayed.field import Element, Field, TooLargeError
from passivity.delayed.form import Form, Function, depends_on_s, multiply, of_rational
from passivity.delayed.quasi import QuasiPolynomial
from passivity.delayed.value import value
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.rational.function import RationalFunction
from passivity.status import Kind

_S = of_rational(RationalFunction.from_coefficients([1, 0], [1]))
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


def reflection(kind: Kind, form: Form) -> Reflection:
    """X of an impedance, or of the impedance (1 + H)/(1 - H), at the present precision.

    Raises
    ------
    UnresolvedError
        If the function is not of this kind, or too large.

    Examples
    --------
    >>> from passivity.delayed.translate import of_text
    >>> found = reflection(Kind.PR, of_text("2*s + 3 + exp(-s)/(1 + s)"))
    >>> found.slopes, found.far
    ((Fraction(2, 1),), Fraction(3, 1))
    """
    field = Field(form)
    try:
        z = field.of(form)
        if kind is Kind.BR:
            z = field.cancelled(Element(z.d + z.n, z.d - z.n))
        if not z.d:
            raise UnresolvedError("infinite everywhere")
        z, slopes, a = _without_poles(field, z)
        up, down = a.numerator, a.denominator
        both = [field.reduced(z.n * down - z.d * up), field.reduced(z.n * down + z.d * up)]
    except TooLargeError:
        raise UnresolvedError("multiplied out, the function is too large") from None
    used = {k for f in z for k, degree in enumerate(f.degrees()[1:]) if degree}
    meaning = [_meaning(g, field.units[g]) if k in used else (arb(0), arb(1)) for k, g in enumerate(field.generators)]
    return Reflection(_quasi(meaning, both[0]), _quasi(meaning, both[1]), slopes, a)


def _without_poles(field: Field, z: Element) -> tuple[Element, tuple[Fraction, ...], Fraction]:
    """Z1, the slopes and A."""
    slopes = [Fraction(0)]
    for _ in range(_MAX_POLES):
        (m, a), (n, b) = _leading(field, z.n), _leading(field, z.d)
        if m == n:
            if a * b > 0:
                return z, tuple(slopes), Fraction(a, b)
            break
        if m < n:
            z, m, a, n, b = Element(z.d, z.n), n, b, m, a
            slopes.append(Fraction(0))
        if m != n + 1 or a * b < 0:
            break
        slopes[-1] = Fraction(a, b)
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
    if not depends_on_s(whole := multiply([(g, 1)])):
        return arb(0), _real(whole)
    if g.name == "exp" and not depends_on_s(per := g.argument / _S):
        t = -_real(per) * unit.numerator / unit.denominator
        if t > 0:
            return t, arb(1)
    raise UnresolvedError("not rational in s and delays")


def _real(constant: Form) -> arb:
    """A constant that is known to have no imaginary part."""
    ball = value(constant, acb(1))
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
