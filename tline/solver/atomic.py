"""Files that are either written whole or not touched."""

import csv
import os
import secrets
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from tline.errors import InputError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends well, and is removed otherwise.

    Parameters
    ----------
    path : str or Path
        Where the finished file shall stand; a link is followed.

    Raises
    ------
    InputError
        The file cannot be written.

    Examples
    --------
    >>> with replacing("answer.txt") as temporary:  # doctest: +SKIP
    ...     temporary.write_text("42")
    """
    temporary = None
    try:
        target = Path(os.path.realpath(path))
        temporary = _beside(target)
        yield temporary
        temporary.replace(target)
    except OSError as error:
        raise InputError(str(path), "cannot be written", got=_reason(error)) from None
    finally:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def write_table(path: str | Path, head: Sequence[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a CSV file of one header line and rows; reading their floats gives the same ones.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def check_writable(path: str | Path) -> None:
    """Refuse a path that cannot be written, before any work is spent on what shall stand there."""
    try:
        _beside(Path(os.path.realpath(path))).unlink()
    except OSError as error:
        raise InputError(str(path), "cannot be written", got=_reason(error)) from None


def _beside(target: Path) -> Path:
    """An empty file in the target's folder, with its suffix."""
    if target.exists() and not target.is_file():
        raise OSError(0, "a folder" if target.is_dir() else "not an ordinary file")
    temporary = target.with_name(f".{target.stem[:100]}-{secrets.token_hex(4)}{target.suffix}")
    temporary.open("x").close()
    return temporary


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
