"""Control characters of terminals, and their visible replacements."""

import re

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
