"""Scenes that come with tline: by name as scenes, and as files to start from."""

import shutil
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

from tline.errors import InputError
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.words.wording import nearest, shown

_HERE = Path(__file__).parent / "scenes"  # in a wheel
FOLDER = _HERE if _HERE.is_dir() else Path(__file__).parents[2] / "scenes"  # in a clone


class Examples(Mapping[str, Scene]):
    """The scenes that come with tline, by name; each is read when it is asked for.

    Examples
    --------
    >>> from tline.shipped import examples
    >>> "water_pipe" in examples, examples["water_pipe"].title
    (True, 'Water pipe, the valve shuts at 0.2 s')
    """

    def __getitem__(self, name: str) -> Scene:
        return read_scene(self.path(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __repr__(self) -> str:
        width = max(map(len, self))
        return "\n".join(f"{name:{width}}  {title}" for name, title in self.titles().items())

    def _ipython_key_completions_(self) -> list[str]:
        return self.names

    @property
    def names(self) -> list[str]:
        """Names of all."""
        return sorted(path.stem for path in FOLDER.glob("*.toml"))

    def titles(self) -> dict[str, str]:
        """Titles by name."""
        return {name: tomllib.loads(self.path(name).read_text(encoding="utf-8"))["title"] for name in self}

    def path(self, name: str) -> Path:
        """The file of a scene. Raises InputError: there is no scene of that name."""
        if name not in self:
            raise InputError("examples", "no such scene", nearest(str(name), self.names), shown(name))
        return FOLDER / f"{name}.toml"

    def copy(self, name: str, folder: str | Path = ".") -> list[Path]:
        """Copy a scene, and the files that it names, into a folder.

        Parameters
        ----------
        name : str
        folder : str or Path
            One that exists.

        Returns
        -------
        list of Path
            What was written, the scene first.

        Raises
        ------
        InputError
            There is no scene of that name, or a file that would be overwritten, or the folder cannot be written.
        """
        text = self.path(name).read_text(encoding="utf-8")
        named = [
            path for path in FOLDER.iterdir() if path.suffix in (".csv", ".ibs", ".s1p", ".s2p") and path.name in text
        ]
        written = [Path(folder, path.name) for path in (self.path(name), *named)]
        for path in written:
            if path.exists():
                raise InputError(str(path), "is there already", "another folder")
        try:
            for path in written:
                shutil.copyfile(FOLDER / path.name, path)
        except OSError as error:
            raise InputError(str(folder), "cannot be written", got=error.strerror or str(error)) from None
        return written


examples = Examples()
