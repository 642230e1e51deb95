"""Parameters of laws: real, finite, of the right sign."""

import math
from numbers import Real

from tline.errors import InputError


def positive(**parameters: float) -> None:
    """Refuse a parameter that is not a finite number above zero.

    Examples
    --------
    >>> positive(radius=-1)
    Traceback (most recent call last):
    tline.errors.InputError: radius: not positive, expected a finite number above 0, got -1
    """
    for name, value in parameters.items():
        if not (_finite(value) and value > 0):
            raise InputError(name, "not positive", "a finite number above 0", repr(value))


def not_negative(**parameters: float) -> None:
    """Refuse a parameter that is not a finite number from zero on."""
    for name, value in parameters.items():
        if not (_finite(value) and value >= 0):
            raise InputError(name, "negative or no number", "a finite number from 0 on", repr(value))


def _finite(value: object) -> bool:
    return (type(value) is float or isinstance(value, Real)) and math.isfinite(value)
