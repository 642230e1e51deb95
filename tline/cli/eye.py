"""`tline eye`: a bit pattern as a probe sees it."""

import json
from typing import TYPE_CHECKING

import click

from tline.cli.options import PICTURE, check_files, confined_option, options_named, tol_option, tolerance
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.signal.eye_diagram import Eye
    from tline.signal.eye_statistics import Mask

EXAMPLES = """\b
Examples:
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --plot eye.png
  tline eye cable.toml --probe far --bit "1 ns" --rise "0.2 ns" --bits 00101110 --high "3.3 V" --json
  tline eye scenes/ddr_ibis.toml --probe die --bit "1 ns" --plot eye.png
"""


@click.command("eye", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--probe", metavar="NAME", required=True, help="Probe at which the eye is measured.")
@click.option("--bit", metavar="TIME", required=True, help="Time of a bit.")
@click.option("--rise", metavar="TIME", help="Time of a change from level to level; a driver has edges of its own.")
@click.option("--bits", default="prbs7", show_default=True, help="Zeros and ones, or 'prbs7'.")
@click.option("--source", metavar="NAME", help="Source or driver that sends them; not needed if there is one only.")
@click.option("--low", default="0", show_default=True, metavar="LEVEL", help="Level of a zero.")
@click.option("--high", default="1", show_default=True, metavar="LEVEL", help="Level of a one.")
@click.option("--plot", metavar="FILE", help="Eye diagram; .png, .svg or .pdf.")
@click.option("--mask", metavar="TIME,LEVEL", help="Width and height of a hexagon in its middle, as '0.4 ns, 0.3 V'.")
@tol_option
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def eye(
    scene: str,
    probe: str,
    bit: str,
    rise: str | None,
    bits: str,
    plot: str | None,
    mask: str | None,
    tol: str | None,
    confined: bool,
    as_json: bool,
    **given: str,
) -> None:
    """Send a bit pattern through a scene, and measure how far the eye opens at a probe.

    The pattern is sent twice, and the second round is measured. The width is taken half way between ones and zeros
    where the eye is highest; the height in the middle of that width, the sampling instant; the jitter is the spread of
    the crossings of that level. A closed eye, or one that touches the mask, exits with 1.
    """
    check_files({"--plot": (plot, PICTURE)})
    from tline.scene.file import read_scene
    from tline.scene.medium import MEDIA
    from tline.signal.eye_diagram import eye as measure
    from tline.signal.eye_statistics import jitter, mask_hits

    read = read_scene(scene, confined=confined)
    levels = {key: float(value) if _is_number(value) else value for key, value in given.items() if key != "source"}
    names = {"period": "--bit", "rise": "--rise", "bits": "--bits", "probe": "--probe", "source": "--source"}
    with options_named(names):
        asked = None if tol is None else tolerance(tol)
        seen = measure(read, probe, bit, rise, bits, source=given["source"], tol=asked, progress=True, **levels)
    medium = MEDIA[read.medium]
    unit = medium.units["effort"]
    hexagon = None if mask is None else _mask(mask, seen, unit)
    spread, hits = jitter(seen), 0 if hexagon is None else mask_hits(seen, hexagon)
    if plot:
        from tline.pictures.eye import plot_eye
        from tline.pictures.style import save_figure

        save_figure(plot_eye(seen, medium, read.title, hexagon), plot)
    if as_json:
        told = {"height": seen.height, "width": seen.width, "instant": seen.instant, "threshold": seen.threshold}
        told |= {"jitter": spread.peak_to_peak, "jitter_rms": spread.rms} | ({"mask_hits": hits} if hexagon else {})
        click.echo(json.dumps(told | {"bits": len(seen.bits), "period": seen.period, "unit": unit}))
    else:
        click.echo(f"{len(seen.bits)} bits of {seen.period:.6g} s at '{probe}'")
        click.echo(f"height {seen.height:.6g} {unit} around {seen.threshold:.6g} {unit}, width {seen.width:.6g} s")
        click.echo(f"jitter {spread.peak_to_peak:.6g} s from peak to peak, {spread.rms:.6g} s rms")
        if hexagon:
            click.echo(f"mask touched by {hits} of {len(seen.bits)} bits")
        click.echo(f"sampled {seen.instant:.6g} s after the begin of a bit at the source")
        if plot:
            click.echo(f"wrote {plot}")
    if seen.height <= 0 or hits:
        raise click.exceptions.Exit(1)


def _mask(text: str, seen: "Eye", unit: str) -> "Mask":
    from tline.signal.eye_statistics import mask_of

    parts = [float(part) if _is_number(part) else part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise InputError("--mask", "not a width and a height", "such as '0.4 ns, 0.3 V'", f"'{text}'")
    with options_named({"mask": "--mask"}):
        return mask_of(parts[0], parts[1], seen, unit)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
