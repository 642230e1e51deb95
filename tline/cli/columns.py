"""Columns over time in a CSV file: `t [ms]; x [um]; F [N]`."""

import csv
import re
from collections.abc import Mapping
from pathlib import Path

from tline.errors import InputError
from tline.units import to_si

WORDS = {  # names in files of data loggers, with their symbols
    "time": "t", "zeit": "t", "position": "x", "displacement": "x", "place": "x", "velocity": "v", "speed": "v",
    "force": "F", "friction": "F",
}  # fmt: skip
HEADING = re.compile(r"\s*(\w+)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")


def read_columns(
    file: str, where: str, units: Mapping[str, str], assumed: tuple[str, ...] = ()
) -> dict[str, list[float]]:
    """Read the columns of a file by their names, in SI.

    Parameters
    ----------
    file : str
        Semicolon, tab, comma or blanks between columns; numbers may have a decimal comma unless commas separate
        columns. Units are in brackets behind names, or in a line of their own. Empty lines and lines that begin with
        # or sep= are skipped.
    where : str
        Place named by errors.
    units : mapping of str to str
        Unit of each column allowed.
    assumed : tuple of str
        Names of the columns of a file without heading; with none, a heading is needed.
    """
    from tline.scene.text_file import read_text
    from tline.words.printable import one_line

    text = enumerate(map(str.strip, read_text(Path(file), where).splitlines()), 1)
    lines = [(number, line) for number, line in text if line[:1] not in "#" and not line.startswith("sep=")]
    if not lines:
        raise InputError(where, "no rows", "lines of numbers", f"'{one_line(file)}'")
    between = max(";\t, ", key=lambda mark: mark in lines[0][1])
    try:
        found = [(number, _cells(line, between)) for number, line in lines]
    except csv.Error as error:
        raise InputError(where, f"cannot be read: {error}", "columns of numbers") from None
    head, rows = (found[0][1], found[1:]) if any(map(_is_word, found[0][1])) else (None, found)
    if head and rows and len(rows[0][1]) == len(head) and all(map(_is_word, rows[0][1])):
        head = [f"{cell} [{unit.strip('[()]')}]" for cell, unit in zip(head, rows.pop(0)[1], strict=True)]
    names, factors = _headed(head, where, units) if head else (list(assumed), [1.0] * len(assumed))
    if not names:
        told = ", ".join(f"{name} [{unit}]" for name, unit in units.items())
        raise InputError(where, "no heading", f"names of columns in the first line, such as {told}")
    columns: dict[str, list[float]] = {name: [] for name in names}
    for number, cells in rows:
        if len(cells) != len(names) or not all(map(_is_number, cells)):
            raise InputError(where, f"line {number} is not {len(names)} numbers", ", ".join(names))
        for name, factor, cell in zip(names, factors, cells, strict=True):
            columns[name].append(float(cell) * factor)
        times = columns.get("t", [])
        if len(times) > 1 and times[-1] <= times[-2]:
            raise InputError(
                where, f"line {number}: time does not rise", f"more than {times[-2]:g} s", f"{times[-1]:g}"
            )
    return columns


def _cells(line: str, between: str) -> list[str]:
    """Cells of a line, decimal commas as points, without an empty last one."""
    found = [cell.strip() for cell in next(csv.reader([line], delimiter=between, skipinitialspace=True))]
    found = [cell.replace(",", ".") for cell in found if cell or between != " "]
    return found[:-1] if found[-1:] == [""] else found


def _headed(head: list[str], where: str, units: Mapping[str, str]) -> tuple[list[str], list[float]]:
    names, factors = [], []
    for cell in head:
        told = HEADING.fullmatch(cell)
        name = WORDS.get(told[1].lower(), told[1]) if told else ""
        if name not in units or name in names:
            problem = "unknown column" if name not in names else "a column twice"
            raise InputError(where, problem, ", ".join(units), f"'{cell[:30]}'")
        names.append(name)
        factors.append(to_si(f"1 {told[2]}", units[name], where) if told and told[2] else 1.0)
    return names, factors


def _is_number(cell: str) -> bool:
    try:
        return abs(float(cell)) < float("inf")
    except ValueError:
        return False


def _is_word(cell: str) -> bool:
    return cell.strip(" [(")[:1].isalpha() and cell.strip().lower() != "nan"
