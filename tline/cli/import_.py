"""`tline import`: a scene from another program's file."""

from importlib import import_module
from pathlib import Path

import click

from tline.cli.options import check_readable
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
"""


@click.command("import", epilog=EXAMPLES)
@click.argument("file")
@click.option("-o", "--output", metavar="SCENE.toml", help="Write the scene to a file instead of printing it.")
@click.option("--wave-speed", metavar="SPEED", help="In the pipes of an .inp file, such as '1000 m/s'.")
def import_(file: str, output: str | None, wave_speed: str | None) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp) or a network of EPANET (.inp). What no scene has is refused, and the
    line or the element is named. Nothing is left out but what is closed in a network, and you are told.
    """
    from tline.scene.file import scene_text
    from tline.solver.result.atomic import replacing

    suffix = Path(file).suffix.lower()
    if suffix not in READERS:
        raise InputError(file, "unknown kind of file", " or ".join(READERS), suffix or "no suffix")
    if (wave_speed is None) == (READERS[suffix] == EPANET):
        if wave_speed is None:
            raise InputError("--wave-speed", "is missing, for an .inp file has none", "such as --wave-speed '1000 m/s'")
        raise InputError("--wave-speed", "is for .inp files", "none", wave_speed)
    check_readable(file)
    module, _, reader = READERS[suffix].partition(":")
    read = getattr(import_module(module), reader)
    scene, notes = (read(file), ()) if wave_speed is None else read(file, wave_speed)
    text = scene_text(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    if output is None:
        click.echo(text, nl=False)
        return
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")
