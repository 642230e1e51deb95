"""Text, TOML and CSV files, and the folder of the files that a scene names."""

import csv
import io
import os
import re
import stat
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationInfo

from tline.errors import InputError
from tline.scene.quantity import LARGEST
from tline.words.wording import one_line, shown

LARGEST_FILE = 100_000_000  # bytes


def read_text(path: Path, where: str = "", legacy: bool = False) -> str:
    """Read a text file in UTF-8, without a byte order mark; `legacy` files may be in UTF-16 or a western alphabet.

    Errors point at the key `where` that names it, or at the file.
    """
    data = read_bytes(path, where)
    try:
        if legacy and data.startswith((b"\xff\xfe", b"\xfe\xff")):
            return data.decode("utf-16")
        if legacy and data[1:2] == b"\0":
            return data.decode("utf-16-le")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if legacy and b"\0" not in data:
            return data.decode("latin-1")
        raise InputError(where or str(path), f"{_named(path, where)}is not a text file", "text in UTF-8") from None


def read_bytes(path: Path, where: str = "") -> bytes:
    """Read a file of no unreasonable size; a pipe will do, but not one with a name, whose writer may never come."""
    name = _named(path, where)
    check_readable(path, where, name)
    with _opened(where or str(path), name), path.open("rb") as file:
        data = file.read(LARGEST_FILE + 1)
    if len(data) > LARGEST_FILE:
        raise InputError(where or str(path), f"{name}is too large", f"at most {LARGEST_FILE:,} bytes")
    return data


def _named(path: Path, where: str) -> str:
    return f"'{one_line(str(path))}' " if where and len(str(path)) < 300 else ""


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """Read the tables of a TOML file; `what` names the expected content."""
    text = read_text(path)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(str(path), "is nested too deeply", what) from None
    except ValueError as error:  # beside TOMLDecodeError: an integer of too many digits
        raise InputError(str(path), f"is not valid TOML: {error!s:.200}") from None


@contextmanager
def _opened(where: str, name: str) -> Iterator[None]:
    """Say of a file that the system does not open why that is so."""
    try:
        yield
    except (OSError, ValueError) as error:  # a ValueError for a name with a null character
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(where, f"{name}cannot be read", got=reason or "an unreadable file") from None


def check_readable(path: str | Path, where: str = "", name: str = "") -> None:
    """Raise an error for a file that could be read for ever: a device, a terminal, a pipe without a writer."""
    with _opened(where or str(path), name):
        kind = os.stat(path).st_mode
        nameless = stat.S_ISFIFO(kind) and not os.path.exists(os.path.realpath(path))  # of a shell
        if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind) or nameless):
            raise OSError(0, "a pipe with a name" if stat.S_ISFIFO(kind) else "a device, not a file")


class Folder(NamedTuple):
    """Folder in which the files named in a scene are looked for."""

    path: Path = Path()
    confined: bool = False  # whether files that lie elsewhere, by ``..``, a link or a path from the root, are refused

    def find(self, file: str) -> Path:
        """Path of a file that can be read to its end."""
        path = self.path / file
        with _opened("file", f"{shown(file)} "):
            inside = not self.confined or path.resolve().is_relative_to(self.path.resolve())
        if not inside:
            raise InputError("file", f"{shown(file)} lies outside of the scene's folder", "a file in it")
        check_readable(path, "file", f"{shown(file)} ")
        return path


def beside(file: str, info: ValidationInfo) -> Path:
    """Path of a file named by an element of a scene."""
    return Folder.find((info.context or {}).get("folder", Folder()), file)


NUMBER = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*", re.ASCII)
NO_WORD = re.compile(r"\s*[-+.\d]")  # how a heading's cell does not begin


def read_rows(path: Path, where: str, what: str, columns: Mapping[int, str]) -> list[tuple[float, ...]]:
    """Rows of finite numbers, all of one length, which `columns` has with the words for it.

    Empty lines, lines that begin with #, and a first line of words are skipped.
    """
    found: list[tuple[float, ...]] = []
    name = one_line(str(path))
    rows = csv.reader(io.StringIO(read_text(path, where)))
    try:
        for row in rows:
            if not row or row[0].lstrip().startswith("#") or (rows.line_num == 1 and not any(map(NO_WORD.match, row))):
                continue
            known = {len(found[0]): columns[len(found[0])]} if found else columns
            if len(row) not in known or not all(map(_is_number, row)):
                problem = f"line {rows.line_num} of '{name}' is not {what}"
                raise InputError(where, problem, ", or ".join(known.values()))  # quoted, any file could be read so
            found.append(tuple(map(float, row)))
    except csv.Error as error:
        raise InputError(where, f"line {rows.line_num} of '{name}' cannot be read: {error}") from None
    return found


def _is_number(cell: str) -> bool:
    return bool(NUMBER.fullmatch(cell)) and abs(float(cell)) <= LARGEST
