"""What is wrong with a given impedance, in one sentence: where, what, what was expected, what was given."""


class ExpressionError(ValueError):
    """One mistake in a given impedance.

    Parameters
    ----------
    where : str
        The place to act on: ``column 7``, ``parameter L``, ``numerator[2]``; may be empty.
    problem : str
        What is wrong there.
    expected, got : str, optional
        What was expected, and what was given instead.
    """

    def __init__(self, where: str, problem: str, expected: str = "", got: str = ""):
        super().__init__(where, problem, expected, got)
        self.where, self.problem, self.expected, self.got = where, problem, expected, got

    def __str__(self) -> str:
        parts = [f"{self.where}: {self.problem}" if self.where else self.problem]
        parts += [f"expected {self.expected}"] if self.expected else []
        parts += [f"got {self.got}"] if self.got else []
        return ", ".join(parts)


def shorten(text: str) -> str:
    """The text as a message quotes it: at most 30 characters."""
    return text if len(text) <= 30 else text[:27] + "..."
