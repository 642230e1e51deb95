"""Helpers of commands: files that can be written, columns over time that can be read, errors that name options."""

import csv
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import click

from tline.errors import ActiveError, InputError, SceneError
from tline.units import to_si

PICTURE, CSV = (".png", ".svg", ".pdf"), (".csv",)


def check_files(files: Mapping[str, tuple[str | None, tuple[str, ...]]]) -> None:
    """Raise an error for files that cannot be written, by option with its suffixes, before time is spent on them."""
    from tline.atomic import check_writable

    seen: dict[Path, str] = {}
    for option, (file, suffixes) in files.items():
        if file is None:
            continue
        if suffixes and Path(file).suffix.lower() not in suffixes:
            raise InputError(option, "unknown kind of file", " or ".join(suffixes[:3]), f"'{file}'")
        other = seen.setdefault(Path(file).resolve(), option)
        if other != option:
            raise InputError(option, f"would overwrite what {other} writes", "another file", f"'{file}'")
        check_writable(file)


def print_or_write(text: str, file: str | None) -> None:
    """Print a document, or write it to a file and print its name."""
    if file is None:
        click.echo(text, nl=False)
    else:
        write_text(text, file)
        click.echo(f"wrote {file}")


def write_text(text: str, file: str) -> None:
    """Write a document to a file."""
    from tline.atomic import replacing

    with replacing(file) as temporary:
        temporary.write_text(text, encoding="utf-8")


def make_folder(path: str, where: str = "") -> None:
    """Make a folder, if it is missing."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(where or path, "cannot be made", "a folder", (error.strerror or str(error)).lower()) from None


def check_partners(given: Mapping[str, object], partners: Mapping[str, str]) -> None:
    """Raise an error for options that are given without the one that each requires."""
    for name, other in partners.items():
        if given.get(name) not in (None, False) and given.get(other) is None:
            flag, beside = (f"--{one.replace('_', '-')}" for one in (name, other))
            raise InputError(flag, "needs its partner", f"{beside} beside it")


def hours(text: str | None) -> float | None:
    """Parse the hours of an option `--at-hour`, if it is given."""
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        raise InputError("--at-hour", "not a number of hours", "such as 17 or 17.5", text) from None


def tolerance(text: str) -> float:
    """Parse the tolerance of an option `--tol`."""
    from tline.scene.quantity import TOLERANCE

    with options_named({"": "--tol"}):
        return float(TOLERANCE.parse(text, ""))


@contextmanager
def options_named(options: Mapping[str, str]) -> Iterator[None]:
    """Let errors name the option where the library names its argument or the scene's key."""
    try:
        yield
    except ActiveError as error:
        raise ActiveError(error.where, error.problem, "passive elements, or --active to run it all the same") from error
    except InputError as error:
        mistakes = error.mistakes if isinstance(error, SceneError) else [error]
        if not any(mistake.where in options for mistake in mistakes):
            raise
        named = [InputError(options.get(m.where, m.where), m.problem, m.expected, m.got) for m in mistakes]
        raise SceneError(named) if len(named) > 1 else named[0] from error


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
    from tline.words.wording import one_line

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
