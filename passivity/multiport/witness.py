"""Points of the right half plane and vectors for which a matrix is not what it should be, shown in exact arithmetic."""

from collections.abc import Iterable, Iterator
from fractions import Fraction

from flint import fmpq, fmpq_mat, fmpz_poly

from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.quadratic_form import negative_direction
from passivity.multiport.verdict import MatrixWitness, Network
from passivity.one_port.polynomial_sign import find_sign
from passivity.one_port.witness import candidates, power_of_two, square_roots, to_fmpq
from passivity.status import Kind


def beside_axis(a: fmpz_poly) -> Iterator[tuple[Fraction, Fraction]]:
    """Points sigma + jw, ever closer to the axis, over a place w with a(w^2) < 0; there must be one."""
    x0 = find_sign(a)
    assert isinstance(x0, Fraction)
    w = next(w for w in square_roots(x0) if a(to_fmpq(w * w)) < 0)
    sigma, step = power_of_two(w) if w else Fraction(1), 1
    while True:
        yield sigma, w
        sigma, step = sigma / 2**step, step + 1


def near_root(f: fmpz_poly) -> Iterator[tuple[Fraction, Fraction]]:
    """Points ever closer to a root of f in the right half plane."""
    return candidates(f)


def first_witness(kind: Kind, matrix: RationalMatrix, points: Iterable[tuple[Fraction, Fraction]]) -> MatrixWitness:
    """The first of the points where the property fails, with a vector of few digits."""
    for re, im in points:
        if witness := witness_at(kind, matrix, re, im):
            return witness
    raise AssertionError("the points come as close as need be to a place where the property fails")


def witness_at(kind: Kind, network: Network, re: Fraction, im: Fraction) -> MatrixWitness | None:
    """The point with a vector of few digits, None if the property does not fail there."""
    value = network.at(re, im) if re > 0 else None
    if value is None or not (x := negative_direction(form := hermitian_form(kind, value))):
        return None
    return _shortened(re, im, form, x)


def hermitian_form(kind: Kind, value: fmpq_mat) -> fmpq_mat:
    """Z + Z^H, or I - S^H S, from a value [[U, -V], [V, U]], in the same way of writing."""
    if kind is Kind.PR:
        return value + value.transpose()
    n = value.nrows()
    return fmpq_mat(n, n, [int(i == k) for i in range(n) for k in range(n)]) - value.transpose() * value


def _shortened(re: Fraction, im: Fraction, form: fmpq_mat, x: list[fmpq]) -> MatrixWitness:
    """The vector on the coarsest grid on which it still is a witness."""
    n, largest, bits = len(x), max(map(abs, x)), 1
    while True:
        y = fmpq_mat(n, 1, [fmpq((c * 2**bits / largest + fmpq(1, 2)).floor(), 2**bits) for c in x])
        value = (y.transpose() * form * y)[0, 0]
        if value < 0:
            break
        bits *= 2
    parts = [Fraction(int(c.p), int(c.q)) for c in y.entries()]
    vector = tuple(zip(parts[: n // 2], parts[n // 2 :], strict=True))
    return MatrixWitness(re, im, vector, Fraction(int(value.p), int(value.q)))
