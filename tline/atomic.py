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
except ImportError:  # Windows: a killed run's files remain there
    fcntl = None
ENDS = ("SIGTERM", "SIGHUP")  # signals that end a program without an exception, where the system has them


def suffix_of(path: str | Path, known: Sequence[str]) -> str:
    """Return the suffix of a file, in lower case, if it is among those known.

    Examples
    --------
    >>> suffix_of("out/Run.CSV", (".csv", ".npz"))
    '.csv'
    """
    suffix = Path(path).suffix.lower()
    if suffix not in known:
        raise InputError(str(path), "unknown kind of file", " or ".join(known), f"'{suffix}'")
    return suffix


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path next to `path` that takes its place when the block ends well, and is removed otherwise.

    It is removed too if a signal ends the program. A killed program leaves a hidden file ``.NAME.tline-*``, which the
    next writer of `path` removes: writers hold a lock, which no dead program does.

    If `path` is a link, the file that it leads to is replaced.

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
    """Write arrays of one length as a CSV file, in columns under their names."""
    write_table(path, [*columns], zip(*(column.tolist() for column in columns.values()), strict=True))


def check_writable(path: str | Path) -> None:
    """Raise an error for a path that cannot be written, before any work is spent on its content."""
    try:
        with _beside(_target(path)):
            pass
    except OSError as error:
        raise InputError(str(path), "cannot be written", got=_reason(error)) from None


def _target(path: str | Path) -> Path:
    """File that a path names, through all links."""
    if "\0" in str(path):
        raise OSError(0, "a name with a null character")
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        raise OSError(0, "a folder" if target.is_dir() else "not an ordinary file")
    return target


@contextmanager
def _beside(target: Path) -> Iterator[Path]:
    """Create an empty file in the target's folder, with its suffix, locked and in the end removed if still there."""
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
        # another run took the file for a leftover before it was locked


def _remove_stale(folder: Path, names: re.Pattern[str]) -> None:
    """Remove temporary files of that name without a lock."""
    with suppress(OSError):  # a folder that may not be listed
        for entry in os.scandir(folder):
            if names.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                with suppress(OSError), open(entry.path, "rb") as file:
                    if _locked(file, wait=False):
                        os.unlink(entry.path)


def _locked(file: IO, wait: bool) -> bool:
    """Lock a file until it is closed; False if another process does, or the file system has no locks."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return False
    return True


@contextmanager
def _removed_at_end(temporary: Path) -> Iterator[None]:
    """Remove a file if a signal ends the program in the block; the program then ends as without this."""
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
    """Reason why the disk refused, also if it caused another error; empty for any other error."""
    while error is not None and not isinstance(error, OSError):
        error = error.__context__
    return (error.strerror or str(error)).lower() if error is not None else ""
