"""Materials and walls of pipes from a table by name, which determine wave speeds."""

import csv
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tline.errors import InputError
from tline.interchange.water_network import listed
from tline.line.materials import WALLS
from tline.scene.quantity import Quantity
from tline.scene.text_file import read_text
from tline.words.wording import shown

USUAL = "1000 m/s"  # of pipes of which nothing is said
EVERY = "*"  # for all pipes that have no row of their own
WATER = "2.19 GPa"  # bulk modulus at 20 degC
Keys = dict[str, Any]  # of a line in a scene


def wave_speeds(wave_speed: float | str | None, material: str | None) -> dict[str, Keys]:
    """Keys of the lines that set the wave speed of pipes, by pipe, and by "*" of all others.

    Rows of the CSV file `material` are ``pipe, wall, thickness`` or ``pipe, wave speed``; a wall is the name of a
    material, or Young's modulus.
    """
    found: dict[str, Keys] = {EVERY: {"wave_speed": USUAL}}
    if not isinstance(material, str | Path | None):
        raise InputError("material", "not a path", "the path of a CSV file", shown(material))
    if material is not None:
        found |= _read(str(material))
    if wave_speed is not None:
        speed = Quantity(wave_speed, "m/s", "wave_speed")
        found[EVERY] = {"wave_speed": float(speed) if _is_plain(wave_speed) else wave_speed}
    return found


def keys_of(name: str, walls: Mapping[str, Keys]) -> Keys:
    """Keys of one pipe."""
    return walls.get(name, walls[EVERY])


def notes_on(walls: Mapping[str, Keys], pipes: Mapping[str, Any], *, given: bool) -> Iterator[str]:
    """Notes on pipes without a row, and on rows without a pipe."""
    unknown = walls.keys() - pipes.keys() - {EVERY}
    if unknown:
        yield f"material: no pipe in use has these names: {listed(unknown)}"
    rest = pipes.keys() - walls.keys()
    if rest and not given and walls[EVERY].get("wave_speed") == USUAL:
        pipe = "all pipes" if len(rest) == len(pipes) else f"{len(rest)} pipes"
        yield f"wave speed: {USUAL} in {pipe}, for nothing says what they are made of"


def _is_plain(typed: float | str) -> bool:
    """Whether a number has no unit, and SI was meant."""
    return not isinstance(typed, str) or not any(c.isalpha() and c not in "eE" for c in typed)


def _read(path: str) -> dict[str, Keys]:
    found: dict[str, Keys] = {}
    rows = csv.reader(io.StringIO(read_text(Path(path))))
    try:
        for row in rows:
            cells = [cell.strip() for cell in row]
            if not any(cells) or cells[0].startswith("#") or (rows.line_num == 1 and cells[0].lower() == "pipe"):
                continue
            where = f"{path}, line {rows.line_num}"
            if cells[0] in found:
                raise InputError(where, f"pipe '{cells[0]}' has a row already", "one row for each")
            found[cells[0]] = _keys(cells, where)
    except csv.Error as error:
        raise InputError(path, f"line {rows.line_num} cannot be read: {error}") from None
    return found


def _keys(cells: list[str], where: str) -> Keys:
    if len(cells) == 2:
        return {"wave_speed": _checked(cells[1], "m/s", where)}
    if len(cells) != 3:
        raise InputError(where, "not a row", "pipe, wall, thickness; or pipe, wave speed", f"{len(cells)} cells")
    _, wall, thickness = cells
    stiff = {"wall": wall} if wall in WALLS else {"youngs_modulus": _checked(wall, "Pa", where)}
    return {"bulk_modulus": WATER, "wall_thickness": _checked(thickness, "m", where)} | stiff


def _checked(cell: str, unit: str, where: str) -> str:
    if not Quantity(cell, unit, where) > 0:
        raise InputError(where, "out of range", "above zero", cell)
    return cell
