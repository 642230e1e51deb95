"""Display of all results: as text, in notebooks with a picture, as plain data; columns over time also in files."""

from __future__ import annotations

import base64
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from tline.errors import InputError
from tline.words.wording import aligned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


SCREEN = 40  # lines of text


class Presentation:
    """Base of results: they define their text and their picture, and the rest follows from these."""

    picture: ClassVar[str] = ""  # "module:function" that draws it, given it and axes, None for a new figure

    def text_lines(self) -> Iterable[str]:
        """Lines of the text."""
        raise NotImplementedError

    def plot(self, ax: Axes | None = None) -> Figure | Axes:
        """Draw the picture of the result.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; without it a new figure with all panels.

        Returns
        -------
        Figure or Axes
            Target of the drawing.
        """
        if not self.picture:
            raise NotImplementedError
        module, _, name = self.picture.partition(":")
        return getattr(import_module(module), name)(self, ax)

    def to_dict(self) -> dict[str, Any]:
        """Numbers in SI as plain data, as `--json` of a command prints them; None where a number is not finite."""
        return plain(self)

    def __str__(self) -> str:
        lines = [*self.text_lines()]
        more = len(lines) - SCREEN
        return "\n".join(lines if more <= 0 else [*lines[:SCREEN], f"and {more} more lines"])

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """Text over the picture, in a notebook."""
        return self._shown(str(self).splitlines())

    def _shown(self, lines: Iterable[str]) -> str:
        from html import escape

        text = escape("\n".join(lines))
        return f"<pre>{text}</pre>{self._drawn()}"

    def _drawn(self) -> str:
        try:
            figure = self.plot()
        except (NotImplementedError, InputError):  # nothing to draw
            return ""
        return as_image(figure)


def as_image(figure: Any) -> str:
    """Encode a figure as a self-contained element of HTML."""
    if hasattr(figure, "_repr_png_"):
        png, _ = figure._repr_png_()
    else:
        file = io.BytesIO()
        figure.savefig(file, format="png")
        png = file.getvalue()
    data = base64.b64encode(png).decode()
    return f'<img alt="" style="max-width: 100%" width="800" src="data:image/png;base64,{data}">'


def plain(value: Any) -> Any:
    """Convert numbers, texts, lists and tables by name for JSON: complex numbers are pairs, infinities and NaN None.

    Examples
    --------
    >>> plain({"z": 1 - 2j, "gain": float("inf"), "poles": (1.5, 2)})
    {'z': [1.0, -2.0], 'gain': None, 'poles': [1.5, 2]}
    """
    if value is None or (isinstance(value, bool | int) and not isinstance(value, Enum)):
        return value
    if isinstance(value, str | Enum):
        return str(value)
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, Iterable):
        return [plain(each) for each in value]
    number = float(value)
    return number if math.isfinite(number) else None


class History(Presentation):
    """Base of results over time: they give their columns and units, and perhaps `errors`.

    These are estimates by the names of columns, relative to the largest magnitude of each.
    """

    units: ClassVar[Mapping[str, str]] = {}  # SI, by the names of columns

    @property
    def columns(self) -> dict[str, NDArray]:
        """All columns by name, time first, each of shape (n,), in SI."""
        raise NotImplementedError

    def table_lines(self) -> Iterator[str]:
        """Lowest, highest and last sample of each column behind the first, and their error estimates."""
        (_, t), *columns = self.columns.items()
        errors = getattr(self, "errors", {})
        told = ["largest error"] * bool(errors)
        rows = [["output", "lowest sample", "highest sample", f"at {t[-1]:.6g} s", *told]]
        for name, x in columns:
            off = [f"{errors[name] * abs(x).max():.1g}" if name in errors else ""] if told else []
            rows.append([f"{name} [{self.units[name]}]", *(f"{y:.6g}" for y in (x.min(), x.max(), x[-1])), *off])
        yield from aligned(rows, 0)

    def save(self, path: str | Path) -> None:
        """Write the columns to a file .csv or .npz, or all of the result to a file .json.

        Parameters
        ----------
        path : str or Path
            Path, whose suffix determines the format; an existing file is replaced.

        Raises
        ------
        InputError
            Another suffix, or the file cannot be written.
        """
        from tline.atomic import replacing, write_columns

        suffix = Path(path).suffix.lower()
        if suffix == ".csv":
            write_columns(path, self.columns)
        elif suffix == ".npz":
            from numpy import savez_compressed

            with replacing(path) as temporary, temporary.open("wb") as file:
                savez_compressed(file, allow_pickle=False, **self.columns)
        elif suffix == ".json":
            with replacing(path) as temporary:
                whole = self.to_dict() | {"units": dict(self.units), "columns": plain(self.columns)}
                temporary.write_text(json.dumps(whole, indent=2, ensure_ascii=False), encoding="utf-8")
        else:
            raise InputError(str(path), "unknown kind of file", ".csv, .npz or .json")
