"""Are all roots of a polynomial in the open left half plane? Routh's column in ball arithmetic.

References
----------
F. R. Gantmacher, "The Theory of Matrices", vol. 2, chapter XV (Routh's scheme, Hurwitz determinants).
"""

from collections.abc import Iterator

from flint import arb, arb_poly, ctx, fmpz_poly

from passivity.budget import spend


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
        # the precision is global to the process: what counts is the accuracy found, not asked for
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
