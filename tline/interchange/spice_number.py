"""Values of SPICE netlists: numbers, parameters, expressions in braces or quotes."""

import math
from collections.abc import Mapping

from tline.errors import InputError
from tline.interchange.spice_expression import expression, number

Parameters = Mapping[str, float]  # names in lower case

LONGEST = 1000  # characters of an expression


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
    if word[:1] in ("{", "'", '"'):
        value = _computed(word[1:-1], parameters, where)
    else:
        value = parameters.get(word.lower(), number(word))
    if value is None:
        raise InputError(where, "not a value", "a number as 4.7n, a parameter, or {an expression}", f"'{word:.40}'")
    if not math.isfinite(value):
        raise InputError(where, "out of range", "a finite number", f"'{word:.40}'")
    return value


def _computed(text: str, parameters: Parameters, where: str) -> float:
    if len(text) > LONGEST:
        raise InputError(where, "an expression that long", f"at most {LONGEST} characters", f"{len(text)}")
    try:
        return expression(text, parameters)
    except (ValueError, ArithmeticError) as error:
        raise InputError(where, f"not an expression that can be computed: {error}", got=f"'{text:.40}'") from None
