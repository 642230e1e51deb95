"""Mechanism of `tline drives` from options and files: parts, dry friction, a wound belt, torques."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from tline.cli.docstrings import arguments_of
from tline.cli.options import check_partners, options_named, read_columns
from tline.errors import InputError
from tline.scene.text_file import read_toml
from tline.units import to_si

if TYPE_CHECKING:
    from drives import CoupledDrives, Torque
    from friction import Model

BARE = re.compile(r"\s*[+-]?[0-9.]+(e[+-]?[0-9]+)?\s*", re.IGNORECASE)
TWO = " Two with a comma between: left, right."


class Parameter(NamedTuple):
    """Parameter of the mechanism: its unit, its part, its name and class there, and the exercise's value."""

    unit: str
    part: str
    name: str
    kind: str
    default: str

    def option(self, key: str) -> click.Option:
        """Option for the parameter, with the help of the part's docstring."""
        told = arguments_of(f"drives.parts:{self.kind}")[self.name].help.partition(". ")[0].rstrip(".")
        two = "" if self.part == "pulley" else TWO
        text = f"{told}; '{self.default}' if not given.{two}"
        return click.Option([f"--{key.replace('_', '-')}", key], metavar="VALUE", help=text)


PARAMETERS = {
    "inertia": Parameter("kg m^2", "spool", "inertia", "Spool", "1e-3 kg m^2"),
    "friction": Parameter("N m s/rad", "spool", "friction", "Spool", "0.1 N m s"),
    "radius": Parameter("m", "spool", "radius", "Spool", "10 cm"),
    "belt_stiffness": Parameter("N/m", "belt", "stiffness", "Belt", "50 N/m"),
    "belt_damping": Parameter("N s/m", "belt", "damping", "Belt", "0.5 N s/m"),
    "pulley_stiffness": Parameter("N/m", "pulley", "stiffness", "Pulley", "200 N/m"),
    "angle": Parameter("rad", "pulley", "angle", "Pulley", "45 deg"),
    "pulley_mass": Parameter("kg", "pulley", "mass", "Pulley", "0 kg"),
}
MECHANISM = (
    click.Option(
        ["--parameters"],
        metavar="FILE.toml",
        help="Parameters by the names of these options, as texts with units, or pairs of texts.",
    ),
    *(each.option(key) for key, each in PARAMETERS.items()),
)
LOOSE = (
    click.Option(["--coulomb"], metavar="TORQUE", help="Dry friction in the bearings, beside the viscous one." + TWO),
    click.Option(["--break-away"], metavar="TORQUE", help="What it takes to leave rest, as much if not given." + TWO),
    click.Option(["--stribeck"], metavar="ω", help="Angular speed over which friction falls from that." + TWO),
    click.Option(["--thickness"], metavar="LENGTH", help="Of a belt that is wound from spool 1 on spool 2."),
    click.Option(["--line-density"], metavar="kg/m", help="Its mass per length, nothing if not given."),
)


def mechanism(given: dict[str, Any]) -> "CoupledDrives":
    """Build the mechanism from its parameters, removed from those given: options over the file over the exercise."""
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
    """Build a part; errors name the option or the key of the value."""
    with options_named({key: where for key, (where, _) in side.items()}):
        return kind(**{key: value for key, (_, value) in side.items()})


def _read_parameters(file: str) -> dict[str, Any]:
    table = read_toml(Path(file), "parameters in TOML")
    for name in table:
        if name not in PARAMETERS:
            raise InputError(f"{file}: {name:.60}", "unknown parameter", ", ".join(PARAMETERS))
    return table


def quantity(where: str, given: Any, unit: str) -> float:
    """Convert a text to SI; a text without a unit, or a number, is refused."""
    example = "a quantity such as '45 deg'" if unit == "rad" else f"a quantity such as '1 {unit}'"
    if not isinstance(given, str):
        raise InputError(where, "not a text with a unit", example, repr(given)[:40])
    if BARE.fullmatch(given) or (unit == "rad" and not re.search(r"deg|°|rad", given)):
        raise InputError(where, "the unit is missing", example, repr(given)[:40])
    return to_si(given, unit, where)


def loosely(given: dict[str, Any]) -> dict[str, Any]:
    """Dry friction and winding, removed from the options given; empty if there is neither."""
    from drives import Winding

    names = ("coulomb", "break_away", "stribeck", "thickness", "line_density")
    check_partners(given, {"break_away": "coulomb", "stribeck": "break_away", "line_density": "thickness"})
    *dry, thickness, density = (given.pop(name, None) for name in names)
    laws, found = _dry_friction(*dry), dict[str, Any]()
    if any(laws):
        found["friction"] = laws
    if thickness is not None:
        with options_named({"thickness": "--thickness", "line_density": "--line-density"}):
            per_length = quantity("--line-density", density, "kg/m") if density else 0.0
            found["winding"] = Winding(quantity("--thickness", thickness, "m"), per_length)
    return found


def _dry_friction(coulomb: str | None, break_away: str | None, stribeck: str | None) -> "list[Model | None]":
    """Laws of the left and the right bearing, None where friction is viscous alone."""
    from friction import Coulomb, Karnopp

    given = {
        "coulomb": (coulomb, "N m", "F_c"),
        "break_away": (break_away, "N m", "F_s"),
        "stribeck": (stribeck, "rad/s", "v_s"),
    }
    sides: list[dict[str, float]] = [{}, {}]
    for name, (text, unit, symbol) in given.items():
        where, parts = f"--{name.replace('_', '-')}", (text or "").split(",")
        if len(parts) > 2:
            raise InputError(where, "the wrong number of values", "one value, or two: left, right", f"{len(parts)}")
        for side, part in zip(sides, parts * 2, strict=False):
            side |= {symbol: quantity(where, part, unit)} if text is not None else {}
    laws: list[Model | None] = []
    with options_named({"model.F_c": "--coulomb", "model.F_s": "--break-away", "model.v_s": "--stribeck"}):
        for side in sides:
            dry = side.get("F_c", 0.0) or side.get("F_s", 0.0)
            laws.append((Karnopp(F_v=0.0, **side) if "F_s" in side else Coulomb(**side)) if dry else None)
    return laws


def torques(t1: str | None, t2: str | None, rise: str | None, table: str | None, hold: bool) -> "tuple[Torque, Torque]":
    """Torques T1 and T2 from the options of `tline drives step`."""
    from drives import Torque

    check_partners({"hold": hold, "table": table}, {"hold": "table"})
    if table is not None:
        if t1 or t2 or rise:
            raise InputError("--table", "the torques are given twice", "either a table, or --t1, --t2 and --rise")
        found = read_columns(table, table, {"t": "s", "T1": "N m", "T2": "N m"})
        if len(found) < 3:
            raise InputError(table, "a column is missing", "t, T1, T2", ", ".join(found))
        with options_named({"times": table, "torque table": table}):
            first, second = (Torque.table(found["t"], found[name], held=hold) for name in ("T1", "T2"))
        return first, second
    if t1 is None and t2 is None:
        t1 = t2 = "0.1 N m"
    heights = [quantity(where, text or "0 N m", "N m") for where, text in (("--t1", t1), ("--t2", t2))]
    if rise is None:
        return Torque.step(heights[0]), Torque.step(heights[1])
    length = quantity("--rise", rise, "s")
    if not length > 0:
        raise InputError("--rise", "not a time", "more than 0 s", repr(rise))
    return Torque.ramp(heights[0], 0.0, length), Torque.ramp(heights[1], 0.0, length)
