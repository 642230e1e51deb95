"""Files that are either written whole or not touched."""

import csv
import os
import re
import signal
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING
from uuid import uuid4

from tline.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

try:
    import fcntl
except ImportError:  # Windows: what a killed run leaves there stays
    fcntl = None
ENDS = ("SIGTERM", "SIGHUP")  # signals that end a program without a word, where the system has them


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends well, and is removed otherwise.

    Also where a signal ends the program meanwhile. One that is killed leaves a hidden file ``.NAME.tline-*``, which the
    next that writes `path` removes: whoever writes holds a lock, which no dead program does.

    Of a link it is the file that it leads to.

    Examples
    --------
    >>> with replacing("answer.txt") as temporary:  # doctest: +SKIP
    ...     temporary.write_text("42")
    """
    try:
        target = _target(path)
        with _beside(target) as temporary, _removed_at_end(temporary):
            yield temporary
            temporary.replace(target)
    except InputError:
        raise
    except Exception as error:
        if reason := _reason(error):
            raise InputError(str(path), "cannot be written", got=reason) from None
        raise


def write_table(
    path: str | Path, head: Sequence[str], rows: Iterable[Iterable[object]], notes: Iterable[str] = ()
) -> None:
    """Write a CSV file of one header line and rows, below comments; reading their floats gives the same ones."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in notes)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def write_columns(path: str | Path, columns: "Mapping[str, NDArray]") -> None:
    """Write arrays of one length as a CSV file, beside each other under their names."""
    write_table(path, [*columns], zip(*(column.tolist() for column in columns.values()), strict=True))


def check_writable(path: str | Path) -> None:
    """Refuse a path that cannot be written, before any work is spent on what shall stand there."""
    try:
        with _beside(_target(path)):
            pass
    except OSError as error:
        raise InputError(str(path), "cannot be written", got=_reason(error)) from None


def _target(path: str | Path) -> Path:
    """The file that a path names, through all links."""
    if "\0" in str(path):
        raise OSError(0, "a name with a null character")
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        raise OSError(0, "a folder" if target.is_dir() else "not an ordinary file")
    return target


@contextmanager
def _beside(target: Path) -> Iterator[Path]:
    """An empty file in the target's folder, with its suffix, locked and in the end removed if it is still there."""
    front = f".{target.stem[:100]}.tline-"
    _remove_stale(target.parent, re.compile(rf"{re.escape(front)}[0-9a-f]{{8}}{re.escape(target.suffix)}"))
    while True:
        temporary = target.with_name(f"{front}{uuid4().hex[:8]}{target.suffix}")
        with temporary.open("x") as file:
            if not _locked(file, wait=True) or temporary.exists():
                try:
                    yield temporary
                finally:
                    with suppress(OSError):
                        temporary.unlink(missing_ok=True)
                return
        # another run took it for a leftover before it was locked


def _remove_stale(folder: Path, names: re.Pattern[str]) -> None:
    """Remove temporary files of that name that nobody holds."""
    with suppress(OSError):  # a folder that may not be listed
        for entry in os.scandir(folder):
            if names.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                with suppress(OSError), open(entry.path, "rb") as file:
                    if _locked(file, wait=False):
                        os.unlink(entry.path)


def _locked(file: IO, wait: bool) -> bool:
    """Hold a file until it is closed; False if another does, or the file system knows no locks."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return False
    return True


@contextmanager
def _removed_at_end(temporary: Path) -> Iterator[None]:
    """Remove a file if a signal ends the program in the block; it then ends as it would have."""
    numbers = [getattr(signal, name) for name in ENDS if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        numbers = []  # only the main thread may listen
    plain = [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]

    def end(number: int, _: object) -> None:
        temporary.unlink(missing_ok=True)
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)

    for number in plain:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in plain:
            signal.signal(number, signal.SIG_DFL)


def _reason(error: BaseException | None) -> str:
    """Why the disk would not take it, also where that made a program stumble; empty for any other error."""
    while error is not None and not isinstance(error, OSError):
        error = error.__context__
    return (error.strerror or str(error)).lower() if error is not None else ""
