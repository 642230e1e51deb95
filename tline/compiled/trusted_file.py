"""Files with trusted content: nobody but oneself, or root, can have written them.

Code from a file runs with all rights of its reader. So a file is trusted if it and its folder belong to the reader or
to root, who could change the program itself, and no group and nobody else may write to either. Both are checked on the
opened descriptors through which the content is read, so nothing can be put in their place in between.
"""

import os
import stat
from pathlib import Path

OTHERS = stat.S_IWGRP | stat.S_IWOTH
BEYOND_LINKS = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


class UntrustedError(Exception):
    """Somebody else can have written this."""


def read_trusted(path: Path) -> bytes:
    """Content of a file that nobody else can have written.

    Raises UntrustedError: somebody else can, or it is a link, or not a file. Raises OSError: the file is missing, or
    cannot be read.
    """
    if os.name != "posix":  # where owners and modes have no meaning
        return path.read_bytes()
    folder = _opened_folder(path.parent)
    try:
        if not stat.S_ISREG(os.stat(path.name, dir_fd=folder, follow_symlinks=False).st_mode):
            raise UntrustedError(f"{path} is a link, or no file")
        with open(os.open(path.name, BEYOND_LINKS, dir_fd=folder), "rb") as file:
            _check(os.fstat(file.fileno()), path)
            return file.read()
    finally:
        os.close(folder)


def check_folder(path: Path) -> None:
    """Raise an error for a folder into which somebody else can write.

    Raises UntrustedError: somebody else can. Raises OSError: it is not there, or cannot be read.
    """
    if os.name == "posix":
        os.close(_opened_folder(path))


def _opened_folder(path: Path) -> int:
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        _check(os.fstat(folder), path)
    except UntrustedError:
        os.close(folder)
        raise
    return folder


def _check(found: os.stat_result, path: Path) -> None:
    if found.st_uid not in (os.geteuid(), 0):
        raise UntrustedError(f"{path} belongs to another user")
    if found.st_mode & OTHERS:
        raise UntrustedError(f"other users may write to {path}")
