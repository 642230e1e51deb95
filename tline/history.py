"""Results that are columns over time: one table and one file format for all mechanisms."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.words.aligned import aligned

if TYPE_CHECKING:
    from numpy.typing import NDArray


class History(Presentation):
    """Base of results over time: they give their columns and units, and perhaps `errors`.

    These are estimates by the names of columns, relative to the largest magnitude of each.
    """

    units: ClassVar[Mapping[str, str]] = {}  # SI, by the names of columns

    @property
    def columns(self) -> "dict[str, NDArray]":
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
