"""What a user did wrong, in one sentence: where, what is wrong, what was expected, what was given.

All four packages say it with these classes, which survive pickle and copies. What is no mistake of the user but may
surprise is a warning.
"""

from typing import Any


class InputError(ValueError):
    """One mistake in what the user gave.

    Parameters
    ----------
    where : str
        The place the user can act on: ``lines.pipe.radius``, an option, a file; may be empty.
    problem : str
        What is wrong there.
    expected, got : str, optional
        What was expected, and what was given instead.

    Examples
    --------
    >>> print(InputError("lines.pipe.radius", "too small", "more than 0 m", "-1 m"))
    lines.pipe.radius: too small, expected more than 0 m, got -1 m
    """

    def __init__(self, where: str, problem: str, expected: str = "", got: str = ""):
        super().__init__(where, problem, expected, got)
        self.where, self.problem, self.expected, self.got = where, problem, expected, got

    def __str__(self) -> str:
        parts = [f"{self.where}: {self.problem}" if self.where else self.problem]
        parts += [f"expected {self.expected}"] if self.expected else []
        parts += [f"got {self.got}"] if self.got else []
        return ", ".join(parts)


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
        self.args = (mistakes,)  # what a copy is made of


class ActiveError(InputError):
    """The scene has an active load, and nobody asked to run it all the same."""


class NoFlowError(InputError):
    """No flow was found through elements that see each other; narrower slabs may help.

    Attributes
    ----------
    span : tuple of float, or None
        Where the piece of a slab begins and ends in which that was, in slabs from t = 0, if it is known.
    """

    span: tuple[float, float] | None = None


class MissingExtraError(InputError):
    """A package that this needs, and tline does without, is not installed.

    Parameters
    ----------
    where, problem : str
        As of `InputError`.
    extra : str
        Name of the extra of tline that brings the package.

    Examples
    --------
    >>> print(MissingExtraError("town.inp", "wntr is missing", "epanet"))  # doctest: +ELLIPSIS
    town.inp: wntr is missing, expected pip install ...[epanet]'
    """

    def __init__(self, where: str, problem: str, extra: str):
        from pathlib import Path

        clone = (Path(__file__).parents[1] / "pyproject.toml").is_file()
        super().__init__(where, problem, f"pip install {'-e ' * clone}'{'.' if clone else 'tline'}[{extra}]'")
        self.args = (where, problem, extra)  # what a copy is made of


def import_extra(module: str, package: str, extra: str, where: str = "") -> Any:
    """Import a module of a package that an extra brings.

    Raises
    ------
    MissingExtraError
        The package is not installed.
    """
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise MissingExtraError(where, f"{package} is missing", extra) from None


class NotKeptWarning(UserWarning):
    """Compiled code cannot be kept on disk, or what is there may be somebody else's: a process compiles for itself."""


class LeftOutWarning(UserWarning):
    """A file of another program holds something that its scene does not, or holds otherwise."""
