"""Files that a scene names: where they are looked for, and whether they may be read."""

from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationInfo

from tline.errors import InputError
from tline.scene.text_file import check_ordinary
from tline.words.wording import shown


class Folder(NamedTuple):
    """Where the files that a scene names are looked for.

    Parameters
    ----------
    path : Path
    confined : bool
        Whether files that lie elsewhere, by ``..``, a link or a path from the root, are refused.
    """

    path: Path = Path()
    confined: bool = False

    def find(self, file: str) -> Path:
        """The path of a file that can be read to its end."""
        path = self.path / file
        try:
            inside = not self.confined or path.resolve().is_relative_to(self.path.resolve())
            if inside:
                check_ordinary(path)
        except (OSError, ValueError) as error:  # a ValueError for a name with a null character
            reason = error.strerror if isinstance(error, OSError) else str(error)
            raise InputError("file", f"{shown(file)} cannot be read", got=reason or "an unreadable file") from None
        if not inside:
            raise InputError("file", f"{shown(file)} lies outside of the scene's folder", "a file in it")
        return path


def beside(file: str, info: ValidationInfo) -> Path:
    """The path of a file that an element of a scene names."""
    return Folder.find((info.context or {}).get("folder", Folder()), file)
