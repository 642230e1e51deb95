"""Commands `tline import`, `export` and `schema`: scenes from and for other programs, and for editors."""

import json
from pathlib import Path
from typing import Any

import click

from tline.cli.from_signature import command
from tline.cli.options import hours, print_or_write
from tline.errors import InputError

READ = "tline.interchange.water_scene:read_inp"


@command(
    READ,
    names={"hour": "at_hour"},
    omit=("path",),
    epilog="""\b
Examples:
  tline import cable.cir -o cable.toml
  tline import cable.cir | head
  tline import town.inp --wave-speed "1000 m/s" -o town.toml
  tline import town.inp --material walls.csv --at-hour 17 -o evening.toml
""",
)
def import_(file: str, *, output: str | None = None, **given: Any) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp, .spi), a schematic of LTspice (.asc) or a network of EPANET (.inp).
    Elements that scenes lack are refused, all at once, by line or name. Parts left out without harm are noted.

    Parameters
    ----------
    output : SCENE.toml
        Write the scene to a file instead of printing it.
    """
    from tline.interchange.any_file import read_foreign
    from tline.scene.file import scene_text

    given |= {"hour": hours(given["hour"])} if "hour" in given else {}
    scene, notes = read_foreign(Path(file), **given)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    print_or_write(scene_text(scene), output)


@command(
    epilog="""\b
Examples:
  tline export cable.toml -o cable.cir
  tline export cable.toml --rise "1 ps" | head
"""
)
def export(scene: str, *, output: str | None = None, rise: str | None = None, confined: bool = False) -> None:
    """Turn an electrical scene into a SPICE netlist.

    Lines become T elements, sources V or I with their resistors, loads R, L and C, probes .save, all values exact.
    Elements that netlists lack are refused by name.

    Parameters
    ----------
    output : FILE.cir
        Write the netlist to a file instead of printing it.
    rise : TIME
        Duration of a jump in the netlist, such as '1 ps': SPICE has no jumps.
    """
    from tline.interchange.any_file import read
    from tline.interchange.netlist_text import spice_text
    from tline.units import to_si

    if output is not None and not output.lower().endswith(".cir"):
        raise InputError("--output", "unknown kind of file", ".cir", f"'{output}'")
    seconds = None if rise is None else to_si(rise, "s", "--rise")
    if seconds is not None and not seconds > 0:
        raise InputError("--rise", "not above zero", "a time such as '1 ps'", rise or "")
    print_or_write(spice_text(read(scene, confined=confined), seconds), output)


@command(
    epilog="""\b
Examples:
  tline schema -o scene.schema.json
  tline schema | head
"""
)
def schema(*, output: str | None = None) -> None:
    """Print the JSON schema of scene files.

    An editor with TOML support completes and checks scenes with it; the first line of the scene names it:
    `#:schema scene.schema.json`.

    Parameters
    ----------
    output : FILE
        Write to a file instead of printing.
    """
    from tline.scene.file import schema as describe

    print_or_write(json.dumps(describe(), indent=2, ensure_ascii=False) + "\n", output)
