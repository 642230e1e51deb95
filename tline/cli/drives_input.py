"""What `tline drives` is given: parameters with units, torques over time, files."""

import csv
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tline.errors import InputError
from tline.scene.text_file import read_text, read_toml
from tline.units import to_si

if TYPE_CHECKING:
    from drives import CoupledDrives, Torque

BARE = re.compile(r"\s*[+-]?[0-9.]+(e[+-]?[0-9]+)?\s*", re.IGNORECASE)
# key: unit, part, its field, help
PARAMETERS = {
    "inertia": ("kg m^2", "spool", "inertia", "J of the spools, '1e-3 kg m^2' if not given."),
    "friction": ("N m s/rad", "spool", "friction", "B of the spools, '0.1 N m s' if not given."),
    "radius": ("m", "spool", "radius", "r of the spools, '10 cm' if not given."),
    "belt_stiffness": ("N/m", "belt", "stiffness", "K of the belt's sections, '50 N/m' if not given."),
    "belt_damping": ("N s/m", "belt", "damping", "Damping of the belt's sections, '0.5 N s/m' if not given."),
    "pulley_stiffness": ("N/m", "pulley", "stiffness", "k of the pulley's spring, '200 N/m' if not given."),
    "angle": ("rad", "pulley", "angle", "θ between belt and pulley's way, '45 deg' if not given."),
}
DEFAULTS = {
    "inertia": "1e-3 kg m^2",
    "friction": "0.1 N m s",
    "radius": "10 cm",
    "belt_stiffness": "50 N/m",
    "belt_damping": "0.5 N s/m",
    "pulley_stiffness": "200 N/m",
    "angle": "45 deg",
}


def build(file: str | None, given: dict[str, str | None]) -> "CoupledDrives":
    """The mechanism from options over the file over the exercise."""
    from drives import Belt, CoupledDrives, Pulley, Spool

    table = _read_parameters(file) if file else {}
    sides: dict[str, list[dict[str, Any]]] = {"spool": [{}, {}], "belt": [{}, {}], "pulley": [{}]}
    for name, (unit, part, key, _) in PARAMETERS.items():
        option = f"--{name.replace('_', '-')}"
        where, value = (option, given[name]) if given[name] is not None else (f"{file}: {name}", table.get(name))
        texts = value.split(",") if isinstance(value, str) else value if isinstance(value, list) else [value]
        texts = [DEFAULTS[name]] if value is None else texts
        if len(texts) not in (1, len(sides[part])):
            expected = "one value" if part == "pulley" else "one value, or two: left, right"
            raise InputError(where, "the wrong number of values", expected, f"{len(texts)}")
        for side, text in zip(sides[part], texts * 2, strict=False):
            side[key] = where, quantity(where, text, unit)
    left, right = (_part(Spool, side) for side in sides["spool"])
    left_belt, right_belt = (_part(Belt, side) for side in sides["belt"])
    return CoupledDrives(left, right, left_belt, right_belt, _part(Pulley, sides["pulley"][0]))


def _part(kind: Callable, side: dict[str, tuple[str, float]]) -> Any:
    """A part, whose mistakes are named by the option or the key they come from."""
    from drives import InputError as DrivesError

    try:
        return kind(**{key: value for key, (_, value) in side.items()})
    except DrivesError as error:
        raise InputError(side[error.where][0], error.problem, error.expected, error.got) from error


def _read_parameters(file: str) -> dict[str, Any]:
    table = read_toml(Path(file), "parameters in TOML")
    for name in table:
        if name not in PARAMETERS:
            raise InputError(f"{file}: {name:.60}", "unknown parameter", ", ".join(PARAMETERS))
    return table


def quantity(where: str, given: Any, unit: str) -> float:
    """Value in SI; a text without a unit, or a number, is refused."""
    example = "a quantity such as '45 deg'" if unit == "rad" else f"a quantity such as '1 {unit}'"
    if not isinstance(given, str):
        raise InputError(where, "not a text with a unit", example, repr(given)[:40])
    if BARE.fullmatch(given) or (unit == "rad" and not re.search(r"deg|°|rad", given)):
        raise InputError(where, "the unit is missing", example, repr(given)[:40])
    return to_si(given, unit, where)


def torques(t1: str | None, t2: str | None, rise: str | None, table: str | None, hold: bool) -> "tuple[Torque, Torque]":
    """T1 and T2 from the options of `tline drives step`."""
    from drives import Torque

    if table is not None:
        if t1 or t2 or rise:
            raise InputError("--table", "the torques are given twice", "either a table, or --t1, --t2 and --rise")
        return _table(table, hold)
    if hold:
        raise InputError("--hold", "nothing to hold", "--table beside it")
    if t1 is None and t2 is None:
        t1 = t2 = "0.1 N m"
    heights = [quantity(where, text or "0 N m", "N m") for where, text in (("--t1", t1), ("--t2", t2))]
    if rise is None:
        return Torque.step(heights[0]), Torque.step(heights[1])
    length = quantity("--rise", rise, "s")
    if not length > 0:
        raise InputError("--rise", "not a time", "more than 0 s", repr(rise))
    return Torque.ramp(heights[0], 0.0, length), Torque.ramp(heights[1], 0.0, length)


def _table(file: str, hold: bool) -> "tuple[Torque, Torque]":
    from drives import InputError as DrivesError
    from drives import Torque

    try:
        rows = [row for row in csv.reader(read_text(Path(file)).splitlines()) if row]
    except csv.Error as error:
        raise InputError(file, f"cannot be read: {error}", "t,T1,T2") from None
    if not rows or [name.strip() for name in rows[0]] != ["t", "T1", "T2"]:
        raise InputError(file, "another header", "t,T1,T2", repr(",".join(rows[0]))[:40] if rows else "nothing")
    try:
        values = [[float(x) for x in row] for row in rows[1:]]
        t, first, second = zip(*values, strict=True)
    except ValueError:
        bad = next((k for k, row in enumerate(rows[1:], 2) if not _is_row(row)), 2)
        raise InputError(f"{file}, row {bad}", "not three numbers", "t,T1,T2 in SI") from None
    try:
        return Torque.table(t, first, held=hold), Torque.table(t, second, held=hold)
    except DrivesError as error:
        raise InputError(f"{file}, {error.where}", error.problem, error.expected, error.got) from error


def _is_row(row: list[str]) -> bool:
    try:
        return len([float(x) for x in row]) == 3
    except ValueError:
        return False
