"""`tline import`: a scene from another program's file."""

from pathlib import Path
from typing import Any

import click

from tline.cli.from_signature import command
from tline.cli.options import hours, print_or_write

EXAMPLES = """\b
Examples:
  tline import cable.cir -o cable.toml
  tline import cable.cir | head
  tline import town.inp --wave-speed "1000 m/s" -o town.toml
  tline import town.inp --material walls.csv --at-hour 17 -o evening.toml
"""
READ = "tline.interchange.water_scene:read_inp"


@command(READ, names={"hour": "at_hour"}, omit=("path",), epilog=EXAMPLES)
def import_(file: str, *, output: str | None = None, **given: Any) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp, .spi) or a network of EPANET (.inp). What no scene has is refused,
    all of it at once, and the lines or the elements are named. What is left out without harm is noted.

    Parameters
    ----------
    output : SCENE.toml
        Write the scene to a file instead of printing it.
    """
    from tline.interchange.any_file import read_foreign
    from tline.scene.file import scene_text

    given |= {"hour": hours(given["hour"])} if "hour" in given else {}
    with import_.named():
        scene, notes = read_foreign(Path(file), **given)
    text = scene_text(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    print_or_write(text, output)
