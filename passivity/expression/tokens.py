"""The text of an expression cut into numbers, names and operators."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from passivity.errors import ExpressionError

_LETTERS = r"A-Za-z_\u00b5\u03bc\u03a9\u2126"  # micro, mu, omega and ohm sign count as letters
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"|(?P<name>[{_LETTERS}][{_LETTERS}0-9]*)|(?P<operator>\*\*|[-+*/^(),])|(?P<end>\Z)|(?P<other>.))",
    re.DOTALL,
)


class Token(NamedTuple):
    """One piece of the text; `column` counts from 1, `spaced` tells of white space before it."""

    kind: str  # number, name, operator, end
    text: str
    column: int
    spaced: bool


def tokens(text: str) -> Iterator[Token]:
    """All tokens of a text, the end of the text being the last.

    Examples
    --------
    >>> [token.text for token in tokens("10 nH*s")]
    ['10', 'nH', '*', 's', '']
    """
    for found in _TOKEN.finditer(text):
        kind = str(found.lastgroup)
        start = found.start(kind)
        if kind == "other":
            raise ExpressionError(
                f"column {start + 1}",
                "this character has no meaning here",
                "a number, a name, an operator or a parenthesis",
                f"{text[start]!a} (U+{ord(text[start]):04X})",
            )
        yield Token(kind, found[kind], start + 1, start > found.start())
