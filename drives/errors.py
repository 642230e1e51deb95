"""What is wrong with a given drive, torque or controller, in one sentence."""

from collections.abc import Sequence


class InputError(ValueError):
    """One mistake in what the user gave.

    Parameters
    ----------
    where : str
        The place to act on: ``left.inertia``, ``T1[3]``.
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


def known_names(where: str, given: Sequence[str], known: Sequence[str]) -> None:
    """Refuse names that are not known, and no names at all."""
    if isinstance(given, str) or not given:
        raise InputError(where, "no names", f"some of {', '.join(known)}", repr(given)[:40])
    for name in given:
        if name not in known:
            raise InputError(where, "unknown name", " or ".join(known), repr(name)[:40])
