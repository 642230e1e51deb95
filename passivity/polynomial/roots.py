"""Roots of integer polynomials: positive ones in intervals, bands between them, and on which side of the axis they lie.

Those in the right half plane are approached by rational points.

References
----------
F. R. Gantmacher, "The Theory of Matrices", vol. 2, chapter XV (Routh's scheme, Hurwitz determinants).
"""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import isqrt
from typing import NamedTuple

from flint import acb, arb, arb_poly, ctx, fmpq, fmpz, fmpz_poly

from passivity.ball import near
from passivity.budget import bits_of, spend
from passivity.polynomial.sign import MAX_PIECES, UndecidedError, half_line, parts, split, squarefree

_FARTHEST = 1000  # binary exponent of a modulus
_ACCURACY = 512  # bits of a root, at first


class Root(NamedTuple):
    """The only root of `f` between `low` and `high`, or both; f changes its sign there, upwards if `rising`."""

    f: fmpz_poly
    low: fmpq
    high: fmpq
    rising: bool

    def refined(self, bits: int) -> "Root":
        """Narrow the root to a relative width of 2^-bits, or find it exactly."""
        f, low, high, rising = self
        working = 2 * bits + 2 * f.degree()
        with ctx.workprec(working):
            rounded = arb_poly(f)
        while low < high and (low == 0 or (high - low) * 2**bits > low):
            middle = (low + high) / 2
            spend(1000 + len(f) * (100 + working // 10), f"a root of a polynomial of degree {f.degree()}")
            with ctx.workprec(working):
                value: arb | fmpq = rounded(arb(middle))
            if value.contains(0):
                exactly = len(f) * (f.height_bits() + len(f) * middle.height_bits())
                spend(exactly, f"a root of a polynomial of degree {f.degree()}")
                value = f(middle)
            if value == 0:
                low = high = middle
            elif (value > 0) == rising:
                high = middle
            else:
                low = middle
        return Root(f, low, high, rising)

    def sign_of(self, g: fmpz_poly) -> int:
        """Sign of another polynomial at the root, which must not be a root of both."""
        root, bits = self, 40
        while True:
            root = root.refined(bits)
            with ctx.workprec(4 * bits + g.height_bits()):
                value = g(arb(root.low).union(arb(root.high)))
            if value > 0 or value < 0:
                return 1 if value > 0 else -1
            bits *= 2

    def __float__(self) -> float:
        return float(arb(self._near()))

    @property
    def frequency(self) -> float:
        """Square root of the root, which may lie outside the range of doubles."""
        return sqrt(self._near())

    def _near(self) -> fmpq:
        root = self.refined(60)
        return (root.low + root.high) / 2


def sqrt(x: fmpq) -> float:
    """Return the square root of x >= 0; x may be outside the range of doubles."""
    with ctx.workprec(100):
        return float(arb(x).sqrt())


def positive_roots(f: fmpz_poly) -> list[Root]:
    """All positive roots, increasing, of a polynomial without double roots that is not 0 at 0."""
    pieces, found = [half_line(f)], []
    while pieces:
        piece = pieces.pop()
        if piece.f[0] == 0:  # the cut is a root
            cut = fmpq(*piece.left)
            found.append(Root(f, cut, cut, bool(piece.f[1] > 0)))
            piece = piece._replace(f=piece.f.right_shift(1))
        c = [x for x in piece.f.coeffs() if x]
        changes = sum((a > 0) != (b > 0) for a, b in pairwise(c))
        if changes == 1:
            high = fmpq(*piece.right) if piece.right[1] else _bound(f)
            found.append(Root(f, fmpq(*piece.left), high, bool(c[-1] > 0)))
        elif changes:
            if len(pieces) + len(found) > MAX_PIECES:
                raise UndecidedError(f"the roots of a polynomial of degree {f.degree()} take over {MAX_PIECES} pieces")
            pieces += reversed(split(piece))
    return found


def roots_on_axis(f: fmpz_poly) -> list[tuple[Root, int]]:
    """The roots jw with w > 0 of any polynomial, as places x = w^2, and how often each is one."""
    u, v = parts(f)
    factors = squarefree(common) if (common := u.gcd(v)) else ()
    return [(root, power) for factor, power in factors if factor[0] for root in positive_roots(factor)]


def _bound(f: fmpz_poly) -> fmpq:
    """A power of two above all roots (Cauchy's bound)."""
    return fmpq(2) ** (f.height_bits() - f.leading_coefficient().bit_length() + 2)


def approximate_roots(f: fmpz_poly) -> list[complex]:
    """Roots in the right half plane to double precision, as far as they are found, closest to the real axis first."""
    import numpy as np

    n = f.degree()
    k = round((f[0].bit_length() - f[n].bit_length()) / n) if f[0] else 0  # moduli of about 1 in units of 2^k
    if abs(k) > _FARTHEST:
        return []
    c = [x << (k * i if k > 0 else -k * (n - i)) for i, x in enumerate(f.coeffs())]
    spare = max(0, *(abs(x).bit_length() - _FARTHEST for x in c))
    found = np.roots([float(x >> spare) for x in reversed(c)]) * 2.0**k
    return sorted((complex(s) for s in found if s.real > 0), key=lambda s: -s.real / abs(s))


def value(f: fmpz_poly, re: Fraction, im: Fraction) -> tuple[Fraction, Fraction]:
    """Exact value of a polynomial at a rational complex point."""
    size = max(bits_of(re), bits_of(im))
    spend(5_000 + 10 * reducing_cost(len(f) * size + f.height_bits()), "a value")
    u, v = scaled_value(f, re, im, f.degree())
    unit = (re.denominator * im.denominator) ** max(f.degree(), 0)
    return Fraction(int(u), unit), Fraction(int(v), unit)


def scaled_value(f: fmpz_poly, re: Fraction, im: Fraction, degree: int) -> tuple[fmpz, fmpz]:
    """The value times the common denominator to the power `degree`: Horner's scheme with whole numbers."""
    d = fmpz(re.denominator * im.denominator)
    a, b = fmpz(re.numerator * im.denominator), fmpz(im.numerator * re.denominator)
    u, v, unit = fmpz(0), fmpz(0), d ** max(degree - f.degree(), 0)
    for c in reversed(f.coeffs()):
        u, v = u * a - v * b + c * unit, u * b + v * a
        unit *= d
    return u, v


def reducing_cost(bits: int) -> int:
    """Cost of bringing a fraction of this length to lowest terms."""
    return 1_000 + bits * bits // 300


def candidates(f: fmpz_poly) -> Iterator[tuple[Fraction, Fraction]]:
    """Points near roots of f: first approximate ones of the right half plane, then, sure but slow, certified ones."""
    for start in approximate_roots(f)[:3]:
        root = _polished(f, acb(start))
        if root.is_finite():
            yield from _rounded(near(root.real), near(root.imag), _ACCURACY)
    accuracy = _ACCURACY
    while True:
        # the precision is global to the process: should another thread lower it, the next round helps
        spend(100 * len(f) ** 2 * (f.height_bits() + accuracy), f"the roots of a polynomial of degree {f.degree()}")
        with ctx.workprec(accuracy):
            roots: list = f.complex_roots()
            root = max((root for root, _ in roots), key=lambda root: float((root.real / abs(root)).mid()))
        yield from _rounded(near(root.real), near(root.imag), accuracy - 10)
        accuracy *= 4


def _polished(f: fmpz_poly, root: acb) -> acb:
    """The root after Newton's method from a double."""
    slope = f.derivative()
    with ctx.workprec(_ACCURACY + 2 * f.height_bits()):
        for _ in range(6):
            root = (root - f(root) / slope(root)).mid()
    return root


def _rounded(re: Fraction, im: Fraction, bits: int) -> Iterator[tuple[Fraction, Fraction]]:
    """The point, or its mirror image, on ever finer grids, and its right neighbour."""
    shown = 2
    while shown < bits:
        spend(1_000 + 50 * shown, "a witness")
        grid = power_of_two(abs(re) + abs(im)) / 2**shown
        left, up = round(re / grid) * grid, round(abs(im) / grid) * grid
        yield left, up
        yield left + grid, up
        shown *= 2


def square_roots(x: Fraction) -> Iterator[Fraction]:
    """Rational approximations of sqrt(x), each with twice as many digits as the one before."""
    bits = 2
    while True:
        shift = bits - (x.numerator.bit_length() - x.denominator.bit_length()) // 2
        scaled = x * Fraction(4) ** shift
        yield isqrt(scaled.numerator // scaled.denominator) / Fraction(2) ** shift
        bits *= 2


def to_fmpq(x: Fraction) -> fmpq:
    """Convert a fraction to FLINT's type."""
    return fmpq(x.numerator, x.denominator)


def power_of_two(x: Fraction) -> Fraction:
    """A power of two of about the size of x > 0."""
    return Fraction(2) ** (x.numerator.bit_length() - x.denominator.bit_length())


def routh_column(f: fmpz_poly) -> tuple[arb, ...] | None:
    """Routh's column of an integer polynomial, as balls above zero; None if a root has a real part >= 0.

    The rows start at the low powers, so the column belongs to s^n f(1/s), whose roots lie in the same half plane. The
    product of the first k entries is a Hurwitz determinant, a whole number: when a ball leaves only zero for it, it
    *is* zero. So doubling the precision ends in every case, without exact elimination.
    Zero counts as having roots everywhere.
    """
    if not f:
        return None
    if f.leading_coefficient() < 0:
        f = -f
    if not all(c > 0 for c in f.coeffs()):
        return None
    bits = 64 + 4 * f.degree()
    while True:
        spend(10_000 * len(f) + len(f) ** 2 * bits // 2, f"Routh's scheme of degree {f.degree()}")
        # the precision is global to the process: the accuracy found counts, not the one asked for
        with ctx.workprec(bits):
            column, determinant = [], arb(1)
            for pivot in pivots(f):
                if not pivot > 0:
                    break
                determinant *= pivot
                column.append(pivot)
            else:
                return tuple(column)
            if pivot < 0 or abs(determinant * pivot / column[0]) < 1:
                return None
        bits *= 2


def pivots(f: fmpz_poly) -> Iterator[arb]:
    """Routh's column as far as its entries are known not to be zero, and the next; at the present precision."""
    c = f.coeffs()
    upper, lower = arb_poly(c[::2]), arb_poly(c[1::2])
    yield upper[0]
    for _ in range(f.degree()):
        yield lower[0]
        if lower[0].contains(0):
            return
        upper, lower = lower, (upper - lower * (upper[0] / lower[0])).right_shift(1)


def violations(sums: Sequence[fmpz_poly]) -> list[tuple[float, float]]:
    """Intervals of w = sqrt(x) where at least one of some polynomials in x is negative, to double precision."""
    found: list[tuple[float, float]] = []
    for low, high in sorted(band for a in sums if a for band in _negative(a)):
        joined = found and low <= found[-1][1]
        if joined:
            low, before = found.pop()
            high = max(before, high)
        found.append((low, high))
    return found


def _negative(a: fmpz_poly) -> list[tuple[float, float]]:
    """The intervals of one polynomial: counted down from infinity, its sign changes at each root of odd order."""
    roots = [root for f, power in squarefree(a) if power % 2 and f[0] for root in positive_roots(f)]
    ends = [0.0, *sorted(root.frequency for root in roots), math.inf]
    negative = a.leading_coefficient() < 0
    return [band for k, band in enumerate(reversed(list(pairwise(ends)))) if (k % 2 == 0) == negative]
