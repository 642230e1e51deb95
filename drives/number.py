"""Numbers as they were typed: 0.1 is one tenth; and roots of exact polynomials, certain by ball arithmetic."""

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from numbers import Rational, Real
from typing import Any

from flint import acb, arb, ctx, fmpq, fmpq_poly, fmpz_poly

from tline.errors import InputError

Number = float | Fraction  # accepted types
SMALLEST, LARGEST = Fraction(1, 10**30), Fraction(10**30)
LONGEST = 400  # bits of a fraction
SHOWN = 40  # letters of a given value, in a message


def exact(value: object, where: str) -> Fraction:
    """The number as a fraction.

    Examples
    --------
    >>> exact(0.1, "radius")
    Fraction(1, 10)
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(where, "not a number", "a real number in SI units", repr(value)[:SHOWN])
    if isinstance(value, Rational):
        found = Fraction(int(value.numerator), int(value.denominator))
    elif math.isfinite(float(value)):
        found = Fraction(repr(float(value)))
    else:
        raise InputError(where, "not finite", "a real number in SI units", repr(value)[:SHOWN])
    if abs(found) > LARGEST or max(abs(found.numerator), found.denominator).bit_length() > LONGEST:
        if 0 < abs(found) < SMALLEST or abs(found) > LARGEST:
            raise InputError(where, "out of reach", "a size from 1e-30 to 1e30, or 0", repr(value)[:SHOWN])
        raise InputError(where, "too many digits", f"at most {LONGEST} bits")
    return found


def positive(value: object, where: str, *, or_zero: bool = False) -> Fraction:
    """Return a number as a fraction; raise an error unless it is positive (or zero) and not tiny."""
    found = exact(value, where)
    if found < 0 or (found == 0 and not or_zero):
        raise InputError(where, "not physical", "0 or more" if or_zero else "more than 0", repr(value)[:SHOWN])
    if 0 < found < SMALLEST:
        raise InputError(where, "out of reach", "a size from 1e-30 to 1e30", repr(value)[:SHOWN])
    return found


def rational(value: Fraction) -> fmpq:
    """Convert a Fraction to a number of flint."""
    return fmpq(value.numerator, value.denominator)


def finite(values: Iterable[object], where: str) -> list[float]:
    """The numbers as floats."""
    found = []
    for k, value in enumerate(values):
        if not (isinstance(value, float) and 0 < abs(value) < SMALLEST):  # what is so small will do as it is
            value = float(exact(value, f"{where}[{k}]"))
        found.append(value)
    return found


def fill(part: object, **fields: object) -> None:
    """Set the fields of a frozen dataclass from its `__init__`."""
    for name, value in fields.items():
        object.__setattr__(part, name, value)


def written(z: complex) -> str:
    """A complex number for the eye."""
    return f"{z.real:.6g}" if z.imag == 0 else f"{z.real:.6g} {'+' if z.imag > 0 else '−'} {abs(z.imag):.6g}j"


def known_names(where: str, given: Sequence[str], known: Sequence[str]) -> None:
    """Refuse names that are not known, and no names at all."""
    if isinstance(given, str) or not isinstance(given, Sequence) or not given:
        raise InputError(where, "no names", f"some of {', '.join(known)}", repr(given)[:40])
    for name in given:
        if not isinstance(name, str) or name not in known:
            raise InputError(where, "unknown name", " or ".join(known), repr(name)[:40])


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
