"""Square matrices of integer polynomials, and the signs that count on the axis as polynomials in x = w^2.

A Hermitian matrix F is nonnegative if and only if, for each k, the sum of its principal minors of order k is: these
are the coefficients of det(t + F), whose roots are real. That takes m signs, not 2^m.
"""

from collections.abc import Iterator
from typing import TypeAlias

from flint import fmpz_poly

from passivity.budget import spend
from passivity.polynomial.sign import UndecidedError
from passivity.status import Kind

PolynomialMatrix: TypeAlias = list[list[fmpz_poly]]
MAX_WORK = 100_000_000  # ports^4 degree bits: up to ten seconds


def identity(size: int, scale: fmpz_poly) -> PolynomialMatrix:
    """The unit matrix times a polynomial."""
    return [[scale if i == j else fmpz_poly() for j in range(size)] for i in range(size)]


def add(a: PolynomialMatrix, b: PolynomialMatrix) -> PolynomialMatrix:
    """a + b."""
    return [[x + y for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]


def scaled(a: PolynomialMatrix, factor: fmpz_poly | int) -> PolynomialMatrix:
    """The matrix times a polynomial."""
    return [[x * factor for x in row] for row in a]


def multiply(a: PolynomialMatrix, b: PolynomialMatrix) -> PolynomialMatrix:
    """a b."""
    m, long = len(a), height_bits(a) + height_bits(b)
    top = 1 + max(x.degree() for rows in (a, b) for row in rows for x in row)
    spend(m**3 * (2_000 + 5 * (top + 1) * long), f"a product of matrices with {m} ports of degree {top}")
    columns = list(zip(*b, strict=True))
    return [[sum((x * y for x, y in zip(row, c, strict=True)), fmpz_poly()) for c in columns] for row in a]


def mirrored(a: PolynomialMatrix) -> PolynomialMatrix:
    """a(-s)^T, which on the imaginary axis is a(s)^H."""
    minus = fmpz_poly([0, -1])
    return [[x(minus) for x in column] for column in zip(*a, strict=True)]


def degree(n: PolynomialMatrix, d: fmpz_poly) -> int:
    """Largest degree in a matrix n/d."""
    return max(d.degree(), *(x.degree() for row in n for x in row))


def height_bits(a: PolynomialMatrix) -> int:
    """Length of the longest coefficient."""
    return max(x.height_bits() for row in a for x in row)


def minor_sums(a: PolynomialMatrix, g: fmpz_poly) -> tuple[list[tuple[fmpz_poly, int]], tuple[PolynomialMatrix, int]]:
    """Sums of all principal minors of order 1, 2, ..., m, the last being the determinant; and the adjugate.

    Faddeev's and Leverrier's scheme, whose divisions are exact. Each result comes without a power of g, and with that
    power. Where a is a matrix of rational functions times their common denominator g, minors of order k mostly hold
    the power k - 1 of it; divided out at once, it does not make the numbers grow. The coefficients of g are coprime.
    """
    m, power = len(a), 0
    sums, adjugate = [], identity(m, fmpz_poly([1]))
    for k in range(1, m + 1):
        product = multiply(a, adjugate)
        total = sum((product[i][i] for i in range(m)), fmpz_poly()) // k
        sums.append(_reduced(total, g, power))
        if k < m:
            adjugate = add(identity(m, total), scaled(product, -1))
            if divided := _divided(adjugate, g):
                adjugate, power = divided, power + 1
    return sums, (adjugate, power)


def _reduced(f: fmpz_poly, g: fmpz_poly, power: int) -> tuple[fmpz_poly, int]:
    """f without all powers of g, and how many there are in f g^power."""
    while f and g.degree() > 0:
        quotient, rest = divmod(f, g)
        if rest:
            break
        f, power = quotient, power + 1
    return f, power


def _divided(a: PolynomialMatrix, g: fmpz_poly) -> PolynomialMatrix | None:
    """a/g if all entries can be divided by it."""
    if g.degree() < 1 or any(x % g for row in a for x in row):
        return None
    return [[x // g for x in row] for row in a]


def hermitian_polynomial(kind: Kind, n: PolynomialMatrix, d: fmpz_poly) -> PolynomialMatrix:
    """On the axis |d|^2 (Z + Z^H), or |d|^2 (I - S^H S), where Z or S is n/d."""
    minus = d(fmpz_poly([0, -1]))
    if kind is Kind.PR:
        return add(scaled(n, minus), scaled(mirrored(n), d))
    return add(identity(len(n), d * minus), scaled(multiply(mirrored(n), n), -1))


def check_work(ports: int, degree: int, bits: int, most: int) -> None:
    """Raise UndecidedError if the sums of minors would take more than that."""
    if ports**4 * (degree + 1) * bits > most:
        text = f"{ports} ports of degree {degree} with {bits} bits take too long; smaller ones would be decided"
        raise UndecidedError(text)


def axis_sums(kind: Kind, n: PolynomialMatrix, d: fmpz_poly) -> Iterator[tuple[fmpz_poly, int]]:
    """For k = 1, 2, ... the sum of principal minors of order k, divided by a power of |d|^2, and the power."""
    check_work(len(n), degree(n, d), max(height_bits(n), d.height_bits()), MAX_WORK)
    g = d * d(fmpz_poly([0, -1]))
    for a, power in minor_sums(hermitian_polynomial(kind, n, d), g // g.content())[0]:
        yield fmpz_poly([-c if i % 2 else c for i, c in enumerate(a.coeffs()[::2])]), power
