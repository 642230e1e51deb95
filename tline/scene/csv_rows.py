"""Rows of numbers in CSV files that a scene names."""

import csv
import io
import re
from collections.abc import Mapping
from pathlib import Path

from tline.errors import InputError
from tline.scene.quantity import LARGEST
from tline.scene.text_file import read_text
from tline.words.printable import one_line

NUMBER = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*", re.ASCII)
NO_WORD = re.compile(r"\s*[-+.\d]")  # how a cell of a heading does not begin


def read_rows(path: Path, where: str, what: str, columns: Mapping[int, str]) -> list[tuple[float, ...]]:
    """Rows of finite numbers, all of one length.

    Parameters
    ----------
    path : Path
        Empty lines, lines that begin with #, and a first line of words are skipped.
    where : str
        What an error points at.
    what : str
        What a row is, for messages.
    columns : mapping of int to str
        How many numbers a row may have, and the words for that.
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
