"""What is assumed of names: of parameters that they are in a range, of functions that they have a property."""

import re
from collections.abc import Iterable
from fractions import Fraction

from passivity.calculus.graph import BOUNDED_REAL, POSITIVE_REAL, Fact
from passivity.errors import ExpressionError
from passivity.symbolic.assumption import Range, collect

_OPAQUE = re.compile(r"\s*([^\W\d]\w*)\s+(?:(pr|positive real)|br|bounded real)\s*", re.IGNORECASE)


def assumed(assume: Iterable[str]) -> tuple[dict[str, Fact], list[Range]]:
    """What is assumed of each name, as facts, and the constants that each may be.

    Examples
    --------
    >>> assumed(["R > 0", "H bounded real"])[0]["R"]
    ('real', Fraction(0, 1), inf)
    """
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
    facts: dict[str, Fact] = {name: r.fact for name, r in known.items()}
    if both := opaque.keys() & facts.keys():
        raise ExpressionError(f"assumption {min(both)}", "a function and a number at once", "one of them")
    unit = Fraction(1)
    constants = list(known.values())
    for name, fact in opaque.items():
        low, high = (Fraction(0), None) if fact == POSITIVE_REAL else (-unit, unit)
        constants.append(Range(name, low, high, True, True))
    return facts | opaque, constants
