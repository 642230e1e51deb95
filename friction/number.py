"""Numbers that a model or a testbench may have."""

from math import inf, isfinite

from tline.errors import InputError

LARGEST = 1e12  # of any number in SI; its powers are still numbers


def check_number(where: str, value: object, *, above: float = -inf, least: float = -inf) -> None:
    """Refuse what is not a finite number above one bound and at least another."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise InputError(where, "not a finite number", "a number", repr(value)[:30])
    if abs(value) > LARGEST:
        raise InputError(where, "too large", f"at most {LARGEST:g}", f"{value:g}")
    if value <= above:
        raise InputError(where, "too small", f"more than {above:g}", f"{value:g}")
    if value < least:
        raise InputError(where, "too small", f"at least {least:g}", f"{value:g}")
