"""Characters that steer a terminal, and what is shown in their place."""

import re

# C0 and C1 controls but tab and line feed, line and paragraph separators, and what turns the direction of writing
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
BREAK = re.compile(rf"(?:\s|{CONTROL.pattern})+")


def printable(text: str) -> str:
    r"""Text in which control characters are written as ``\u001b``, as in JSON, where that stands for the character.

    Examples
    --------
    >>> printable("red \x1b[31m, next\n")
    'red \\u001b[31m, next\n'
    """
    return CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def one_line(text: str) -> str:
    r"""Text without control characters and line breaks; a space stands for them.

    Examples
    --------
    >>> one_line(" A \x1b[2Jtitle\nin two lines")
    'A [2Jtitle in two lines'
    """
    return BREAK.sub(" ", text).strip()
