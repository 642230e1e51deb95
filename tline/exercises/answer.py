"""Answer to a letter of the exercise: question, derivation, numbers, code and figure."""

import textwrap
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.words.wording import nearest, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from drives import CoupledDrives

WIDTH = 100  # characters of a line
PROBLEMS = {"1": "friction", "2": "lines", "3": "passive_line", "4": "coupled"}  # modules; each has FOUND, by letter


class Step(NamedTuple):
    """Step of a derivation: its statement, its reason, and whether the program has checked that it holds."""

    text: str
    reason: str
    holds: bool | None = None  # None: a law of physics, or a definition, which cannot be checked


class Found(NamedTuple):
    """Results of a problem's module for a letter."""

    numbers: Mapping[str, Any]  # SI; shown in the text
    steps: tuple[Step, ...] = ()
    modelica: str = ""
    draw: tuple[Any, ...] = ()  # name and arguments of a function of `pictures`
    details: Mapping[str, Any] = {}  # further numbers, not shown in the text


@dataclass(frozen=True, repr=False)
class Answer(Presentation):
    """Answer to a letter of the exercise.

    Attributes
    ----------
    letter, title, question : str
        Such as "3b"; the question is in words of our own.
    steps : tuple of Step
        Derivation; `holds` is whether the program has checked a step, and found it right.
    paragraphs, remarks : tuple of str
        Answer, and points where the text of the exercise is imprecise.
    numbers : dict
        SI.
    modelica : str
        Package that the letter asks for, empty if none.
    """

    letter: str
    title: str
    question: str
    steps: tuple[Step, ...]
    paragraphs: tuple[str, ...]
    remarks: tuple[str, ...]
    numbers: dict[str, Any]
    modelica: str
    _draw: tuple[Any, ...]

    def text_lines(self) -> Iterator[str]:
        """Question, derivation, answer and remarks; the code is `modelica`."""
        yield f"({self.letter}) {self.title}"
        yield from _wrapped(self.question)
        yield from ["", *self.step_lines()] if self.steps else []
        for paragraph in self.paragraphs:
            yield ""
            yield from _wrapped(paragraph)
        for remark in self.remarks:
            yield ""
            yield from _wrapped(f"A remark on the text: {remark}")

    def step_lines(self) -> Iterator[str]:
        """Derivation, each step with its reason and whether it was checked."""
        width = min(max(len(step.text) for step in self.steps), WIDTH - 40)
        for number, step in enumerate(self.steps, 1):
            checked = {True: "checked: ", False: "DOES NOT HOLD: ", None: ""}[step.holds]
            reason = f"[{checked}{step.reason}]"
            beside = f"{number:3} {step.text:{width}}  {reason}"
            if len(beside) <= WIDTH:
                yield beside
            else:
                yield from _wrapped(f"{number:3} {step.text}", "    ")
                yield from _wrapped(f"      {reason}", "      ")

    def plot(self, ax: "Axes | None" = None) -> "Figure | Axes":
        """Draw the answer's figure; raise an error for a letter without one.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw its main part; without it a new figure with all.

        Raises
        ------
        InputError
            The letter asks for no figure.
        """
        if not self.has_figure:
            raise InputError(f"exercise {self.letter}", "has no figure", "another letter")
        name, *given = self._draw
        return getattr(import_module("tline.exercises.lines"), name)(*given, ax=ax)

    @property
    def has_figure(self) -> bool:
        """Whether `plot` draws something."""
        return bool(self._draw)

    def to_dict(self) -> dict[str, Any]:
        """All contents as plain data."""
        names = ("letter", "title", "question", "steps", "paragraphs", "remarks", "numbers", "modelica")
        return {name: plain(getattr(self, name)) for name in names}

    def _drawn(self) -> str:
        code = f"<pre>{self.modelica}</pre>" if self.modelica else ""
        return (super()._drawn() if self.has_figure else "") + code


def exercise(letter: str, drives: "CoupledDrives | None" = None) -> Answer:
    """Answer a letter of the exercise: question, derivation, numbers, code and figure.

    Parameters
    ----------
    letter : str
        1a to 1e (friction), 2a and 2b (lines), 3a to 3d (passivity of a line), 4a to 4h (coupled drives).
    drives : CoupledDrives, optional
        Other parameters for 4a to 4h.

    Returns
    -------
    Answer
        Text, with `numbers`, `steps`, `modelica`, `plot()` and `to_dict()`; notebooks show it with its figure.

    Raises
    ------
    InputError
        There is no such letter, or drives are given to another problem.

    Examples
    --------
    >>> from tline.exercises.answer import exercise
    >>> answer = exercise("2a")
    >>> f"{answer.numbers['z0']:.3g} Pa/(m³/s)"
    '4.68e+07 Pa/(m³/s)'
    """
    key = str(letter).strip().lower()
    if key not in letters():
        raise InputError("exercise", "no such letter", nearest(key, [*letters()]), shown(letter))
    if drives is not None and not key.startswith("4"):
        raise InputError("drives", f"exercise {key} has none", "a letter from 4a to 4h")
    told = _texts()[key]
    finder = import_module(f"tline.exercises.{PROBLEMS[key[0]]}").FOUND[key]
    if key.startswith("4"):
        from drives import CoupledDrives

        found: Found = finder(drives or CoupledDrives())
    else:
        found = finder()
    return Answer(
        key,
        told["title"],
        told["question"],
        found.steps or tuple(_step(**each) for each in told.get("steps", ())),
        tuple(text.format_map(found.numbers) for text in told["answer"]),
        tuple(text.format_map(found.numbers) for text in told["remarks"]),
        {**found.numbers, **found.details},
        found.modelica,
        found.draw,
    )


def letters() -> dict[str, str]:
    """Titles by letter."""
    return {key: each["title"] for key, each in _texts().items()}


@cache
def _texts() -> dict[str, dict[str, Any]]:
    return tomllib.loads(files("tline.exercises").joinpath("text.toml").read_text(encoding="utf-8"))


def _step(text: str, reason: str, left: str = "", right: str = "") -> Step:
    """Build a step of the text; if it has two sides, these are compared as quotients of polynomials."""
    from passivity.calculus.derivation import is_equation

    return Step(text, reason, is_equation(left, right) if left else None)


def _wrapped(text: str, indent: str = "") -> list[str]:
    return textwrap.wrap(text, WIDTH, subsequent_indent=indent, break_on_hyphens=False)
