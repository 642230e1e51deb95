"""`tline export`: a scene for another program."""

import click

from tline.cli.options import confined_option

EXAMPLES = """\b
Examples:
  tline export cable.toml -o cable.cir
  tline export cable.toml --rise "1 ps" | head
"""


@click.command("export", epilog=EXAMPLES)
@click.argument("scene")
@click.option("-o", "--output", metavar="FILE.cir", help="Write the netlist to a file instead of printing it.")
@click.option("--rise", metavar="TIME", help="What a jump takes in the netlist, such as '1 ps': SPICE has no jumps.")
@confined_option
def export(scene: str, output: str | None, rise: str | None, confined: bool) -> None:
    """Turn an electrical scene into a SPICE netlist.

    Lines become T elements, sources V or I with their resistors, loads R, L and C, probes .save, all values exact. What
    a netlist cannot say is refused, and the element is named.
    """
    from pathlib import Path

    from tline.errors import InputError
    from tline.interchange.netlist_text import spice_text
    from tline.scene.file import read_scene
    from tline.solver.result.atomic import replacing
    from tline.units import to_si

    if output is not None and Path(output).suffix.lower() != ".cir":
        raise InputError("--output", "unknown kind of file", ".cir", f"'{output}'")
    seconds = None if rise is None else to_si(rise, "s", "--rise")
    if seconds is not None and not seconds > 0:
        raise InputError("--rise", "not above zero", "a time such as '1 ps'", rise or "")
    text = spice_text(read_scene(scene, confined=confined), seconds)
    if output is None:
        click.echo(text, nl=False)
        return
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")
