"""`tline run`: simulate a scene, print what the probes saw, and write files and pictures."""

import json
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tline.cli.options import confined_option, options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from tline.pictures.path import Route
    from tline.scene.scene import Scene
    from tline.solver.result.accuracy import Accuracy
    from tline.solver.result.result import Result

PICTURE = (".png", ".svg", ".pdf")
SUFFIXES = {  # of what can be written
    "csv": (".csv",),
    "npz": (".npz",),
    "envelope": (".csv",),
    "ledger_csv": (".csv",),
    "plot": PICTURE,
    "profile": PICTURE,
    "map": PICTURE,
    "space_time": PICTURE,
    "lattice": PICTURE,
    "load_lines": PICTURE,
    "animate": (".html", ".gif"),
}
ALONG = ("profile", "space_time", "animate")  # show a path
ENVELOPES = ("envelope", "map")  # show the extremes at nodes
UNCERTAIN = 0.05  # of an amplitude
EXAMPLES = """\b
Examples:
  tline run valve.toml --tol 1e-8 --plot valve.png
  tline run network.toml --order 8 --slab "10 us" --csv probes.csv \\
      --path tank,valve --animate surge.html
  tline run valve.toml --csv out.csv --at "0:2 s:2001"
  tline run valve.toml --ledger
  tline run town.toml --map surge.png --profile main.png --path lake,b,tower
"""


@click.command("run", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--tol", metavar="NUMBER", help="Largest error, relative to a probe's amplitude; 1e-6 if not given.")
@click.option("--order", metavar="1…16", help="Order of the method, instead of the scene's.")
@click.option("--slab", metavar="TIME", help="Width of a time slab, such as '1 us', instead of the scene's.")
@click.option("--at", metavar="FROM:TO:COUNT", help="Instants of table, arrays, plot and --json, as '0:1 us:1001'.")
@click.option("--csv", metavar="FILE.csv", help="Table of what the probes saw, SI, full precision.")
@click.option("--npz", metavar="FILE.npz", help="The same as NumPy arrays, with the scene.")
@click.option("--envelope", metavar="FILE.csv", help="Table of the extremes at every node, and when.")
@click.option("--ledger-csv", metavar="FILE.csv", help="The energy ledger as a table, in full precision.")
@click.option("--plot", metavar="FILE", help="Probes over time; .png, .svg or .pdf.")
@click.option("--profile", metavar="FILE", help="Lowest and highest effort along a path, with ground and limits.")
@click.option("--map", metavar="FILE", help="Map of the network, coloured by how far the effort rose and fell.")
@click.option("--space-time", metavar="FILE", help="Image of the effort over place and time.")
@click.option("--lattice", metavar="FILE", help="Bounce diagram, for a scene with one line.")
@click.option("--load-lines", metavar="FILE", help="Bergeron's diagram, for one line between resistive ends.")
@click.option("--animate", metavar="FILE", help="The effort along a path, moving; .html or .gif.")
@click.option(
    "--path",
    metavar="FROM,…,TO",
    help="Path of --profile, --space-time, --animate: ends, any it passes.",
)
@click.option(
    "--ledger/--no-ledger",
    default=None,
    help="Show energy by element: supplied, dissipated, stored, and what is off; or do not keep it.",
)
@click.option("--active", is_flag=True, help="Run even if a load is active, that is, not positive real.")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def run(
    scene: str,
    tol: str | None,
    order: str | None,
    slab: str | None,
    at: str | None,
    path: str | None,
    active: bool,
    ledger: bool | None,
    confined: bool,
    as_json: bool,
    **files: str | None,
) -> None:
    """Simulate a scene and print what its probes saw.

    SCENE is a TOML file with lines, sources, loads and probes; `tline schema` describes it. A scene with a load that is
    not positive real runs only with --active; without it you are told whether its waves grow, and how fast.

    Order and slab are refined until the estimated error of every probe meets the tolerance; where it is not met, you
    are told what was reached, and the exit status is 1. With an order or a slab and no tolerance there is one run.
    """
    wanted = {kind: file for kind, file in files.items() if file is not None}
    if ledger is False and "ledger_csv" in wanted:
        raise InputError("--ledger-csv", "there is no ledger to write", "no --no-ledger beside it")
    shown = ledger or "ledger_csv" in wanted
    ledger = shown or ledger
    solver = {key: value for key, value in (("tol", tol), ("order", order), ("slab", slab)) if value is not None}
    with options_named({f"solver.{key}": f"--{key}" for key in solver} | {"path": "--path", "lattice": "--lattice"}):
        _check_files(wanted)
        read = _read(scene, solver, confined)
        times = _instants(at, read)
        way = _route(read, path, wanted)
        result = _simulate(read, _recorded(read, way, wanted), active, ledger, wanted)
        for kind, file in wanted.items():
            _write(result, way, kind, file, times)
    from tline.cli.energies import ledger_as_table
    from tline.cli.report import as_table, judgement, summary

    accuracy = judgement(result)
    for note in (*result.notes, *_advice(result, accuracy)):
        click.echo(f"note: {note}", err=True)
    if as_json:
        click.echo(
            json.dumps(
                summary(result, accuracy, times) | {"files": list(wanted.values())}, indent=2, ensure_ascii=False
            )
        )
    else:
        click.echo(as_table(result, accuracy))
        if shown and result.ledger is not None:
            click.echo(f"\n{ledger_as_table(result.ledger)}")
        for file in wanted.values():
            click.echo(f"wrote {file}")
    if accuracy and not accuracy.met:
        sys.exit(1)


def _advice(result: "Result", accuracy: "Accuracy | None") -> "Iterator[str]":
    """What to do where a run of cavities along pipes is no number to design for."""
    from tline.scene.cavities import with_cavities

    if accuracy and accuracy.at_slab_ends > UNCERTAIN and with_cavities(result.scene.lines):
        yield (
            "spikes between cavities that collapse do not converge: for a pressure to design for, "
            "`tline design separation` takes the highest over several numbers of places"
        )


def _check_files(wanted: dict[str, str]) -> None:
    """Refuse what could not be written, before time is spent on it."""
    if not wanted:
        return
    from tline.solver.result.atomic import check_writable

    seen: dict[Path, str] = {}
    for kind, file in wanted.items():
        option, suffix = "--" + kind.replace("_", "-"), Path(file).suffix
        if suffix.lower() not in SUFFIXES[kind]:
            raise InputError(option, "unknown kind of file", " or ".join(SUFFIXES[kind]), f"'{file}'")
        other = seen.setdefault(Path(file).resolve(), option)
        if other != option:
            raise InputError(option, f"would overwrite what {other} writes", "another file", f"'{file}'")
        check_writable(file)


def _read(scene: str, given: dict[str, str], confined: bool) -> "Scene":
    from tline.scene.file import read_scene

    read = read_scene(scene, progress=sys.stderr.isatty(), confined=confined)
    return read.with_changes(solver=read.table().get("solver", {}) | given) if given else read


def _instants(at: str | None, scene: "Scene") -> "NDArray | None":
    if at is None:
        return None
    from tline.cli.instants import instants
    from tline.units import engineering

    times, end = instants(at, "--at"), float(scene.t_end)
    if times[-1] > end * (1 + 1e-12):
        raise InputError("--at", "ends after the run", f"at most {engineering(end, 's')}", f"'{at}'")
    return times


def _route(scene: "Scene", path: str | None, wanted: dict[str, str]) -> "Route | None":
    """The path that pictures show, None if none does."""
    if "lattice" in wanted:
        from tline.pictures.fronts import only_line

        only_line(scene)
    if "load_lines" in wanted:
        from tline.signal.load_line import bergeron

        bergeron(scene)
    if not any(kind in wanted for kind in ALONG):
        if path is not None:
            raise InputError("path", "nothing shows it", "--profile, --space-time or --animate beside it")
        return None
    from tline.pictures.path import route

    if path is None:
        return route(scene)
    nodes = [node.strip() for node in path.split(",")]
    if len(nodes) < 2:
        raise InputError("path", "not two nodes or more", "FROM,TO or FROM,…,TO", f"'{path}'")
    return route(scene, *nodes)


def _recorded(scene: "Scene", way: "Route | None", wanted: dict[str, str]) -> list[str]:
    """Lines whose inside pictures show."""
    found = list(way.lines) if way else []
    if "map" in wanted:
        from tline.pictures.surge import lines_to_map

        found += lines_to_map(scene)
    return found


def _simulate(scene: "Scene", record: list[str], active: bool, ledger: bool | None, wanted: dict[str, str]) -> "Result":
    from tline.solver.simulate import UnresolvedWarning, simulate

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)  # said as notes
        return simulate(
            scene,
            record=record,
            envelope=any(kind in wanted for kind in ENVELOPES),
            ledger=ledger,
            active=active,
            progress=sys.stderr.isatty(),
        )


def _write(result: "Result", way: "Route | None", kind: str, file: str, times: "NDArray | None") -> None:
    if kind in ("csv", "npz"):
        from tline.solver.result.save import save_csv, save_npz

        (save_csv if kind == "csv" else save_npz)(result, file, times)
    elif kind in ("envelope", "ledger_csv"):
        from tline.solver.result.save import save_envelope, save_ledger

        (save_envelope if kind == "envelope" else save_ledger)(result, file)
    elif kind == "animate" and way:
        from tline.pictures.animation import animated

        animated(result, way).save(file)
    else:
        from tline.pictures.style import save_figure

        save_figure(_picture(result, way, kind, times), file)


def _picture(result: "Result", way: "Route | None", kind: str, times: "NDArray | None") -> "Figure":
    if kind == "map":
        from tline.pictures.map import plot_map

        return plot_map(result)
    if kind == "profile" and way:
        from tline.pictures.profile import plot_profile

        return plot_profile(result, way)
    if kind == "space_time" and way:
        from tline.pictures.space_time import plot_space_time

        return plot_space_time(result, way)
    if kind == "lattice":
        from tline.pictures.lattice import plot_lattice

        return plot_lattice(result)
    if kind == "load_lines":
        from tline.pictures.load_lines import plot_load_lines
        from tline.scene.heights import words
        from tline.signal.load_line import bergeron

        return plot_load_lines(bergeron(result.scene), words(result.scene), result.scene.title)
    from tline.pictures.traces import plot

    return plot(result, t=times)
