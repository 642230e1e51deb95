"""`tline tdr`: time-domain reflectometry at a node of a scene."""

import json

import click

from tline.cli.options import PICTURE, check_files, confined_option, options_named, tol_option, tolerance

EXAMPLES = """\b
Examples:
  tline tdr cable.toml --port near --rise "50 ps" --plot tdr.png
  tline tdr cable.toml --port near --rise "50 ps" --z0 50 --csv tdr.csv
"""


@click.command("tdr", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--port", metavar="NODE", required=True, help="Where the instrument is; sources there are taken away.")
@click.option("--rise", metavar="TIME", required=True, help="What the step takes, such as '50 ps'.")
@click.option("--z0", metavar="OHM", help="Resistance of the instrument; that of the first line there if not given.")
@click.option("--to", "t_end", metavar="TIME", help="How long to look; until the scene's end if not given.")
@click.option("--csv", metavar="FILE.csv", help="Time, incident and reflected wave per step, impedance.")
@click.option("--plot", metavar="FILE", help="Waves and impedance over time; .png, .svg or .pdf.")
@tol_option
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print all numbers.")
def tdr(
    scene: str,
    port: str,
    csv: str | None,
    plot: str | None,
    tol: str | None,
    confined: bool,
    as_json: bool,
    **given: str | None,
) -> None:
    """Send a step into a node of a scene, and show what comes back.

    The impedance is z0 (1 + ρ)/(1 - ρ) of the reflected wave ρ, as if each reflection had come back on its first way:
    exact up to the first discontinuity, misled by multiple reflections behind it. Other sources are silent.
    """
    check_files({"--csv": (csv, (".csv",)), "--plot": (plot, PICTURE)})
    from tline.scene.file import read_scene
    from tline.scene.medium import MEDIA
    from tline.signal.tdr import reflectometry, save_reflections

    read = read_scene(scene, confined=confined)
    with options_named({"node": "--port", "rise": "--rise", "z0": "--z0", "t_end": "--to"}):
        chosen = {} if tol is None else {"tol": tolerance(tol)}
        seen = reflectometry(read, port, given["rise"] or "", given["z0"], given["t_end"], **chosen, progress=True)
    medium = MEDIA[read.medium]
    if csv:
        save_reflections(seen, csv)
    if plot:
        from tline.pictures.reflections import plot_reflections
        from tline.pictures.style import save_figure

        save_figure(plot_reflections(seen, medium, read.title), plot)
    z = [each if each < float("inf") else None for each in seen.impedance.tolist()]
    if as_json:
        waves = {"incident": seen.incident.tolist(), "reflected": seen.reflected.tolist()}
        click.echo(json.dumps({"z0": seen.z0, "t": seen.t.tolist(), **waves, "impedance": z}))
        return
    unit = medium.units["resistance"]
    click.echo(f"step into '{port}' from {seen.z0:.6g} {unit}, reflected wave per step:")
    for word, k in (("lowest", seen.reflected.argmin()), ("highest", seen.reflected.argmax())):
        size = "open" if z[k] is None else f"{z[k]:.6g} {unit}"
        click.echo(f"  {word} {seen.reflected[k]:.6g} at {seen.t[k]:.6g} s: {size}")
    for file in filter(None, (csv, plot)):
        click.echo(f"wrote {file}")
