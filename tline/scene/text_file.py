"""Text files that a user names: whatever lies there, it is read within limits or refused in one sentence."""

import os
import stat
import tomllib
from pathlib import Path
from typing import Any

from tline.errors import InputError
from tline.words.printable import one_line

LARGEST = 100_000_000  # bytes


def read_text(path: Path, where: str = "", legacy: bool = False) -> str:
    """Text of a file in UTF-8, without a byte order mark; or of an older encoding.

    Parameters
    ----------
    path : Path
        What to read; a pipe will do, but not one with a name, for which a writer may never come.
    where : str
        The key that names the file; without it the error points at the file.
    legacy : bool
        Read what is not UTF-8 as UTF-16 if it begins so, or else as Latin-1.
    """
    name = f"'{one_line(str(path))}' " if where and len(str(path)) < 300 else ""
    try:
        check_ordinary(path)
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except (OSError, ValueError) as error:  # a ValueError for a name with a null character
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(where or str(path), f"{name}cannot be read", got=reason or "an unreadable file") from None
    if len(data) > LARGEST:
        raise InputError(where or str(path), f"{name}is too large", f"at most {LARGEST:,} bytes")
    try:
        if legacy and data.startswith((b"\xff\xfe", b"\xfe\xff")):
            return data.decode("utf-16")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if legacy and b"\0" not in data:
            return data.decode("latin-1")
        raise InputError(where or str(path), f"{name}is not a text file", "text in UTF-8") from None


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """Tables of a TOML file; `what` says what is expected there."""
    text = read_text(path)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(str(path), "is nested too deeply", what) from None
    except ValueError as error:  # beside TOMLDecodeError: an integer of too many digits
        raise InputError(str(path), f"is not valid TOML: {error!s:.200}") from None


def check_ordinary(path: str | Path) -> None:
    """Refuse what could be read for ever: devices, terminals, pipes that nobody may be writing to.

    Raises
    ------
    OSError
        Saying what it is.
    """
    kind = os.stat(path).st_mode
    nameless = stat.S_ISFIFO(kind) and not os.path.exists(os.path.realpath(path))  # of a shell
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind) or nameless):
        raise OSError(0, "a pipe with a name" if stat.S_ISFIFO(kind) else "a device, not a file")
