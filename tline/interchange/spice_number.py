"""Values of SPICE netlists: numbers, parameters, expressions in braces or quotes."""

import math

from tline.errors import InputError
from tline.interchange.spice_expression import Parameters, Signal, Value, expression, number

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
        value = computed(word[1:-1], parameters, where)
    else:
        value = parameters.get(word.lower(), number(word))
    if not isinstance(value, float):
        raise InputError(where, "not a value", "a number as 4.7n, a parameter, or {an expression}", f"'{word:.40}'")
    if not math.isfinite(value):
        raise InputError(where, "out of range", "a finite number", f"'{word:.40}'")
    return value


def computed(text: str, parameters: Parameters, where: str, signal: Signal | None = None) -> Value:
    """Value of an expression.

    Raises
    ------
    InputError
        It is too long, or has no value.
    """
    if len(text) > LONGEST:
        raise InputError(where, "an expression that long", f"at most {LONGEST} characters", f"{len(text)}")
    try:
        return expression(text, parameters, signal)
    except TypeError:  # of a voltage or current in a function that takes numbers
        problem, got = "not a sum of voltages and currents with constant factors", f"'{text:.40}'"
        raise InputError(where, problem, got=got) from None
    except (ValueError, ArithmeticError) as error:
        raise InputError(where, f"not an expression that can be computed: {error}", got=f"'{text:.40}'") from None
