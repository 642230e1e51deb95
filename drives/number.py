"""Numbers as they were typed: a float counts as the shortest decimal that names it, so 0.1 is one tenth."""

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from numbers import Rational, Real

from flint import fmpq

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
