"""Measured columns over time in a CSV file: `t [ms]; x [um]; F [N]`."""

import csv
import re
from pathlib import Path

from tline.errors import InputError
from tline.units import to_si

UNITS = {"t": "s", "x": "m", "v": "m/s", "F": "N"}
HEADING = re.compile(r"\s*(\w+)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")


def read_record(file: str, where: str, assumed: tuple[str, ...] = ()) -> dict[str, list[float]]:
    """Columns of a file by their names, in SI.

    Parameters
    ----------
    file : str
        Comma, semicolon or tab between columns; beside semicolons numbers may have a decimal comma. Empty lines and
        lines that begin with # are skipped.
    where : str
        What an error points at.
    assumed : tuple of str
        Names of the columns of a file without heading; with none, a heading is needed.
    """
    from tline.scene.text_file import read_text
    from tline.words.printable import one_line

    lines = [line for line in enumerate(read_text(Path(file), where).splitlines(), 1) if line[1].strip()[:1] not in "#"]
    if not lines:
        raise InputError(where, "no rows", "lines of numbers", f"'{one_line(file)}'")
    between = max(";\t,", key=lambda mark: mark in lines[0][1])
    found = [(number, next(csv.reader([text], delimiter=between))) for number, text in lines]
    head, rows = (found[0][1], found[1:]) if any(map(_is_word, found[0][1])) else (None, found)
    names, factors = _headed(head, where) if head else (list(assumed), [1.0] * len(assumed))
    if not names:
        raise InputError(where, "no heading", "names of columns in the first line, such as t [s], x [mm], F [N]")
    columns: dict[str, list[float]] = {name: [] for name in names}
    for number, row in rows:
        cells = [cell.strip().replace(",", ".") if between == ";" else cell.strip() for cell in row]
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


def _headed(head: list[str], where: str) -> tuple[list[str], list[float]]:
    names, factors = [], []
    for cell in head:
        told = HEADING.fullmatch(cell)
        name = told[1] if told else ""
        if name not in UNITS or name in names:
            raise InputError(
                where, "unknown column" if name not in names else "a column twice", ", ".join(UNITS), f"'{cell[:30]}'"
            )
        names.append(name)
        factors.append(to_si(f"1 {told[2]}", UNITS[name], where) if told and told[2] else 1.0)
    return names, factors


def _is_number(cell: str) -> bool:
    try:
        return abs(float(cell)) < float("inf")
    except ValueError:
        return False


def _is_word(cell: str) -> bool:
    return cell.strip()[:1].isalpha() and cell.strip().lower() != "nan"
