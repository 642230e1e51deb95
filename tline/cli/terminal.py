"""Command `tline` as a program: text cannot steer the terminal, and closed or full streams do no harm."""

import atexit
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import active_count
from typing import TextIO

from tline.words.printable import printable


class UnreadError(Exception):
    """The reader of the output is gone."""


class Printable(io.TextIOBase):
    """Stream that writes control characters as ``\\u001b``; a carriage return in front, of a progress bar, stays.

    Parameters
    ----------
    stream : TextIO
        Target of the text.
    optional : bool
        Whether text that cannot be written there is dropped.
    """

    encoding, errors = "utf-8", "replace"

    def __init__(self, stream: TextIO, optional: bool):
        self.stream, self.optional = stream, optional
        self.encoding = stream.encoding or "utf-8"

    def writable(self) -> bool:  # noqa: D102
        return True

    def isatty(self) -> bool:  # noqa: D102
        return self.stream.isatty()

    def fileno(self) -> int:  # noqa: D102
        return self.stream.fileno()

    def write(self, text: str | bytes) -> int:  # noqa: D102
        text = text.decode() if isinstance(text, bytes) else text  # click writes shell completions as bytes
        front = "\r" if text.startswith("\r") else ""
        with self._tolerant():
            self.stream.write(front + printable(text[len(front) :]))
        return len(text)

    def flush(self) -> None:  # noqa: D102
        with self._tolerant():
            self.stream.flush()

    @contextmanager
    def _tolerant(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if not self.optional:
                raise (UnreadError() if isinstance(error, BrokenPipeError) else error) from None


@contextmanager
def terminal() -> Iterator[None]:
    """Replace closed streams, and pass all text through `Printable`, while a command runs.

    Printing to a closed stdout is an error at that time; text for a closed or full stderr is lost.
    """
    _open_descriptors()
    before = sys.stdout, sys.stderr
    out, err = before[0] or _stream(1), before[1] or _stream(2)
    for stream in (out, err):
        if isinstance(stream, io.TextIOWrapper):  # '?' replaces Greek letters that cannot be printed
            stream.reconfigure(errors="replace")
    sys.stdout, sys.stderr = Printable(out, False), Printable(err, True)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def forsake_stdout() -> None:
    """Discard output not flushed yet, after the reader is gone."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _open_descriptors() -> None:
    """Occupy the descriptors 0 to 2, so that no file of the program gets one of them and is overwritten."""
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):  # writing to stdout shall fail
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)


def _stream(number: int) -> TextIO:
    return io.TextIOWrapper(io.FileIO(number, "w", closefd=False), "utf-8", write_through=True)  # pyright: ignore[reportArgumentType]


def program() -> None:
    """Run `tline`, and exit.

    When all is written the system frees memory at once; clearing every module and collecting garbage before would
    take a tenth of the time of a small scene. While threads are alive, Python waits for them as usual.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else pydantic reads the metadata of all packages
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads wait for each other longer than small matrices take
    from tline.cli.main import main

    try:
        main()
    except SystemExit as end:
        if not isinstance(end.code, int) or active_count() > 1:
            raise
        code = end.code
    else:
        return
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)
