"""Animated pages: frames drawn by a script, with play, pause, a slider and keys."""

import html
import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

from tline.atomic import replacing
from tline.errors import InputError

FRAME = 480  # pixels, height in a notebook


class Animation:
    """Animation that notebooks play.

    Parameters
    ----------
    html : str
        A page that needs nothing else: play, pause and a slider; keys do the same.
    """

    suffixes: ClassVar[tuple[str, ...]] = (".html",)

    def __init__(self, html: str):
        self.html = html

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{FRAME}" style="border: 0"></iframe>'

    def save(self, filename: str | Path) -> None:
        """Write the animation to a file.

        Parameters
        ----------
        filename : str or Path
            ``.html`` for a page; of waves also ``.gif`` for a picture that plays for ever, ``.mp4`` for a film.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written.
        MissingExtraError
            A film is asked for, and ffmpeg is not installed.
        """
        suffix = Path(filename).suffix.lower()
        if suffix not in self.suffixes:
            raise InputError(str(filename), "unknown kind of animation", " or ".join(self.suffixes), f"'{suffix}'")
        with replacing(filename) as temporary:
            self.write(temporary)

    def write(self, path: Path) -> None:
        """Write the page to a file."""
        path.write_text(self.html, encoding="utf-8")


def player(package: str, script: str, shown: str, data: Mapping[str, Any]) -> str:
    """Compose the page that plays data.

    Parameters
    ----------
    package, script : str
        Location of the script: JavaScript with ``draw(frame, width, height)``.
    shown : str
        Description of the drawing, for readers who cannot see it.
    data : mapping of str to Any
        Its ``title``, ``note``, ``keys`` (a sentence's end), ``frames``, and of the clock ``step``, ``decimals`` and
        ``time``, the unit; and further data of the script.
    """
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    template = files("tline.pictures").joinpath("player.html").read_text(encoding="utf-8")
    before, middle, after = (part for end in template.split("DATA", 1) for part in end.split("SCRIPT\n"))
    before = before.replace("SHOWN", shown).replace("TITLE", html.escape(data["title"]))  # texts of users come last
    return before + text + middle + files(package).joinpath(script).read_text(encoding="utf-8") + after
