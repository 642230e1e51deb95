"""Assumptions on names: parameters lie in an interval, as ``R > 0`` or ``k real`` say, functions are passive."""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from random import Random

from passivity.calculus.fact import BOUNDED_REAL, POSITIVE_REAL, Fact
from passivity.errors import ExpressionError, shorten, shown
from passivity.expression.number import written
from passivity.expression.parse import parse
from passivity.expression.tree import Symbol
from passivity.rational.evaluate import exact

_FORMS = "a form such as R > 0, R >= 0, k real, 0 < k < 1 or R = 50"
_MAX_CHARACTERS = 1_000
_AT_AN_END = 0.1  # how often
_SPREADS = (1, 2, 6)  # decades
_STEPS = [Fraction(x) for x in ("2", "1/2", "10", "1/10", "9/10", "11/10", "100", "1/100", "1000", "1/1000")]
_OPAQUE = re.compile(r"\s*([^\W\d]\w*)\s+(?:(pr|positive real)|br|bounded real)\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Range:
    """The values a parameter may have.

    Parameters
    ----------
    name : str
    low, high : Fraction or None
        The ends, None where unbounded; equal for a parameter with a value.
    open_low, open_high : bool
        Whether the end itself is left out.
    """

    name: str
    low: Fraction | None = None
    high: Fraction | None = None
    open_low: bool = False
    open_high: bool = False

    @property
    def is_point(self) -> bool:
        """Whether there is one value only."""
        return self.low is not None and self.low == self.high

    @property
    def fact(self) -> tuple[str, Fraction | float, Fraction | float]:
        """The range as a fact of the calculus."""
        low, high = -math.inf if self.low is None else self.low, math.inf if self.high is None else self.high
        return "real", low, high

    def __contains__(self, value: Fraction) -> bool:
        above = self.low is None or value > self.low or (value == self.low and not self.open_low)
        return above and (self.high is None or value < self.high or (value == self.high and not self.open_high))

    def meet(self, other: "Range") -> "Range | None":
        """Return the intersection with another range; None if it is empty."""
        low, open_low = max(((r.low, r.open_low) for r in (self, other) if r.low is not None), default=(None, False))
        high, shut = min(((r.high, not r.open_high) for r in (self, other) if r.high is not None), default=(None, True))
        if low is not None and high is not None and (low > high or (low == high and (open_low or not shut))):
            return None
        return Range(self.name, low, high, open_low, not shut)

    def __str__(self) -> str:
        low, high = ("" if end is None else written(end) for end in (self.low, self.high))
        if self.is_point:
            return f"{self.name} = {low}"
        below, above = "<" if self.open_low else "<=", "<" if self.open_high else "<="
        if self.low is None:
            return f"{self.name} real" if self.high is None else f"{self.name} {above} {high}"
        if self.high is None:
            return f"{self.name} {'>' if self.open_low else '>='} {low}"
        return f"{low} {below} {self.name} {above} {high}"


def parse_assumption(text: str) -> Range:
    """The interval that a text such as ``R > 0`` leaves to a parameter.

    Parameters
    ----------
    text : str
        ``NAME real``, or NAME and numbers between ``<``, ``<=``, ``>``, ``>=`` or ``=``, one number on each side at
        most. Numbers as in an expression, with prefix and unit if any: ``C < 4 pF``.

    Raises
    ------
    ExpressionError
        For anything else, and where no value is left.

    Examples
    --------
    >>> print(parse_assumption("0<k<1/2"), "-", parse_assumption("k real"), "-", parse_assumption("C = 4 pF"))
    0 < k < 1/2 - k real - C = 1/250000000000
    """
    if not isinstance(text, str) or len(text) > _MAX_CHARACTERS:
        raise ExpressionError("assumption", "not an assumption", _FORMS, shorten(shown(text, repr)))
    where = f"assumption {shorten(text.strip())}"
    if real := re.fullmatch(r"\s*(\S+)\s+real\s*", text):
        return Range(_name(real[1], where))
    sides = re.split(r"(<=|>=|<|>|=)", text)
    middle = next((k for k in range(0, len(sides), 2) if _is_name(sides[k])), None)
    if middle is None or len(sides) not in (3, 5) or (len(sides) == 5 and middle != 2):
        raise ExpressionError(where, "this says nothing of one parameter", _FORMS)
    name, found = _name(sides[middle], where), None
    for k in range(1, len(sides), 2):
        relation, number = sides[k], exact(sides[k + 1] if k > middle else sides[k - 1], where)
        if relation == "=":
            one = Range(name, number, number)
        elif (relation[0] == ">") == (k > middle):
            one = Range(name, low=number, open_low=len(relation) == 1)
        else:
            one = Range(name, high=number, open_high=len(relation) == 1)
        found = meet(found, one)
    assert found
    return found


def collect(assumptions: Iterable[str | Range]) -> dict[str, Range]:
    """The range of each parameter that is named; several assumptions on one hold together."""
    if isinstance(assumptions, str):
        raise ExpressionError("assumptions", "one text", "a list of texts", shorten(shown(assumptions, repr)))
    ranges: dict[str, Range] = {}
    for given in assumptions:
        one = given if isinstance(given, Range) else parse_assumption(given)
        ranges[one.name] = meet(ranges.get(one.name), one)
    return ranges


def assumed(assume: Iterable[str]) -> tuple[dict[str, Fact], list[Range]]:
    """Return the assumption on each name as a fact, and the range of constants that satisfy it."""
    opaque: dict[str, Fact] = {}
    ranges: list[str | Range] = []
    for text in assume:
        if isinstance(text, str) and (found := _OPAQUE.fullmatch(text)):
            if found[1] == "s":
                raise ExpressionError(f"assumption {text.strip()}", "s is the Laplace variable", "another name")
            opaque[found[1]] = POSITIVE_REAL if found[2] else BOUNDED_REAL
        else:
            ranges.append(text)
    known = collect(ranges)
    if both := opaque.keys() & known.keys():
        raise ExpressionError(f"assumption {min(both)}", "a function and a number at once", "one of them")
    ends = {name: (fact[1], None if fact == POSITIVE_REAL else fact[2]) for name, fact in opaque.items()}
    constants = [*known.values(), *(Range(name, low, high, True, True) for name, (low, high) in ends.items())]
    return {name: r.fact for name, r in known.items()} | opaque, constants


def meet(first: Range | None, second: Range) -> Range:
    """Return the intersection of two ranges, the second if the first is None; raise an error if it is empty."""
    both = first.meet(second) if first else second
    if both is None:
        raise ExpressionError(f"parameter {second.name:.60}", f"no value has {first} and {second}", "other assumptions")
    return both


def _is_name(text: str) -> bool:
    return bool(re.fullmatch(r"\s*[^\W\d]\w*\s*", text))


def _name(text: str, where: str) -> str:
    name = text.strip()
    if not (_is_name(text) and (name.isascii() or isinstance(parse(name), Symbol))):
        raise ExpressionError(where, "not a name", "one name of the expression", repr(shorten(name)))
    if name == "s":
        raise ExpressionError(where, "s is the Laplace variable", "a parameter")
    return name


def trials(ranges: tuple[Range, ...]) -> Iterator[dict[str, Fraction]]:
    """Round numbers first, each parameter in turn far from the others, then random ones; the same each time."""
    middle = {r.name: _at(r, Fraction(1)) for r in ranges}
    yield middle
    for r in ranges:
        yield from (middle | {r.name: x} for x in _choices(r))
    yield from islice(random_values(ranges), 1, None)


def random_values(ranges: Sequence[Range]) -> Iterator[dict[str, Fraction]]:
    """Values in the middle of the ranges, then random ones without end; without ranges none but {}."""
    yield {r.name: _at(r, Fraction(1)) for r in ranges}
    random = Random(0)
    while ranges:
        for decades in _SPREADS:
            yield {r.name: _any(r, random, decades) for r in ranges}


def _choices(r: Range) -> list[Fraction]:
    """Values that are tried first."""
    two = r.low is None and r.high is None
    steps = [Fraction(1), *_STEPS]
    return [_at(r, u) for u in _STEPS] + _ends(r) + ([-u for u in steps] if two else [])


def _any(r: Range, random: Random, decades: int) -> Fraction:
    ends = _ends(r)
    if ends and random.random() < _AT_AN_END:
        return random.choice(ends)
    u = random.randint(1, 99) * Fraction(10) ** random.randint(-decades, decades) / 10
    x = _at(r, u)
    return -x if r.low is None and r.high is None and random.random() < 0.5 else x


def _ends(r: Range) -> list[Fraction]:
    """The ends that belong to a range; 0 for all real numbers."""
    if r.low is None and r.high is None:
        return [Fraction(0)]
    return [end for end, shut in ((r.low, not r.open_low), (r.high, not r.open_high)) if end is not None and shut]


def _at(r: Range, u: Fraction) -> Fraction:
    """Map u > 0 to a point of a range, as in `Domain`."""
    if r.low is not None and r.high is not None:
        return (r.low + r.high * u) / (1 + u)
    if r.high is not None:
        return r.high - u
    return u if r.low is None else r.low + u
