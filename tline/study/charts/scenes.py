"""Scenes of the charts, from `scenes.toml`; most are linear and from rest, so that their exact solutions are known."""

import tomllib
from pathlib import Path
from typing import NamedTuple

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.words.wording import nearest

TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
NAMES = tuple(TABLES)


class ChartScene(NamedTuple):
    """Scene of a chart with its title."""

    title: str
    scene: Scene


def chart_scene(name: str) -> ChartScene:
    """Look up a scene of the charts."""
    if name not in TABLES:
        raise InputError("scene", "no such chart scene", nearest(name, list(NAMES)), f"'{name}'")
    return ChartScene(TABLES[name]["title"], Scene(**TABLES[name]))
