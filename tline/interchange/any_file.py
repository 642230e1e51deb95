"""Scenes from files: TOML scenes, SPICE netlists, water networks of EPANET."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tline.errors import InputError, LeftOutWarning
from tline.scene.file import EPANET, SPICE, read_scene
from tline.scene.scene import Scene
from tline.scene.text_file import check_readable
from tline.shipped import examples
from tline.words.wording import nearest, shown


def read(
    path: str | Path,
    *,
    wave_speed: float | str | None = None,
    material: str | None = None,
    hour: float | None = None,
    moving_tanks: bool = False,
    progress: bool = False,
    confined: bool = False,
) -> Scene:
    """Read a scene from a file.

    Parameters
    ----------
    path : str or Path
        A scene in TOML; or a SPICE netlist (.cir, .ckt, .net, .sp, .spi), a schematic of LTspice (.asc) or a water
        network of EPANET (.inp). Where there is no such file, the name of a scene of `tl.examples`.
    wave_speed, material, hour, moving_tanks
        Of an .inp file, as of `tline.interchange.read_inp`.
    progress : bool
        Show a progress bar on stderr if reading the lines of a TOML file takes more than two seconds.
    confined : bool
        Refuse tables and Touchstone files outside of the folder of a TOML file.

    Raises
    ------
    InputError
        The file cannot be read, or has contents that no scene has; SceneError with all mistakes of a scene.

    Warns
    -----
    LeftOutWarning
        For each thing that is left out of a netlist or a water network, or taken otherwise.

    Examples
    --------
    >>> read("cable_rc").title
    '50 Ω cable into 100 Ω ∥ 4 pF'
    """
    if not isinstance(path, str | Path):
        raise InputError("path", "not a path", "the path of a file", shown(path))
    water = {"wave_speed": wave_speed, "material": material, "hour": hour, "moving_tanks": moving_tanks or None}
    path = Path(path)
    if path.suffix.lower() not in (*SPICE, *EPANET):
        refuse_water(water)
        if not path.suffix and not path.exists():
            return _shipped(str(path))
        return read_scene(path, progress, confined=confined)
    scene, notes = read_foreign(path, **water)
    for note in notes:
        warnings.warn(note, LeftOutWarning, stacklevel=2)
    return scene


def _shipped(name: str) -> Scene:
    if name not in examples:
        raise InputError(name, "neither a file nor a scene that comes with tline", nearest(name, examples.names))
    return examples[name]


def read_foreign(path: Path, **water: Any) -> tuple[Scene, tuple[str, ...]]:
    """Scene of another program's file, and notes on parts left out or interpreted; options are those of `read`."""
    suffix, given = path.suffix.lower(), {name: value for name, value in water.items() if value is not None}
    if suffix not in (*SPICE, *EPANET):
        raise InputError(str(path), "unknown kind of file", " or ".join((*SPICE, *EPANET)), suffix or "no suffix")
    if suffix in SPICE:
        from tline.interchange.spice import read_spice

        refuse_water(given)
        check_readable(path)
        return read_spice(path)
    from tline.interchange.water_scene import read_inp

    return read_inp(str(path), **given)


def refuse_water(given: Mapping[str, Any]) -> None:
    """Refuse options of water networks for other files."""
    for name, value in given.items():
        if value is not None:
            raise InputError(name, "is for .inp files", "none", str(value))
