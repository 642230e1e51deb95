"""Witnesses: points of the right half plane, and vectors, where the property fails, by construction."""

from collections.abc import Callable
from fractions import Fraction

from flint import arb, fmpq, fmpq_mat, fmpz_poly

from passivity.budget import bits_of, spend
from passivity.exact.storage import negative_direction
from passivity.polynomial.roots import candidates, power_of_two, reducing_cost, scaled_value, square_roots, to_fmpq
from passivity.rational.matrix import RationalMatrix
from passivity.rational.state_space import identity
from passivity.status import Kind
from passivity.verdict import Parts, Witness

Test = Callable[[Fraction, Fraction], Witness | None]  # a point as a witness, None if it is none


def from_axis(test: Test, a: fmpz_poly, x0: Fraction) -> Witness:
    """Witness s = sigma + jw above a point of the axis with a(x0) < 0: w rational near sqrt(x0), sigma small enough."""
    w = next(w for w in square_roots(x0) if a(to_fmpq(w * w)) < 0)
    sigma, witness, step = power_of_two(w) if w else Fraction(1), None, 1
    while (witness := test(sigma, w)) is None:
        sigma, step = sigma / 2**step, 2 * step
    while (step := step // 2) > 1:  # back to the largest that will do: fewer digits
        larger = test(sigma * 2 ** (step // 2), w)
        sigma, witness = (larger.re, larger) if larger else (sigma, witness)
    return witness


def from_root(test: Test, f: fmpz_poly) -> Witness:
    """Witness near a root of f in the right half plane: of f = p + q, where Z = -1, or of f = q, where H has a pole."""
    for re, im in candidates(f):
        if re > 0 and (witness := test(re, im)):
            return witness
    raise AssertionError("a polynomial that is not Hurwitz has a root in the right half plane")


def of_one_port(kind: Kind, p: fmpz_poly, q: fmpz_poly, delay: Fraction = Fraction(0)) -> Test:
    """Test whether a point is a witness against p/q; with a delay T, of a reflection against exp(-2Ts) p/q."""

    def test(re: Fraction, im: Fraction) -> Witness | None:
        degree, size = max(p.degree(), q.degree()), max(bits_of(re), bits_of(im))
        spend(10_000 + 5 * (degree + 1) * ((degree + 1) * size + p.height_bits() + q.height_bits()), "a witness")
        (a, b), (c, d) = scaled_value(p, re, im, degree), scaled_value(q, re, im, degree)
        real, size = a * c + b * d, c * c + d * d
        wrong = real < 0 if kind is Kind.PR else a * a + b * b > size
        if not wrong or (not size and q):  # a pole of H by chance: its neighbours have values
            return None
        if size and delay and not arb(fmpq(a * a + b * b - size, size)) > arb(to_fmpq(4 * delay * re)).expm1():
            return None
        if not size:
            return Witness(kind, re, im, None)
        spend(reducing_cost(size.bit_length()), "a witness")
        value = Fraction(int(real), int(size)), Fraction(int(b * c - a * d), int(size))
        return Witness(kind, re, im, (value,))

    return test


def of_multiport(kind: Kind, network: RationalMatrix) -> Test:
    """Test whether a point is a witness, with a vector of few digits."""

    def test(re: Fraction, im: Fraction) -> Witness | None:
        value = network.at(re, im) if re > 0 else None
        if value is None or not (x := negative_direction(form := hermitian_form(kind, value))):
            return None
        vector = _short(form, x) if network.size > 1 else fmpq_mat(2, 1, [1, 0])
        return Witness(kind, re, im, _parts(value * vector), _parts(vector))

    return test


def hermitian_form(kind: Kind, value: fmpq_mat) -> fmpq_mat:
    """Z + Z^H, or I - S^H S, from a value [[U, -V], [V, U]], in the same way of writing."""
    if kind is Kind.PR:
        return value + value.transpose()
    return identity(value.nrows()) - value.transpose() * value


def _short(form: fmpq_mat, x: list[fmpq]) -> fmpq_mat:
    """The vector on the coarsest grid on which the form still is negative."""
    n, largest, bits = len(x), max(map(abs, x)), 1
    while True:
        y = fmpq_mat(n, 1, [fmpq((c * 2**bits / largest + fmpq(1, 2)).floor(), 2**bits) for c in x])
        if (y.transpose() * form * y)[0, 0] < 0:
            return y
        bits *= 2


def _parts(column: fmpq_mat) -> tuple[Parts, ...]:
    parts = [Fraction(int(c.p), int(c.q)) for c in column.entries()]
    return tuple(zip(parts[: len(parts) // 2], parts[len(parts) // 2 :], strict=True))
