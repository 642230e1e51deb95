"""Networks as they are read before anything is operated: scenes, and files of water networks with their controls."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.any_file import refuse_water
from tline.interchange.water_controls import WaterControl
from tline.interchange.water_scene import read_with_controls
from tline.scene.file import EPANET, as_scene
from tline.scene.scene import Scene


class Network(NamedTuple):
    """A network that was read."""

    scene: Scene
    notes: tuple[str, ...] = ()  # on what is left out of its file
    controls: tuple[WaterControl, ...] = ()  # of its file, that act within a run


def read_network(
    network: Network | Scene | str | Path | Mapping[str, Any],
    *,
    wave_speed: float | str | None = None,
    material: str | None = None,
    hour: float | None = None,
    moving_tanks: bool = False,
) -> Network:
    """The scene of a network, notes on what is left out of its file, and the file's controls; see `operate`."""
    water = {"wave_speed": wave_speed, "material": material, "hour": hour, "moving_tanks": moving_tanks or None}
    if isinstance(network, str | Path):
        suffix = Path(network).suffix.lower()
        if suffix in EPANET:
            return Network(*read_with_controls(str(network), wave_speed, material, hour or 0.0, moving_tanks))
        if suffix != ".toml":
            raise InputError(str(network), "unknown kind of file", ".inp or .toml", suffix or "no suffix")
    refuse_water(water)
    return network if isinstance(network, Network) else Network(as_scene(network))
