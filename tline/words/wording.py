"""Words of messages: place of a key, value as it was given, known words nearest to a typed one; tables of text."""

import json
import re
import reprlib
from collections.abc import Sequence

SEARCHED, LISTED = 2000, 16  # known words that are searched for a near one, and that are listed
BARE = re.compile(r"[\w-]+")  # a key that needs no quotes
_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60
_short.maxlevel = 2


def place(*parts: str | int) -> str:
    """Format the dotted place of a key, as TOML writes it; numbers are indices in lists.

    Examples
    --------
    >>> place("lines", "a.b", "nodes", 0)
    'lines."a.b".nodes[0]'
    """
    text = ""
    for part in parts:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += "." * bool(text) + (part if BARE.fullmatch(part) else json.dumps(part, ensure_ascii=False))
    return text


def shown(value: object) -> str:
    """Format a value for a message: short, however large or deep it is."""
    try:
        text = _short.repr(value)
    except ValueError:  # an integer of too many digits
        text = f"a very large {type(value).__name__}"
    return text if len(text) <= 60 else text[:50] + "…"


def nearest(word: object, known: list[str]) -> str:
    """Find the known word a user probably meant; all of them, or some, if none is near."""
    if len(known) <= SEARCHED:
        from difflib import get_close_matches

        lower = {name.lower(): name for name in known}
        close = get_close_matches(str(word).lower(), lower, n=1)
        if close:
            return f"'{lower[close[0]]}'"
    return listed(known)


def listed(known: list[str]) -> str:
    """List all known words, or some."""
    return "one of " * (len(known) > 1) + first_of([f"'{name}'" for name in known], LISTED)


def first_of(words: Sequence[str], most: int) -> str:
    """Join the first words, and say how many more there are.

    Examples
    --------
    >>> first_of(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    return ", ".join(words[:most]) + f" and {len(words) - most} more" * (len(words) > most)


def aligned(rows: Sequence[Sequence[str]], words: int) -> list[str]:
    """Align rows in columns of one width, the first ones of words to the left and numbers to the right.

    Examples
    --------
    >>> print(*aligned([["name", "size"], ["a", "1.5"]], 1), sep="\\n")
    name  size
    a      1.5
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if k < words else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]


# C0 and C1 controls but tab and line feed, line and paragraph separators, and reversals of the writing direction
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
BREAK = re.compile(rf"(?:\s|{CONTROL.pattern})+")


def printable(text: str) -> str:
    r"""Write control characters in a text as ``\u001b``, the escape for the character in JSON.

    Examples
    --------
    >>> printable("red \x1b[31m, next\n")
    'red \\u001b[31m, next\n'
    """
    return CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def one_line(text: str) -> str:
    r"""Replace control characters and line breaks in a text by spaces.

    Examples
    --------
    >>> one_line(" A \x1b[2Jtitle\nin two lines")
    'A [2Jtitle in two lines'
    """
    return BREAK.sub(" ", text).strip()
