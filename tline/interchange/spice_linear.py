"""Sources by an expression, B and E, F, G, H with VALUE or POLY, as sums of sources that one signal each commands."""

import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from math import isfinite
from typing import NamedTuple

from tline.errors import InputError
from tline.interchange.deck import Card, Findings
from tline.interchange.spice_expression import SIGNAL, computed, number

LAW = re.compile(r"(?<![\w.])(value(?=\s*[={'])|(?:vol|cur|v|i)(?=\s*=))\s*=?\s*(.+)", re.IGNORECASE)
BY_LAW = "LAW"  # behind the nodes of such a source; then V or I, and the expression in braces
EXPECTED = "a sum of v(…) and i(…) with constant factors; else kind = 'table' in a scene"
TRANSFERS = ("LAPLACE", "TABLE", "FREQ", "CHEBYSHEV", "DELAY", "PWL", "OPAMP", "POLE", "FOSTER")
MOST_DIMENSIONS = 100
PIECES = 64  # of a run, in which a law of time is looked at first
PLACES = (0.31, 0.62)  # in a piece, where it is compared with a straight line; no halves, for laws may repeat
BENT = 1e-4  # of its largest value: how far from a law the lines may be
JUMP = 1e-9  # of a run: how long a jump may take
STRAIGHT = 1e-6  # of that distance: points so near to a line are not kept
MOST_POINTS = 20_000


class Linear(NamedTuple):
    """A constant, and the factors of signals by their texts."""

    constant: float
    factors: dict[str, float]

    def __add__(self, other):
        if not isinstance(other, Linear):
            return Linear(self.constant + other, self.factors)
        keys = [*self.factors, *(key for key in other.factors if key not in self.factors)]
        factors = {key: self.factors.get(key, 0.0) + other.factors.get(key, 0.0) for key in keys}
        return Linear(self.constant + other.constant, factors)

    def __mul__(self, other):
        if isinstance(other, Linear):
            raise TypeError
        return Linear(self.constant * other, {key: value * other for key, value in self.factors.items()})

    def __neg__(self):
        return self * -1.0

    def __sub__(self, other):
        return self + -other

    def __rsub__(self, other):
        return -self + other

    def __truediv__(self, other):
        if isinstance(other, Linear):
            raise TypeError
        return Linear(self.constant / other, {key: value / other for key, value in self.factors.items()})

    def __bool__(self):
        raise TypeError

    __radd__, __rmul__ = __add__, __mul__
    __lt__ = __gt__ = __le__ = __ge__ = __eq__ = __ne__ = __hash__ = None  # type: ignore[assignment]


def law_words(card: Card) -> list[str] | None:
    """Words of a source by an expression or a polynomial in one form; nothing of another card."""
    if card.kind not in "BEFGH" or len(card.words) < 3:
        return None
    effort, nodes = "V" if card.kind in "EH" else "I", card.words[:2]
    if card.words[2].upper() == "POLY":
        return [*nodes, BY_LAW, effort, f"{{{_polynomial(card)}}}"]
    if card.words[2].upper() in TRANSFERS:
        raise card.refuse(f"{card.words[2].upper()} is not known here", EXPECTED)
    law = LAW.search(card.text)
    if card.kind == "B":
        if law is None:
            raise card.refuse("a behavioural source without a law", "V=… or I=…", f"'{card.text:.40}'")
        return [*nodes, BY_LAW, law[1][0].upper() if law[1].lower() != "cur" else "I", _braced(law[2])]
    if card.kind in "EG" and law and law[1].lower() not in ("v", "i"):
        return [*nodes, BY_LAW, effort, _braced(law[2])]
    if card.kind in "EG" and len(card.words) == 3:
        return [*nodes, BY_LAW, effort, _braced(card.words[2])]
    return None


def _braced(text: str) -> str:
    text = text.strip()
    return f"{{{text[1:-1] if text[0] + text[-1] in ('{}', chr(39) * 2, chr(34) * 2) else text}}}"


def _polynomial(card: Card) -> str:
    """Convert a polynomial of first degree to an expression."""
    n = number(card.words[3]) if len(card.words) > 3 else None
    width = 2 if card.kind in "EG" else 1
    if n is None or not 1 <= n <= MOST_DIMENSIONS or len(card.words) < 5 + width * int(n):
        raise card.refuse("a polynomial that is not whole", "POLY(1), what commands it, and numbers")
    end = 4 + width * int(n)
    names, coefficients = card.words[4:end], [word.strip("{}'") for word in card.words[end:]]
    if any(number(word) != 0 for word in coefficients[int(n) + 1 :]):
        raise card.refuse("a polynomial of a higher degree", EXPECTED, f"'{' '.join(card.words):.60}'")
    signals = [f"v({a},{b})" for a, b in zip(names[::2], names[1::2], strict=True)] if width == 2 else []
    signals = signals or [f"i({name})" for name in names]
    offset, *factors = coefficients if len(coefficients) > 1 else ["0", *coefficients]
    return " + ".join([f"({offset})", *(f"({f})*{signal}" for f, signal in zip(factors, signals, strict=False))])


def with_outside_names(words: list[str], node: Callable[[str], str], source: Callable[[str], str]) -> list[str]:
    """Such words with the names that nodes and sources have outside of a subcircuit."""

    def renamed(found: re.Match) -> str:
        names = re.split(r"[\s,]+", found[0][2:-1].strip())
        return f"{found[0][0]}({','.join(map(node if found[0][0] in 'vV' else source, names))})"

    return [*map(node, words[:2]), *words[2:4], re.sub(SIGNAL, renamed, words[4], flags=re.IGNORECASE)]


def with_linear_sources(cards: list[Card], found: Findings, end: float) -> list[Card]:
    """The cards, with several E, F, G, H, V and I in place of each source by a linear expression.

    One of the time alone becomes the straight lines that are near it up to the end of the run.
    """
    result: list[Card] = []
    for card in cards:
        if card.words[2:3] != [BY_LAW]:
            result.append(card)
            continue
        with found.gathered():
            text = card.words[4][1:-1]
            if re.search(r"\btime\b", text, re.IGNORECASE) and not re.search(SIGNAL, text, re.IGNORECASE):
                result.append(_over_time(card, text, end, found))
                continue
            try:
                value = computed(text, card.parameters, card.where, lambda signal: Linear(0.0, {signal: 1.0}))
            except InputError as error:
                raise card.refuse(error.problem, EXPECTED, error.got) from None
            result += _expanded(card, value if isinstance(value, Linear) else Linear(value, {}))
    return result


def _over_time(card: Card, text: str, end: float, found: Findings) -> Card:
    """A source of straight lines, bisected until they are within BENT of the largest value of the law."""

    def law(t: float) -> float:
        value = float(computed(text, {**card.parameters, "time": t}, card.where))
        if not isfinite(value):
            raise card.refuse("not finite at all times", "a finite law", f"{value:g} at {t:g} s")
        return value

    points = {t: law(t) for t in (end * k / PIECES for k in range(PIECES + 1))}
    near = BENT * max(map(abs, points.values()))
    left = [*pairwise(points)]
    while left:
        first, last = left.pop()
        inner = [first + (last - first) * part for part in PLACES]
        points |= {t: law(t) for t in inner}
        straight = [points[first] + (points[last] - points[first]) * part for part in PLACES]
        bent = any(abs(points[t] - line) > near for t, line in zip(inner, straight, strict=True))
        if bent and last - first > JUMP * end:
            left += pairwise([first, *inner, last])
        if len(points) > MOST_POINTS:
            raise card.refuse("a law of time that bends too often", f"at most {MOST_POINTS} points", f"'{text:.40}'")
    corners = _corners(sorted(points.items()), near)
    found.note(card.where, f"its law of time is {len(corners)} points, within {BENT:g} of its largest value")
    words = [repr(x) for point in corners for x in point]
    return card._replace(kind=card.words[3], words=[*card.words[:2], "PWL", *words])


def _corners(points: list[tuple[float, float]], near: float) -> list[tuple[float, float]]:
    """Points without those that lie on the straight line between the last that is kept and the next."""
    kept = points[:1]
    for (t, u), (after, end) in pairwise(points[1:]):
        start, begin = kept[-1]
        if abs(begin + (end - begin) * (t - start) / (after - start) - u) > near * STRAIGHT:
            kept.append((t, u))
    return [*kept, points[-1]]


def _expanded(card: Card, terms: Linear) -> Iterator[Card]:
    """Voltages in a row between the nodes, or currents side by side."""
    first, last, _, effort, _ = card.words
    parts: list[tuple[str, list[str]]] = []
    for signal, factor in terms.factors.items():
        names = re.split(r"[\s,]+", signal[2:-1].strip())
        if factor and signal[0] == "v":
            ends = [*names, "0"][:2]
            parts.append(("E" if effort == "V" else "G", [*ends, repr(factor)]))
        elif factor:
            parts.append(("H" if effort == "V" else "F", [names[0], repr(factor)]))
    if terms.constant or not parts:
        parts.append((effort, [repr(terms.constant)]))
    for k, (kind, words) in enumerate(parts, 1):
        name = card.name if len(parts) == 1 else f"{card.name}.{k}"
        after = last if k == len(parts) or effort == "I" else f"{card.name}.n{k}"
        yield card._replace(name=name, kind=kind, words=[first, after, *words])
        first = after if effort == "V" else first
