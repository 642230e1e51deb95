"""Helpers of commands: files that can be written, and errors that name options."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import click

from tline.errors import ActiveError, InputError, SceneError

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
