"""What a user did wrong, in one sentence: where, what is wrong, what was expected, what was given."""


class InputError(ValueError):
    """One mistake in what the user gave.

    Parameters
    ----------
    where : str
        The place the user can act on: ``lines.pipe.radius``, an option, a file.
    problem : str
        What is wrong there.
    expected, got : str, optional
        What was expected, and what was given instead.
    """

    def __init__(self, where: str, problem: str, expected: str = "", got: str = ""):
        self.where, self.problem, self.expected, self.got = where, problem, expected, got
        parts = [f"{where}: {problem}" if where else problem]
        if expected:
            parts.append(f"expected {expected}")
        if got:
            parts.append(f"got {got}")
        super().__init__(", ".join(parts))


class SceneError(InputError):
    """All mistakes of a scene at once, one sentence a line.

    Parameters
    ----------
    mistakes : list of InputError
        What is wrong, at least one.
    """

    def __init__(self, mistakes: list[InputError]):
        super().__init__("", "\n".join(str(mistake) for mistake in mistakes))
        self.mistakes = mistakes


class ActiveError(InputError):
    """The scene has an active load, and nobody asked to run it all the same."""
