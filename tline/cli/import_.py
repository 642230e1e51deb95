"""`tline import`: a scene from another program's file."""

from importlib import import_module
from pathlib import Path

import click

from tline.cli.options import check_readable, hours, options_named
from tline.errors import InputError

SPICE, EPANET = "tline.interchange.spice:read_spice", "tline.interchange.water_scene:read_inp"
READERS = {  # by suffix
    ".cir": SPICE, ".ckt": SPICE, ".net": SPICE, ".sp": SPICE, ".inp": EPANET,
}  # fmt: skip
EXAMPLES = """\b
Examples:
  tline import cable.cir -o cable.toml
  tline import cable.cir | head
  tline import town.inp --wave-speed "1000 m/s" -o town.toml
  tline import town.inp --material walls.csv --at-hour 17 -o evening.toml
"""


@click.command("import", epilog=EXAMPLES)
@click.argument("file")
@click.option("-o", "--output", metavar="SCENE.toml", help="Write the scene to a file instead of printing it.")
@click.option("--wave-speed", metavar="SPEED", help="In the pipes of an .inp file; 1000 m/s if nothing is said.")
@click.option("--material", metavar="FILE.csv", help="Rows pipe, wall, thickness or pipe, wave speed; * is all others.")
@click.option("--at-hour", metavar="HOURS", help="Flows, levels and controls so long after an .inp file's start.")
def import_(file: str, output: str | None, wave_speed: str | None, material: str | None, at_hour: str | None) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp) or a network of EPANET (.inp). What no scene has is refused, and the
    line or the element is named. Nothing is left out but what is closed in a network, and you are told.
    """
    from tline.scene.file import scene_text
    from tline.solver.result.atomic import replacing

    suffix = Path(file).suffix.lower()
    if suffix not in READERS:
        raise InputError(file, "unknown kind of file", " or ".join(READERS), suffix or "no suffix")
    module, _, reader = READERS[suffix].partition(":")
    read = getattr(import_module(module), reader)
    water = {"--wave-speed": wave_speed, "--material": material, "--at-hour": at_hour}
    foreign = next(((option, value) for option, value in water.items() if value is not None), None)
    if foreign and READERS[suffix] != EPANET:
        raise InputError(foreign[0], "is for .inp files", "none", foreign[1])
    check_readable(file)
    if READERS[suffix] == EPANET:
        with options_named({"hour": "--at-hour", "wave_speed": "--wave-speed"}):
            scene, notes = read(file, wave_speed, material=material, hour=hours(at_hour))
    else:
        scene, notes = read(file), ()
    text = scene_text(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    if output is None:
        click.echo(text, nl=False)
        return
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")
