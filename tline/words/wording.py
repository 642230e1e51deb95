"""Words of messages: the place of a key, a value as it was given, and the known words nearest to a typed one."""

import json
import re
import reprlib
from difflib import get_close_matches

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
        lower = {name.lower(): name for name in known}
        close = get_close_matches(str(word).lower(), lower, n=1)
        if close:
            return f"'{lower[close[0]]}'"
    return listed(known)


def listed(known: list[str]) -> str:
    """List all known words, or some."""
    words = ", ".join(f"'{name}'" for name in known[:LISTED])
    return "one of " * (len(known) > 1) + words + f" and {len(known) - LISTED} more" * (len(known) > LISTED)
