"""Command `tline exercise`: the exercise, letter by letter."""

from pathlib import Path
from typing import Any

from tline.cli.drives_parts import MECHANISM, mechanism
from tline.cli.from_signature import FileKind, Output, command, picture
from tline.cli.options import make_folder, write_text
from tline.errors import InputError
from tline.presentation import SCREEN

EXAMPLES = """\b
Examples:
  tline exercise
  tline exercise 3c
  tline exercise 1d --plot stribeck.png
  tline exercise 4f --modelica CoupledDrives.mo
  tline exercise 4g --friction "0.01 N m s"
  tline exercise --figures pictures
"""


@command(
    more=MECHANISM,
    files={"plot": picture("Its figure"), "modelica": FileKind((".mo",), "The Modelica package it asks for")},
    epilog=EXAMPLES,
)
def exercise(letter: str = "", *, figures: str | None = None, files: dict[str, str], **given: Any) -> Output:
    """Answer the exercise that tline grew out of: friction (1), lines (2), their passivity (3), coupled drives (4).

    Without a LETTER, such as 1a or 4h, the letters are listed. Numbers are the exercise's; the coupled drives take
    others.

    Parameters
    ----------
    figures : FOLDER
        Where to write the figure of the letter, or without one those of all letters.
    """
    from tline.exercises.answer import exercise as answered, letters

    known = letters()
    if given and not letter:
        raise InputError(f"--{next(iter(given)).replace('_', '-')}", "nothing to use it", "a letter from 4a to 4h")
    drives = mechanism(given) if given else None
    wanted = [letter] if letter else [*known] if figures else []
    answers = [answered(each, drives) for each in wanted]
    for name, missing in (("plot", not letter), ("modelica", not (letter and answers[0].modelica))):
        if name in files and missing:
            raise InputError(f"--{name}", "nothing to write", "a letter that asks for it")
    written = [_figure(answer, figures) for answer in answers if figures and answer.has_figure]
    writers = {}
    if letter:
        (answer,) = answers
        writers["modelica"] = lambda file: write_text(answer.modelica, file)
        writers["plot"] = lambda file: _draw(answer, file)
        return Output([*answer.text_lines(), *_code(answer.modelica), *written], answer.to_dict, writers)
    text = [f"{key}  {title}" for key, title in known.items()]
    return Output(written or text, lambda: known)


def _code(modelica: str) -> list[str]:
    """Return the package; if longer than a screen, only the model that it adds to those of the letters before."""
    lines = modelica.splitlines()
    if len(lines) > SCREEN:
        last = max(k for k, line in enumerate(lines) if line.startswith(("  model ", "  partial model ")))
        lines = [lines[0], "  // the models of earlier letters: --modelica FILE.mo writes all", "", *lines[last:]]
    return ["", *lines] if lines else []


def _figure(answer: Any, folder: str) -> str:
    """Write a figure into a folder; return a sentence about it."""
    make_folder(folder, "--figures")
    file = str(Path(folder, f"{answer.letter}.png"))
    _draw(answer, file)
    return f"wrote {file}"


def _draw(answer: Any, file: str) -> None:
    from tline.style import save_figure

    save_figure(answer.plot(), file)
