"""Sums of P(t) exp(pt) with polynomials P: motions of linear scenes between fronts, in ball arithmetic.

Every number is a ball that is proved to hold the true value: F. Johansson, "Arb: efficient arbitrary-precision
midpoint-radius interval arithmetic", IEEE Trans. Computers 66 (2017) 1281-1292, doi:10.1109/TC.2017.2690633.
"""

from collections.abc import Hashable, Iterable
from fractions import Fraction
from math import factorial
from typing import Any

from flint import acb, acb_poly, arb, fmpq, fmpq_poly

ZERO = acb(0)


class Pole:
    """Exponent p; poles of the same key are equal."""

    __slots__ = ("key", "value")

    def __init__(self, key: Hashable, value: acb):
        self.key, self.value = key, value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pole) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


def rational(value: Fraction) -> fmpq:
    """Convert a fraction to the number type of python-flint."""
    return fmpq(value.numerator, value.denominator)


def roots(polynomial: fmpq_poly) -> list[Pole]:
    """All roots, repeated by multiplicity."""
    found = []
    for factor, multiplicity in polynomial.factor()[1]:
        monic = tuple(str(c / factor.leading_coefficient()) for c in factor.coeffs())
        distinct: list[Any] = factor.complex_roots()  # pairs of root and multiplicity, which is one
        found += multiplicity * [Pole((monic, k), root) for k, (root, _) in enumerate(distinct)]
    return found


def rate(value: Fraction) -> Pole:
    """Rational exponent."""
    return roots(fmpq_poly([rational(-value), 1]))[0]


def rotation(frequency: Fraction, sign: int) -> Pole:
    """Exponent sign · 2 pi i · frequency."""
    return Pole((frequency, sign), acb(0, 2 * sign * arb.pi() * rational(frequency)))


class ExponentialSum:
    """Sum of P(t) exp(pt), P by pole."""

    def __init__(self, parts: dict[Pole, acb_poly] | None = None):
        self.parts = parts or {}

    def __add__(self, other: "ExponentialSum") -> "ExponentialSum":
        parts = dict(self.parts)
        for pole, polynomial in other.parts.items():
            parts[pole] = parts[pole] + polynomial if pole in parts else polynomial
        return ExponentialSum(parts)

    def __mul__(self, factor: fmpq) -> "ExponentialSum":
        return ExponentialSum({pole: polynomial * acb(factor) for pole, polynomial in self.parts.items()})

    def shifted(self, by: Fraction) -> "ExponentialSum":
        """Shift the motion to a time origin later by this."""
        if not by:
            return self
        later = acb_poly([acb(rational(by)), 1])
        return ExponentialSum({p: P(later) * (p.value * rational(by)).exp() for p, P in self.parts.items()})

    def at(self, t: Fraction) -> arb:
        """Value at t, which is real."""
        now = acb(rational(t))
        return sum((P(now) * (p.value * now).exp() for p, P in self.parts.items()), ZERO).real


class Ray:
    """Rational function of s as partial fractions: direct + sum of c[m] / (s - p)^(m + 1)."""

    __slots__ = ("direct", "parts")

    def __init__(self, direct: acb = ZERO, parts: dict[Pole, list[acb]] | None = None):
        self.direct, self.parts = direct, parts or {}

    def __add__(self, other: "Ray") -> "Ray":
        parts = dict(self.parts)
        for pole, c in other.parts.items():
            mine = parts.get(pole, [])
            short, long = sorted((mine, c), key=len)
            parts[pole] = [a + b for a, b in zip(short, long, strict=False)] + long[len(short) :]
        return Ray(self.direct + other.direct, parts)

    def __mul__(self, factor: acb | fmpq) -> "Ray":
        factor = acb(factor)
        return Ray(self.direct * factor, {pole: [a * factor for a in c] for pole, c in self.parts.items()})

    @property
    def silent(self) -> bool:
        """Whether the function is exactly zero."""
        return self.direct == 0 and all(a == 0 for c in self.parts.values() for a in c)

    def over(self, pole: Pole) -> "Ray":
        """Divide by s - p."""
        parts, residue = {}, self.direct
        for q, c in self.parts.items():
            if q != pole:
                inverse, d = 1 / (pole.value - q.value), ZERO
                rest = []
                for a in reversed(c):
                    d = (d - a) * inverse
                    rest.append(d)
                parts[q] = rest[::-1]
                residue -= d
        parts[pole] = [residue, *self.parts.get(pole, [])]
        return Ray(ZERO, parts)

    def through(self, gain: fmpq, zeros: Iterable[Pole], poles: Iterable[Pole]) -> "Ray":
        """Multiply by gain · product of (s - z) / product of (s - p), with no fewer poles than zeros."""
        ray, zeros = self * gain, list(zeros)
        for k, pole in enumerate(poles):
            divided = ray.over(pole)
            ray = ray + divided * (pole.value - zeros[k].value) if k < len(zeros) else divided
        return ray

    def driven(self, motion: ExponentialSum) -> ExponentialSum:
        """Response to a motion that starts at t = 0."""
        total = ExponentialSum()
        for pole, polynomial in motion.parts.items():
            ray = Ray()
            for k, a in reversed(list(enumerate(polynomial.coeffs()))):
                ray = (ray + self * (a * factorial(k))).over(pole)
            total = total + ray.motion()
        return total

    def motion(self) -> ExponentialSum:
        """Inverse Laplace transform without the direct part."""
        return ExponentialSum({p: acb_poly([a / factorial(m) for m, a in enumerate(c)]) for p, c in self.parts.items()})
