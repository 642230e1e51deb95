"""`tline design`: how large what protects from a surge has to be."""

import json
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tline.cli.operating import OPERATING, operated_network, operating
from tline.cli.options import PICTURE, check_files, confined_option, options_named, tolerance

if TYPE_CHECKING:
    from tline.design.sizing import Sizing
    from tline.scene.scene import Scene

EXAMPLES = """\b
Examples:
  tline design vessel pump.toml --at pump --lowest "0.5 bar" --highest "10 bar" -o with_vessel.toml --plot vessel.png
  tline design closure valve.toml valve --highest "16 bar" --stages 2
  tline design relief valve.toml --at end --highest "16 bar" --csv sizes.csv
  tline design vessel town.inp --trip duty@1s --at lift --path lift,a --lowest "0.5 bar"
  tline design closure town.inp ease --highest "8 bar" --for 20s
  tline design flywheel pump.toml pump --path pump,tank --lowest "-2 m"
  tline design separation column_separation.toml
"""
SUFFIXES = {"output": (".toml",), "plot": PICTURE, "csv": (".csv",)}
BAR = 1e5  # Pa


@click.group("design", epilog=EXAMPLES)
def design() -> None:
    """Size what protects from a surge, by runs of a scene with other sizes.

    A network is a scene (.toml) that starts in the steady state and has the surge in it, or a file of EPANET (.inp);
    --trip, --close and the like operate it, as those of `tline surge`. Limits are gauge pressures ("0.5 bar"), or heads
    ("35 m") above the zero of elevations, at all nodes that no reservoir holds or all along a path. Printed are the
    size, its margin to the limit, and the curve of extremes over sizes.
    """


def _common(command: Callable[..., None]) -> Callable[..., None]:
    """Options of every search."""
    command = operating(command)
    options = (
        click.option("--path", metavar="FROM,…,TO", help="Look all along this path instead of at all nodes."),
        click.option("--highest", metavar="LIMIT", help="Highest gauge pressure or head."),
        click.option("--for", "t_end", metavar="TIME", help="How long to run; 60 s, or as long as a scene says."),
        click.option("--tol", metavar="NUMBER", help="Error of the runs relative to the amplitude; 1e-3 if not given."),
        click.option("-o", "--output", metavar="SCENE.toml", help="Write the scene with what was found."),
        click.option("--plot", metavar="FILE", help="Extremes over the size; .png, .svg or .pdf."),
        click.option("--csv", metavar="FILE.csv", help="The same as a table, SI."),
        confined_option,
        click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision."),
    )
    for option in reversed(options):
        command = option(command)
    return command


_lowest = click.option("--lowest", metavar="LIMIT", help="Lowest gauge pressure or head.")
_at = click.option("--at", "at", required=True, metavar="NODE", help="Where it stands.")


@design.command("vessel")
@click.argument("network")
@_at
@_lowest
@click.option("--kv", help="Of the throttle between pipe and vessel, m³/h at 1 bar; none if not given.")
@click.option("--exponent", help="Of the gas: 1.2 if not given.")
@click.option("--reserve", default="0.1", show_default=True, help="Share of liquid when the gas is largest.")
@_common
def vessel(network: str, kv: str | None, exponent: str | None, **given: Any) -> None:
    """The smallest air vessel at a node, and its precharge."""
    more = {key: value for key, value in (("kv", kv), ("exponent", exponent)) if value is not None}
    _design("vessel", network, given | more)


@design.command("closure")
@click.argument("network")
@click.argument("valve")
@_lowest
@click.option("--stages", type=click.IntRange(1, 2), default=1, show_default=True, help="Straight stages.")
@click.option("--begin", metavar="TIME", help="When it begins, instead of what the scene says.")
@_common
def closure(network: str, **given: Any) -> None:
    """The shortest closure of a valve under a pressure rating."""
    _design("closure", network, given)


@design.command("relief")
@click.argument("network")
@_at
@click.option("--set-pressure", metavar="PRESSURE", help="At which it begins to open; 0.9 of the highest if not given.")
@click.option("--band", metavar="PRESSURE", help="Over which it opens; what is left to the highest if not given.")
@click.option("--kv", help="Its capacity, m³/h at 1 bar: then the highest set pressure is searched.")
@_common
def relief(network: str, **given: Any) -> None:
    """The smallest relief valve at a node, or its set pressure."""
    _design("relief", network, given)


@design.command("flywheel")
@click.argument("network")
@click.argument("pump")
@_lowest
@_common
def flywheel(network: str, **given: Any) -> None:
    """The smallest inertia of a pump that trips."""
    _design("flywheel", network, given)


@design.command("separation")
@click.argument("scene")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def separation(scene: str, confined: bool, as_json: bool) -> None:
    """The highest pressure where columns separate, over three numbers of places."""
    from tline.design.columns import separation
    from tline.scene.file import read_scene

    found = separation(read_scene(scene, confined=confined))
    for note in found.notes:
        click.echo(f"note: {note}", err=True)
    click.echo(json.dumps(found.table(), indent=2, ensure_ascii=False) if as_json else str(found))


def _design(kind: str, network: str, given: dict[str, Any]) -> None:
    files = {key: given.pop(key) for key in SUFFIXES}
    check_files({f"--{key}": (file, SUFFIXES[key]) for key, file in files.items()})
    as_json, path, tol, t_end, confined = (given.pop(key) for key in ("as_json", "path", "tol", "t_end", "confined"))
    operations = {key: given.pop(key) for key in OPERATING}
    from tline import design as searches
    from tline.solver.simulate import UnresolvedWarning

    scene, guesses = _operated(network, confined, t_end, tol, operations)
    names = {key: f"--{key.replace('_', '-')}" for key in (*given, "path") if key not in ("valve", "pump")}
    with warnings.catch_warnings(), options_named(names):
        warnings.simplefilter("ignore", UnresolvedWarning)  # said as notes
        found = getattr(searches, kind)(
            scene,
            path=[node.strip() for node in path.split(",")] if path else (),
            tol=None if tol is None else tolerance(tol),
            progress=sys.stderr.isatty(),
            **given,
        )
    for note in (*guesses, *found.notes):
        click.echo(f"note: {note}", err=True)
    _write(found, files)
    if as_json:
        click.echo(json.dumps(found.table(), indent=2, ensure_ascii=False))
        return
    click.echo("\n".join([*_text(found), *(f"wrote {file}" for file in files.values() if file)]))


def _operated(
    network: str, confined: bool, t_end: str | None, tol: str | None, operations: dict[str, Any]
) -> "tuple[Scene, tuple[str, ...]]":
    """The scene in which something is sized, and notes on what was guessed for it."""
    from tline.design.sizing import USUAL_TOL
    from tline.scene.file import EPANET, read_scene

    if Path(network).suffix.lower() in EPANET:
        return operated_network(network, t_end=t_end or "60 s", tol=tol or USUAL_TOL, **operations)
    scene = read_scene(network, confined=confined)
    if any(operations.values()):
        return operated_network(scene, t_end=t_end or scene.t_end, tol=tol or USUAL_TOL, **operations)
    with options_named({"t_end": "--for"}):
        return scene.with_changes(t_end=t_end) if t_end else scene, ()


def _write(found: "Sizing", files: dict[str, str | None]) -> None:
    if files["output"]:
        from tline.scene.file import scene_text
        from tline.solver.result.atomic import replacing

        with replacing(files["output"]) as temporary:
            temporary.write_text(scene_text(found.scene), encoding="utf-8")
    if files["plot"]:
        from tline.pictures.style import save_figure

        save_figure(found.plot(), files["plot"])
    if files["csv"]:
        found.save(files["csv"])


def _text(found: "Sizing") -> list[str]:
    from tline.words.aligned import aligned

    limits, trial = found.limits, found.found
    per, unit = (BAR, "bar") if limits.per_metre is None else (limits.per_metre, "m")
    name, size = found.searched
    head = [name, f"lowest [{unit}]", f"highest [{unit}]", f"margin [{unit}]"]
    rows = [
        [str(size._replace(value=each.size)), *(f"{value / per:.4g}" for value in each[1:4])] for each in found.curve
    ]
    error = f", estimated error {trial.error / per:.1g} {unit}" if trial.error == trial.error else ""
    return [
        f"{found.scene.title or 'a scene'}: {found.kind}, {found.element}",
        *aligned([[key, str(size)] for key, size in found.sizes.items()], 2),
        f"{limits.word} {limits.where}: {limits.shown(trial.lowest)} to {limits.shown(trial.highest)}, "
        f"margin {trial.margin / per:.2g} {unit}{error}",
        "",
        *aligned([head, *rows], 0),
    ]
