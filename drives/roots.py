"""Roots of exact polynomials: isolated in ball arithmetic, so multiplicities, zeros and real parts of 0 are certain."""

from typing import Any

from flint import acb, arb, ctx, fmpq_poly, fmpz_poly

BITS = 64  # of each part of a root


def roots(polynomial: fmpq_poly) -> list[complex]:
    """All roots with their multiplicity, each part within 1 ulp; by real part, then imaginary part.

    Roots on the imaginary axis have real part 0 if the polynomial has no roots s and -s off it, as is so for every
    passive system.

    Examples
    --------
    >>> roots(fmpq_poly([0, 0, 4, 0, 1]))
    [-2j, 0j, 0j, 2j]
    """
    p = polynomial.numer()
    if p.degree() < 1:
        return []
    mirrored = fmpz_poly([c if k % 2 == 0 else -c for k, c in enumerate(p.coeffs())])
    both = p.gcd(mirrored)  # of the roots s that have -s beside them
    coefficients = both.coeffs()
    zeros = next(k for k, c in enumerate(coefficients) if c)
    squares = _accurate(fmpz_poly(coefficients[zeros::2]), square_root=True)
    found = [0j] * zeros + squares + [0 - z for z in squares] + _accurate(p // both)
    return sorted(found, key=lambda z: (z.real, z.imag))


def squared(p: fmpq_poly) -> fmpq_poly:
    """|p(j omega)|^2 as a polynomial in omega^2."""
    mirrored = fmpq_poly([c if k % 2 == 0 else -c for k, c in enumerate(p.coeffs())])
    return fmpq_poly([c if k % 2 == 0 else -c for k, c in enumerate((p * mirrored).coeffs()[::2])])


def positive_roots(p: fmpq_poly) -> list[float]:
    """Real roots above 0, without multiplicity."""
    return sorted({z.real for z in roots(p) if z.imag == 0 and z.real > 0}) if p else []


def _accurate(p: fmpz_poly, *, square_root: bool = False) -> list[complex]:
    """All roots of p, or one square root of each."""
    if p.degree() < 1:
        return []
    bits = 2 * BITS
    while True:
        with ctx.workprec(bits):
            found: Any = p.complex_roots()  # pairs of root and multiplicity
            balls = [(acb(z).sqrt() if square_root else acb(z), times) for z, times in found]
            if all(_known(part) for z, _ in balls for part in (z.real, z.imag)):
                return [complex(float(z.real), float(z.imag)) for z, times in balls for _ in range(times)]
        bits *= 2


def _known(part: arb) -> bool:
    return part == 0 or part.rel_accuracy_bits() >= BITS
