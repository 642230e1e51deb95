"""Text files that a user names: whatever lies there, it is read within limits or refused in one sentence."""

from pathlib import Path

from tline.errors import InputError

LARGEST = 100_000_000  # bytes


def read_text(path: Path, where: str = "") -> str:
    """Text of a file in UTF-8, without a byte order mark.

    Parameters
    ----------
    path : Path
        What to read; a pipe will do.
    where : str
        The key that names the file; without it the error points at the file.

    Raises
    ------
    InputError
        It cannot be read, is larger than LARGEST, or is no text.
    """
    name = f"'{path}' " if where and len(str(path)) < 300 else ""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except (OSError, ValueError) as error:  # a ValueError for a name with a null character
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(where or str(path), f"{name}cannot be read", got=reason or "an unreadable file") from None
    if len(data) > LARGEST:
        raise InputError(where or str(path), f"{name}is too large", f"at most {LARGEST:,} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(where or str(path), f"{name}is not a text file", "text in UTF-8") from None
