"""`tline import`: a scene from another program's file."""

import click

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
@click.option("--moving-tanks", is_flag=True, help="Tanks of an .inp file fill and empty, instead of holding levels.")
def import_(
    file: str, output: str | None, wave_speed: str | None, material: str | None, at_hour: str | None, moving_tanks: bool
) -> None:
    """Turn another program's file into a scene.

    FILE is a SPICE netlist (.cir, .ckt, .net, .sp, .spi) or a network of EPANET (.inp). What no scene has is refused,
    all of it at once, and the lines or the elements are named. What is left out without harm is noted.
    """
    from pathlib import Path

    from tline.cli.options import hours, options_named
    from tline.interchange.any_file import read_foreign
    from tline.scene.file import scene_text
    from tline.solver.result.atomic import replacing

    with options_named({"hour": "--at-hour", "wave_speed": "--wave-speed", "material": "--material"}):
        scene, notes = read_foreign(
            Path(file), wave_speed=wave_speed, material=material, hour=hours(at_hour), moving_tanks=moving_tanks or None
        )
    text = scene_text(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    if output is None:
        click.echo(text, nl=False)
        return
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")
