"""What is assumed of names: of parameters that they are in a range, of functions that they have a property."""

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

from passivity.calculus.graph import BOUNDED_REAL, POSITIVE_REAL, Fact
from passivity.errors import ExpressionError
from passivity.symbolic.assumption import Range, collect

_OPAQUE = re.compile(r"\s*([^\W\d]\w*)\s+(?:(pr|positive real)|br|bounded real)\s*", re.IGNORECASE)


def assumed(assume: Iterable[str]) -> dict[str, Fact]:
    """What is assumed of each name, as facts.

    Examples
    --------
    >>> assumed(["R > 0", "H bounded real"])["R"]
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
    facts: dict[str, Fact] = {name: r.fact for name, r in collect(ranges).items()}
    if both := opaque.keys() & facts.keys():
        raise ExpressionError(f"assumption {min(both)}", "a function and a number at once", "one of them")
    return facts | opaque


def ranges_of(facts: Mapping[str, Fact], assume: Iterable[str | Range]) -> list[Range]:
    """The constants that the names may be."""
    known = collect(x for x in assume if not (isinstance(x, str) and _OPAQUE.fullmatch(x)))
    unit = Fraction(1)
    opaque = {POSITIVE_REAL: (Fraction(0), None), BOUNDED_REAL: (-unit, unit)}
    found = []
    for name, fact in facts.items():
        low, high = opaque.get(fact, (None, None))
        found.append(known[name] if name in known else Range(name, low, high, True, True))
    return found
