"""Scenes in TOML files, and the JSON schema that editors check them with."""

import tomllib
from pathlib import Path
from typing import Any

from tline.errors import InputError
from tline.scene.scene import Scene

LARGEST = 200_000_000  # bytes


def read_scene(path: str | Path) -> Scene:
    """Read a scene from a TOML file.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; SceneError with all mistakes of the scene.
    """
    path = Path(path)
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(str(path), "too large for a scene", f"at most {LARGEST} bytes")
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), "cannot be read", got=error.strerror or "an unreadable file") from None
    except UnicodeDecodeError:
        raise InputError(str(path), "is not a text file", "a scene in TOML") from None
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(str(path), f"is not valid TOML: {error}") from None
    return scene_from(data, str(path.parent))


def scene_from(data: dict[str, Any], folder: str = ".") -> Scene:
    """A scene from tables, as a TOML file holds them."""
    if "folder" in data:
        raise InputError("folder", "unknown key")
    return Scene(**data, folder=folder)


def scene_text(scene: Scene) -> str:
    """The scene as TOML text, with every value as it was typed; reading it gives an equal scene."""
    import tomli_w

    return tomli_w.dumps(scene.table())


def schema() -> dict[str, Any]:
    """JSON schema of a scene file."""
    return Scene.model_json_schema(by_alias=True) | {"$schema": "https://json-schema.org/draft/2020-12/schema"}
