"""Run one case in this process, and say what is wrong with the answer."""

import io
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from shutil import rmtree

import matplotlib.font_manager  # noqa: F401 (makes folders of its own when it is imported)

from fuzz.case import Case
from tline.interchange import epanet_run

EXITS = {0, 1, 2}
EXITS_OF = {"passivity": EXITS | {3}}
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
LONGEST_LINE = 2000  # of an error
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
MOVES = {
    "os.rename",
    "os.remove",
    "os.mkdir",
    "os.rmdir",
    "os.link",
    "os.symlink",
    "os.truncate",
    "os.chmod",
    "os.utime",
}
FORBIDDEN = ("subprocess", "os.system", "os.exec", "os.posix_spawn", "os.fork", "socket.connect", "pty", "webbrowser")
CONFINED = str(Path(epanet_run.__file__))  # runs EPANET in an empty folder: the one program that is started
OWN_CACHE = (".nbi", ".nbc", ".pyc", ".unit")  # compiled code of the program itself
_seen: list[str] | None = None  # what the audit hook found in the case under way


def verdict(case: Case, folder: Path) -> list[str]:
    """What is wrong with the answer to a case that runs in `folder`, which is empty before and afterwards.

    Runs `tline` in this process. Nothing is found of an input that is answered within bounds, or refused in a sentence.
    """
    for name, content in case.files.items():
        (folder / name).write_bytes(content)
    before = _content(folder)
    with _watched(folder) as touched:
        code, out, err = _called(case.args)
    after = _content(folder)
    found = [*touched]
    command = case.args[0] if case.args else ""
    if code not in EXITS_OF.get(command, EXITS):
        found.append(f"exit status {code}")
    if code == 2 and not err.strip():
        found.append("refused without a word")
    for stream, text in (("stdout", out), ("stderr", err)):
        if bad := CONTROL.search(text):
            found.append(f"{bad[0]!r} on {stream}")
    if long := max(map(len, err.splitlines()), default=0) // LONGEST_LINE:
        found.append(f"an error of {long * LONGEST_LINE} characters in a line")
    if "Traceback" in err or "a fault of the program" in err:
        found.append(err.strip()[-300:])
    for name in before.keys() | after.keys():
        if before.get(name) != after.get(name) and (name not in case.asked or (code == 2 and name not in after)):
            found.append(f"file {name!r} was {'written' if name in after else 'removed'}")
    _emptied(folder)
    return found


def _content(folder: Path) -> dict[str, bytes]:
    """Content by name; a folder counts as one."""
    return {entry.name: b"" if entry.is_dir() else Path(entry.path).read_bytes() for entry in os.scandir(folder)}


def _emptied(folder: Path) -> None:
    for entry in os.scandir(folder):
        rmtree(entry.path) if entry.is_dir(follow_symlinks=False) else os.unlink(entry.path)


def _called(args: list[str]) -> tuple[object, str, str]:
    from tline.cli.main import main

    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            main(args, prog_name="tline")
            code: object = 0
        except SystemExit as error:
            code = error.code or 0
        except BaseException as error:  # noqa: BLE001 (whatever comes out is what is looked for)
            code = f"{type(error).__name__}: {error!s:.200}"
    return code, out.getvalue(), err.getvalue()


@contextmanager
def _watched(folder: Path) -> Iterator[list[str]]:
    """Note every file that is opened for writing, moved or removed outside of the folder, and every program started."""
    global _seen
    if not getattr(sys, "_fuzz_hook", False):
        sys.addaudithook(_hook)
        sys._fuzz_hook = True  # pyright: ignore[reportAttributeAccessIssue]
    _seen, found = [], []
    try:
        yield found
    finally:
        found += [event.replace("\0", " ") for event in _seen if not _allowed(event.partition("\0")[2], folder)]
        _seen = None


def _allowed(path: str, folder: Path) -> bool:
    """Whether a file is in the folder (what is left there is compared), compiled code, or temporary and gone."""
    real = os.path.realpath(path) if path else "/"
    if real.startswith(os.path.realpath(folder) + os.sep) or real.endswith(OWN_CACHE) or "__pycache__" in real:
        return True
    return real == os.devnull or (real.startswith(tempfile.gettempdir() + os.sep) and not os.path.exists(real))


def _hook(event: str, args: tuple) -> None:
    if _seen is None:
        return
    if event == "open":
        path, _, flags = args
        if isinstance(path, str | bytes) and isinstance(flags, int) and flags & WRITING:
            _seen.append(f"opened for writing:\0{os.fsdecode(path)}")
    elif event in MOVES:
        _seen.extend(f"{event}\0{os.fsdecode(path)}" for path in args[:2] if isinstance(path, str | bytes))
    elif event.startswith(FORBIDDEN) and not (event == "subprocess.Popen" and CONFINED in args[1]):
        _seen.append(f"{event} {args!r:.100}")
