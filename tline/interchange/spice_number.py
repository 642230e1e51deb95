"""Numbers of SPICE netlists: engineering suffixes, parameters, expressions in braces."""

import math
import re
from collections.abc import Mapping

from passivity import RationalFunction
from passivity.errors import ExpressionError
from tline.errors import InputError

Parameters = Mapping[str, float]  # names in lower case

POWERS = {"t": 12, "g": 9, "meg": 6, "k": 3, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12, "f": -15, "a": -18}
MIL = 25.4e-6  # m
NUMBER = r"(\d+\.?\d*|\.\d+)(?:e([+-]?\d{1,4}))?([a-zµμ]*)"  # what follows a suffix is a unit, and ignored
EXPRESSION = re.compile(rf"(?P<number>(?<![\w.]){NUMBER})|(?P<name>[a-z_]\w*)", re.IGNORECASE)
LONGEST = 1000  # characters of an expression


def number(text: str) -> float | None:
    """Value of a number with its suffix, None if it is none.

    Examples
    --------
    >>> number("1.1n"), number("3MEGohm"), number("10pF"), number("5 ns")
    (1.1e-09, 3000000.0, 1e-11, None)
    """
    found = re.fullmatch(rf"([+-]?){NUMBER}", text, re.IGNORECASE)
    if found is None:
        return None
    sign, mantissa, exponent, letters = found.groups()
    letters = letters.lower()
    if letters.startswith("mil"):
        return float(f"{sign}{mantissa}e{exponent or 0}") * MIL
    power = POWERS["meg"] if letters.startswith("meg") else POWERS.get(letters[:1], 0)
    return float(f"{sign}{mantissa}e{int(exponent or 0) + power}")


def parse_value(word: str, parameters: Parameters, where: str) -> float:
    """Value of a number, of a parameter, or of an expression of both in braces or quotes.

    Raises
    ------
    InputError
        It is none of these, or not finite.

    Examples
    --------
    >>> parse_value("{2*Z0 + 1k}", {"z0": 50.0}, "here")
    1100.0
    """
    if word[:1] in "{'":
        value = _expression(word[1:-1], parameters, where)
    else:
        value = parameters.get(word.lower(), number(word))
    if value is None:
        raise InputError(where, "not a value", "a number as 4.7n, a parameter, or {an expression}", f"'{word:.40}'")
    if not math.isfinite(value):
        raise InputError(where, "out of range", "a finite number", f"'{word:.40}'")
    return value


def _expression(text: str, parameters: Parameters, where: str) -> float:
    """The four operations and powers, computed exactly."""
    if len(text) > LONGEST:
        raise InputError(where, "an expression that long", f"at most {LONGEST} characters", f"{len(text)}")

    def plain(found: re.Match[str]) -> str:
        value = number(found["number"]) if found["number"] else parameters.get(found["name"].lower())
        if value is None:
            raise InputError(where, "no such parameter", "its .param", f"'{found['name']:.40}'")
        return f"({value!r})"

    try:
        return float(RationalFunction.from_expression(EXPRESSION.sub(plain, text)).at_zero())
    except (ExpressionError, OverflowError) as error:
        raise InputError(where, f"not an expression that can be computed: {error}", got=f"'{text:.40}'") from None
