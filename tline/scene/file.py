"""Scenes in TOML files, and the JSON schema that editors check them with."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.scene.text_file import Folder, read_toml
from tline.scene.user_defined import user_elements
from tline.words.wording import shown

SCHEMATIC = ".asc"  # of LTspice
SPICE, EPANET = (".cir", ".ckt", ".net", ".sp", ".spi", SCHEMATIC), (".inp",)  # suffixes of files that are imported
PLAIN = bool, int, float, str, list, tuple, dict  # types that TOML can represent


def read_scene(path: str | Path, progress: bool = False, *, confined: bool = False) -> Scene:
    """Read a scene from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file, in UTF-8; the CSV tables it names are looked for beside it.
    progress : bool
        Show a progress bar on stderr if reading the lines takes more than two seconds.
    confined : bool
        Refuse tables and Touchstone files that do not lie in the scene's folder or below it, links followed.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; SceneError with all mistakes of the scene.
    """
    path = Path(path)
    return Scene(Folder(path.parent, confined), progress, **read_toml(path, "a scene in TOML"))


def as_scene(given: Scene | str | Path | Mapping[str, Any]) -> Scene:
    """Convert a path, tables, or a scene to a scene."""
    match given:
        case Scene():
            return given
        case str() | Path():
            import tline  # files of other programs, and scenes by name, are read by what stands above scenes

            return tline.read(given)
        case Mapping():
            return Scene(**given)
    raise InputError("scene", "not a scene", "a Scene, the path of a file, or a dict", shown(given))


def scene_from(data: dict[str, Any], folder: str | Folder = ".") -> Scene:
    """Build a scene from tables as in a TOML file; files named in it are relative to `folder`."""
    return Scene(folder, **data)


def scene_text(scene: Scene) -> str:
    """Format a scene as TOML text, with every value as it was typed; reading it gives an equal scene.

    User-defined elements appear under the names of their classes, which cannot be read back.
    """
    import tomli_w

    table = scene.table()
    for part, name in user_elements(scene):
        element = table[part][name]
        fields = {key: value if isinstance(value, PLAIN) else repr(value) for key, value in element.table().items()}
        table[part][name] = {"kind": type(element).__name__} | fields
    return tomli_w.dumps(table)


def schema() -> dict[str, Any]:
    """JSON schema of a scene file."""
    return Scene.model_json_schema(by_alias=True) | {"$schema": "https://json-schema.org/draft/2020-12/schema"}
