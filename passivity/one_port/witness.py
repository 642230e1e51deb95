"""Rational points of the right half plane where a function is not what it should be, constructed, not searched."""

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt

from flint import acb, arb, ctx, fmpq, fmpz, fmpz_poly

from passivity.ball import near
from passivity.budget import spend
from passivity.one_port.ladder import approximate_roots
from passivity.one_port.verdict import Witness
from passivity.size import bits_of
from passivity.status import Kind

_NONE = Fraction(0)
_ACCURACY = 512  # bits of a root, at first


def from_axis(kind: Kind, p: fmpz_poly, q: fmpz_poly, a: fmpz_poly, x0: Fraction, delay: Fraction = _NONE) -> Witness:
    """Witness s = sigma + jw above a point of the axis with A(x0) < 0: w rational near sqrt(x0), sigma small enough.

    With a delay T, |H(s)| > exp(2 T sigma) is wanted of a reflection: a witness for exp(-2Ts) H.
    """
    w = next(w for w in square_roots(x0) if a(to_fmpq(w * w)) < 0)
    sigma, witness, step = power_of_two(w) if w else Fraction(1), None, 1
    while (witness := _witness(kind, p, q, sigma, w, delay)) is None:
        sigma, step = sigma / 2**step, 2 * step
    while (step := step // 2) > 1:  # back to the largest that will do: fewer digits
        larger = _witness(kind, p, q, sigma * 2 ** (step // 2), w, delay)
        sigma, witness = (larger.re, larger) if larger else (sigma, witness)
    return witness


def from_root(kind: Kind, p: fmpz_poly, q: fmpz_poly, f: fmpz_poly, delay: Fraction = _NONE) -> Witness:
    """Witness near a root of f in the right half plane: of f = p + q, where Z = -1, or of f = q, where H has a pole."""
    for re, im in candidates(f):
        if re > 0 and (witness := _witness(kind, p, q, re, im, delay)):
            return witness
    raise AssertionError("a polynomial that is not Hurwitz has a root in the right half plane")


def value(f: fmpz_poly, re: Fraction, im: Fraction) -> tuple[Fraction, Fraction]:
    """Exact value of a polynomial at a rational complex point.

    Examples
    --------
    >>> value(fmpz_poly([0, 0, 1]), Fraction(1, 2), Fraction(1))
    (Fraction(-3, 4), Fraction(1, 1))
    """
    size = max(bits_of(re), bits_of(im))
    spend(5_000 + 10 * _reducing(len(f) * size + f.height_bits()), "a value")
    u, v = _scaled(f, re, im, f.degree())
    unit = (re.denominator * im.denominator) ** max(f.degree(), 0)
    return Fraction(int(u), unit), Fraction(int(v), unit)


def _scaled(f: fmpz_poly, re: Fraction, im: Fraction, degree: int) -> tuple[fmpz, fmpz]:
    """The value times the common denominator to the power `degree`: Horner's scheme with whole numbers."""
    d = fmpz(re.denominator * im.denominator)
    a, b = fmpz(re.numerator * im.denominator), fmpz(im.numerator * re.denominator)
    u, v, unit = fmpz(0), fmpz(0), d ** max(degree - f.degree(), 0)
    for c in reversed(f.coeffs()):
        u, v = u * a - v * b + c * unit, u * b + v * a
        unit *= d
    return u, v


def _reducing(bits: int) -> int:
    """Cost of bringing a fraction of this length to lowest terms."""
    return 1_000 + bits * bits // 300


def _witness(kind: Kind, p: fmpz_poly, q: fmpz_poly, re: Fraction, im: Fraction, delay: Fraction) -> Witness | None:
    """The point as a witness, None if it is none."""
    degree, size = max(p.degree(), q.degree()), max(bits_of(re), bits_of(im))
    spend(10_000 + 5 * (degree + 1) * ((degree + 1) * size + p.height_bits() + q.height_bits()), "a witness")
    (a, b), (c, d) = _scaled(p, re, im, degree), _scaled(q, re, im, degree)
    real, size = a * c + b * d, c * c + d * d
    wrong = real < 0 if kind is Kind.PR else a * a + b * b > size
    if not wrong or (not size and q):  # a pole of H by chance: its neighbours have values
        return None
    if size and delay and not arb(fmpq(a * a + b * b - size, size)) > arb(to_fmpq(4 * delay * re)).expm1():
        return None
    if not size:
        return Witness(re, im, None, None)
    spend(_reducing(size.bit_length()), "a witness")
    return Witness(re, im, Fraction(int(real), int(size)), Fraction(int(b * c - a * d), int(size)))


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
            root = max((root for root, _ in roots), key=_cosine)
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


def _cosine(root: acb) -> float:
    return float((root.real / abs(root)).mid())


def square_roots(x: Fraction) -> Iterator[Fraction]:
    """Rational approximations of sqrt(x), each with twice as many digits as the one before."""
    bits = 2
    while True:
        shift = bits - (x.numerator.bit_length() - x.denominator.bit_length()) // 2
        scaled = x * Fraction(4) ** shift
        yield isqrt(scaled.numerator // scaled.denominator) / Fraction(2) ** shift
        bits *= 2


def to_fmpq(x: Fraction) -> fmpq:
    """The same number for FLINT."""
    return fmpq(x.numerator, x.denominator)


def power_of_two(x: Fraction) -> Fraction:
    """A power of two of about the size of x > 0."""
    return Fraction(2) ** (x.numerator.bit_length() - x.denominator.bit_length())
