"""What `tline drives` is given: parameters with units, torques over time, files."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from tline.cli.columns import read_columns
from tline.cli.docstrings import arguments_of
from tline.cli.options import options_named
from tline.errors import InputError
from tline.scene.text_file import read_toml
from tline.units import to_si

if TYPE_CHECKING:
    from drives import CoupledDrives, Torque

BARE = re.compile(r"\s*[+-]?[0-9.]+(e[+-]?[0-9]+)?\s*", re.IGNORECASE)


class Parameter(NamedTuple):
    """A number of the mechanism: its unit, of which part, its name and class there, and the exercise's value."""

    unit: str
    part: str
    name: str
    kind: str
    default: str

    def option(self, key: str) -> click.Option:
        """The option that gives it, explained as the part explains it."""
        told = arguments_of(f"drives.parts:{self.kind}")[self.name].help.partition(". ")[0].rstrip(".")
        two = "" if self.part == "pulley" else " Two with a comma between: left, right."
        text = f"{told}; '{self.default}' if not given.{two}"
        return click.Option([f"--{key.replace('_', '-')}", key], metavar="VALUE", help=text)


class Asked(NamedTuple):
    """A number that a run under control is asked for: its unit, the value if none is given, and its help."""

    unit: str
    default: str | None = None
    help: str = ""


PARAMETERS = {
    "inertia": Parameter("kg m^2", "spool", "inertia", "Spool", "1e-3 kg m^2"),
    "friction": Parameter("N m s/rad", "spool", "friction", "Spool", "0.1 N m s"),
    "radius": Parameter("m", "spool", "radius", "Spool", "10 cm"),
    "belt_stiffness": Parameter("N/m", "belt", "stiffness", "Belt", "50 N/m"),
    "belt_damping": Parameter("N s/m", "belt", "damping", "Belt", "0.5 N s/m"),
    "pulley_stiffness": Parameter("N/m", "pulley", "stiffness", "Pulley", "200 N/m"),
    "angle": Parameter("rad", "pulley", "angle", "Pulley", "45 deg"),
}
FROM_FILE = "Parameters by the names of these options, as texts with units, or pairs of texts."
MECHANISM = (
    click.Option(["--parameters"], metavar="FILE.toml", help=FROM_FILE),
    *(each.option(key) for key, each in PARAMETERS.items()),
)
ASKED = {
    "speed": Asked("m/s", "1 m/s", "Set point of the belt speed."),
    "tension": Asked("N", "5 N", "Set point of the tension."),
    "disturbance": Asked("N m", "0 N m", "Torque on spool 1 from half of the run on."),
    "speed_bandwidth": Asked("rad/s"),  # what these are, the design and the run say
    "tension_bandwidth": Asked("rad/s"),
    "limit": Asked("N m"),
}
SET_POINTS = tuple(
    click.Option([f"--{key}"], metavar=each.unit, default=each.default, show_default=True, help=each.help)
    for key, each in ASKED.items()
    if each.default
)


def numbers_of(given: Mapping[str, str]) -> dict[str, float]:
    """What a run under control is asked for, in SI."""
    texts = {key: given.get(key, each.default) for key, each in ASKED.items()}
    return {key: quantity(f"--{key.replace('_', '-')}", text, ASKED[key].unit) for key, text in texts.items() if text}


def mechanism(given: dict[str, Any]) -> "CoupledDrives":
    """The mechanism, whose parameters are taken out of what is given: options over the file over the exercise."""
    from drives import Belt, CoupledDrives, Pulley, Spool

    file = given.pop("parameters", None)
    table = _read_parameters(file) if file else {}
    sides: dict[str, list[dict[str, Any]]] = {"spool": [{}, {}], "belt": [{}, {}], "pulley": [{}]}
    for name, each in PARAMETERS.items():
        where, value = f"--{name.replace('_', '-')}", given.pop(name, None)
        if value is None:
            where, value = f"{file}: {name}", table.get(name, each.default)
        texts = value.split(",") if isinstance(value, str) else value if isinstance(value, list) else [value]
        if len(texts) not in (1, len(sides[each.part])):
            expected = "one value" if each.part == "pulley" else "one value, or two: left, right"
            raise InputError(where, "the wrong number of values", expected, f"{len(texts)}")
        for side, text in zip(sides[each.part], texts * 2, strict=False):
            side[each.name] = where, quantity(where, text, each.unit)
    left, right = (_part(Spool, side) for side in sides["spool"])
    left_belt, right_belt = (_part(Belt, side) for side in sides["belt"])
    return CoupledDrives(left, right, left_belt, right_belt, _part(Pulley, sides["pulley"][0]))


def _part(kind: Callable, side: dict[str, tuple[str, float]]) -> Any:
    """A part, whose mistakes are named by the option or the key they come from."""
    with options_named({key: where for key, (where, _) in side.items()}):
        return kind(**{key: value for key, (_, value) in side.items()})


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
        found = read_columns(table, table, {"t": "s", "T1": "N m", "T2": "N m"})
        if len(found) < 3:
            raise InputError(table, "a column is missing", "t, T1, T2", ", ".join(found))
        with options_named({"times": table, "torque table": table}):
            first, second = (Torque.table(found["t"], found[name], held=hold) for name in ("T1", "T2"))
        return first, second
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
