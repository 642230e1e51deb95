"""The Hermitian form on the imaginary axis that must not be negative, and its signs as polynomials in x = w^2.

A Hermitian matrix F is nonnegative if and only if, for each k, the sum of its principal minors of order k is: these
are the coefficients of det(t + F), whose roots are real. That takes m signs, not 2^m.
"""

from collections.abc import Iterator

from flint import fmpz_poly

from passivity.multiport.polynomial_matrix import (
    PolynomialMatrix,
    add,
    degree,
    height_bits,
    identity,
    minor_sums,
    mirrored,
    multiply,
    scaled,
)
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.status import Kind

MAX_WORK = 100_000_000  # ports^4 degree bits: up to ten seconds


def hermitian_polynomial(kind: Kind, n: PolynomialMatrix, d: fmpz_poly) -> PolynomialMatrix:
    """On the axis |d|^2 (Z + Z^H), or |d|^2 (I - S^H S), where Z or S is n/d.

    Examples
    --------
    >>> hermitian_polynomial(Kind.PR, [[fmpz_poly([2])]], fmpz_poly([1, 1]))  # 2 (1 - s) + 2 (1 + s)
    [[4]]
    """
    minus = d(fmpz_poly([0, -1]))
    if kind is Kind.PR:
        return add(scaled(n, minus), scaled(mirrored(n), d))
    return add(identity(len(n), d * minus), scaled(multiply(mirrored(n), n), -1))


def axis_sums(kind: Kind, n: PolynomialMatrix, d: fmpz_poly) -> Iterator[tuple[fmpz_poly, int]]:
    """For k = 1, 2, ... the sum of principal minors of order k, divided by a power of |d|^2, and the power.

    Raises
    ------
    UndecidedError
        If it would take more than MAX_WORK.

    Examples
    --------
    >>> list(axis_sums(Kind.PR, [[fmpz_poly([0, 1])]], fmpz_poly([1, 1])))  # s/(s + 1)
    [(2*x, 0)]
    """
    m, bits = len(n), max(height_bits(n), d.height_bits())
    if m**4 * (degree(n, d) + 1) * bits > MAX_WORK:
        text = f"{m} ports of degree {degree(n, d)} with {bits} bits take too long; smaller ones would be decided"
        raise UndecidedError(text)
    g = d * d(fmpz_poly([0, -1]))
    for a, power in minor_sums(hermitian_polynomial(kind, n, d), g // g.content())[0]:
        yield fmpz_poly([-c if i % 2 else c for i, c in enumerate(a.coeffs()[::2])]), power
