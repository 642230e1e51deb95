"""What is wrong with what was given, in one sentence: where, what, what was expected, what was given."""

from math import inf, isfinite

LARGEST = 1e12  # of any number in SI; its powers are still numbers


class InputError(ValueError):
    """One mistake in what the user gave.

    Parameters
    ----------
    where : str
        The place to act on: ``model.F_s``, ``bench.mass``, ``h``.
    problem : str
        What is wrong there.
    expected, got : str, optional
        What was expected, and what was given instead.
    """

    def __init__(self, where: str, problem: str, expected: str = "", got: str = ""):
        super().__init__(where, problem, expected, got)
        self.where, self.problem, self.expected, self.got = where, problem, expected, got

    def __str__(self) -> str:
        parts = [f"{self.where}: {self.problem}"]
        parts += [f"expected {self.expected}"] if self.expected else []
        parts += [f"got {self.got}"] if self.got else []
        return ", ".join(parts)


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
