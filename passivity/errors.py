"""What is wrong with a given impedance, in one sentence."""

from tline.errors import InputError


class ExpressionError(InputError):
    """One mistake in a given impedance: at ``column 7``, ``parameter L``, ``numerator[2]``."""


def shorten(text: str) -> str:
    """The text as a message quotes it: at most 30 characters."""
    return text if len(text) <= 30 else text[:27] + "..."
