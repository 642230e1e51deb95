"""Facts about functions, as `passivity.verifier` has them: how sharp they are, shorter, and in words."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any, TypeAlias

from flint import fmpz

from passivity.expression.number import digits, written
from passivity.status import Kind
from passivity.verifier import disc, inverted, scaled, turn

Fact: TypeAlias = tuple[Any, ...]

POSITIVE_REAL: Fact = ("disc", Fraction(0), math.inf)
BOUNDED_REAL: Fact = ("disc", Fraction(-1), Fraction(1))
CLAIMS = {Kind.PR: POSITIVE_REAL, Kind.BR: BOUNDED_REAL}

_LONG = 256  # bits of a number in a fact that is rounded
_LONGEST_NUMBER = 30  # characters


def in_texts(fact: Fact) -> list[str]:
    """Write a fact as in files."""
    return [fact[0], *map(written, fact[1:])]


def in_words(fact: list[str]) -> str:
    """A fact in the words of the field.

    Examples
    --------
    >>> in_words(["disc", "0", "inf"]), in_words(["disc", "0", "2"]), in_words(["arg", "1/2"])
    ('positive real', 'in the disc on [0, 2]', '|arg| <= 90°*1/2')
    """
    known = {("disc", "0", "inf"): "positive real", ("disc", "-1", "1"): "bounded real", ("arg", "1"): "positive real"}
    if tuple(fact) in known:
        return known[tuple(fact)]
    kind, *ends = (x if len(x) <= _LONGEST_NUMBER else f"about {digits(_read(x), 9)}" for x in fact)
    if kind == "arg":
        return f"|arg| <= 90°*{ends[0]}"
    low, high = ends
    if kind == "real":
        return (
            f"the constant {low}"
            if low == high
            else f"a constant >= {low}"
            if high == "inf"
            else f"a constant in [{low}, {high}]"
        )
    if high == "inf":
        return f"Re >= {low}"
    return f"Re <= {high}" if low == "-inf" else f"in the disc on [{low}, {high}]"


def _read(number: str) -> Fraction:
    """A number of a file, of any length: Python itself reads some four thousand digits."""
    above, _, below = number.partition("/")
    return Fraction(int(fmpz(above)), int(fmpz(below or "1")))


def shortened(fact: Fact) -> Fact:
    """A disc without long numbers, a little larger if need be."""
    if fact[0] != "disc":
        return fact
    return ("disc", *(-_above(-x) if k == 0 else _above(x) for k, x in enumerate(fact[1:])))


def _above(x: Any) -> Any:
    """A number with few digits that is at least x."""
    if isinstance(x, float) or max(x.numerator.bit_length(), x.denominator.bit_length()) < _LONG:
        return x
    unit = Fraction(2) ** (x.numerator.bit_length() - x.denominator.bit_length() - _LONG // 4)
    return math.ceil(x / unit) * unit


def is_useful(fact: Fact) -> bool:
    """Return whether a fact restricts the values of its function."""
    return fact[0] == "arg" or fact[1] > -math.inf or fact[2] < math.inf


def inverse_of(fact: Fact) -> Fact:
    """The disc of 1/w."""
    known = disc(fact)
    ends = known and inverted(*known)
    return (fact[0] if fact[0] == "real" else "disc", *ends) if ends else ("disc", -math.inf, math.inf)


def _measure(of: Callable[[Any, Any], Any]) -> Callable[[Fact], Any]:
    """How sharp a fact is by the ends of its disc: the sharpest has the least; infinite without a disc."""

    def measured(fact: Fact) -> Any:
        known = disc(fact)
        return of(*known) if known else math.inf

    return measured


low_of = _measure(lambda low, high: -low)  # how far it reaches to the left
high_of = _measure(lambda low, high: high)
size_of = _measure(lambda low, high: max(-low, high))  # the largest modulus
width_of = _measure(lambda low, high: math.inf if math.inf in (high, -low) else high - low)  # the diameter


def angle_of(fact: Fact) -> Any:
    """The bound of the argument."""
    found = turn(fact)
    return math.inf if found is None else found


def tilt_of(fact: Fact) -> Any:
    """The angle of a function or of its negative."""
    return min(angle_of(fact), angle_of(scaled(fact, -1) or fact))
