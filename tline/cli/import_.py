"""`tline import`: a scene from another program's file."""

from importlib import import_module
from pathlib import Path

import click

from tline.errors import InputError

SPICE = "tline.interchange.spice:read_spice"
READERS = {  # by suffix
    ".cir": SPICE, ".ckt": SPICE, ".net": SPICE, ".sp": SPICE,
}  # fmt: skip
EXAMPLES = """\b
Examples:
  tline import cable.cir -o cable.toml
  tline import cable.cir | head
"""


@click.command("import", epilog=EXAMPLES)
@click.argument("file")
@click.option("-o", "--output", metavar="SCENE.toml", help="Write the scene to a file instead of printing it.")
def import_(file: str, output: str | None) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp). What no scene has is refused, and the line and the element are
    named; nothing is left out.
    """
    from tline.scene.file import scene_text
    from tline.solver.atomic import replacing

    suffix = Path(file).suffix.lower()
    if suffix not in READERS:
        raise InputError(file, "unknown kind of file", " or ".join(READERS), suffix or "no suffix")
    module, _, reader = READERS[suffix].partition(":")
    text = scene_text(getattr(import_module(module), reader)(file))
    if output is None:
        click.echo(text, nl=False)
        return
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")
