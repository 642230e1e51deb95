"""Mistakes of a user, in one sentence: place, problem, expected and given value.

All four packages use these classes, which survive pickle and copies. Surprises that are not mistakes of the user
are warnings.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray


class InputError(ValueError):
    """One mistake in the input of a user.

    Parameters
    ----------
    where : str
        Place the user can act on: ``lines.pipe.radius``, an option, a file; may be empty.
    problem : str
        Description of the mistake.
    expected, got : str, optional
        Expected value, and the one given instead.

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


def check_kind(where: str, value: object, *kinds: type) -> None:
    """Raise an error unless a value is of one of these classes.

    Examples
    --------
    >>> check_kind("bench", "heavy", dict)
    Traceback (most recent call last):
    tline.errors.InputError: bench: something else, expected dict, got 'heavy'
    """
    if not isinstance(value, kinds):
        *others, last = (kind.__name__ for kind in kinds)
        raise InputError(where, "something else", ", ".join(others) + " or " * bool(others) + last, repr(value)[:40])


def as_numbers(where: str, values: Any, kind: type = float) -> "NDArray":
    """Convert numbers to an array of floats, or of another kind of numbers; raise an error for anything else."""
    import numpy as np

    try:
        return np.asarray(values, kind)
    except (TypeError, ValueError, OverflowError):
        raise InputError(where, "not numbers", "a number or an array of them", repr(values)[:40]) from None


class SceneError(InputError):
    """All mistakes of a scene at once, one sentence a line.

    Parameters
    ----------
    mistakes : list of InputError
        Mistakes, at least one.
    """

    def __init__(self, mistakes: list[InputError]):
        super().__init__("", "\n".join(str(mistake) for mistake in mistakes))
        self.mistakes = mistakes
        self.args = (mistakes,)  # arguments of a copy


class ActiveError(InputError):
    """The scene has an active load, and the caller did not allow that."""


class NoFlowError(InputError):
    """No flow was found through elements that act on each other without delay; narrower slabs may help.

    Attributes
    ----------
    span : tuple of float, or None
        Begin and end of the piece of a slab in which that was, in slabs from t = 0, if known.
    """

    span: tuple[float, float] | None = None


class MissingExtraError(InputError):
    """An optional package needed here is not installed.

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
        self.args = (where, problem, extra)  # arguments of a copy


def import_extra(module: str, package: str, extra: str, where: str = "") -> Any:
    """Import a module of a package that an extra brings. Raises MissingExtraError: the package is not installed."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise MissingExtraError(where, f"{package} is missing", extra) from None


class NotKeptWarning(UserWarning):
    """Compiled code cannot be kept on disk, or may be somebody else's there: a process compiles for itself."""


class LeftOutWarning(UserWarning):
    """A file of another program has contents that its scene lacks, or holds in another form."""
