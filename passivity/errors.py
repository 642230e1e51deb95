"""Errors in given impedances, in one sentence each."""

from collections.abc import Callable

from tline.errors import InputError


class ExpressionError(InputError):
    """One mistake in a given impedance: at ``column 7``, ``parameter L``, ``numerator[2]``."""

    def within(self, where: str) -> "ExpressionError":
        """Prefix the place of the mistake by that of the whole."""
        place = ", ".join(x for x in (where, self.where) if x)
        return ExpressionError(place, self.problem, self.expected, self.got)


def shown(given: object, write: Callable[[object], str] = str) -> str:
    """Quote an argument in a message: at most 60 characters in one line, by `str` or `repr`.

    Examples
    --------
    >>> shown("-1 ohm"), shown([1, 2], repr), shown(10**5000)
    ('-1 ohm', '[1, 2]', 'int of over 4300 digits')
    """
    try:
        return " ".join(write(given)[:200].split())[:60]
    except ValueError:  # Python writes no longer ones
        return f"{type(given).__name__} of over 4300 digits"


def shorten(text: str, length: int = 30) -> str:
    """The text as a message quotes it: at most 30 characters, or another length."""
    return text if len(text) <= length else text[: length - 3] + "..."
