"""`tline sweep`: a scene in many runs, with values of a grid or drawn from distributions."""

import json
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from tline.cli.options import PICTURE, check_files, confined_option, options_named
from tline.errors import InputError, import_extra

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from tline.sweeps import Sweep

OPTIONS = ("sample", "seed", "keep", "tol", "workers", "resume")
INTERRUPTED = 130  # exit status, as of any command
EXAMPLES = """\b
Examples:
  tline sweep cable.toml --vary "lines.cable.z0=40 ohm:60 ohm:5"
  tline sweep cable.toml --vary "lines.cable.z0=normal(50 ohm, 2 ohm)" \\
      --vary "loads.end.capacitance=uniform(3.5 pF, 4.5 pF)" \\
      --sample random:10000 --seed 7 --csv runs.csv --plot runs.png
  tline sweep cable.toml --vary "loads.end.resistance=50, 75, 100" \\
      --keep "0 ns:20 ns:101" --resume runs.npz --workers 2
"""


@click.command("sweep", epilog=EXAMPLES)
@click.argument("scene")
@click.option("--vary", metavar="PATH=VALUES", multiple=True, help="What varies, and how; may be repeated.")
@click.option("--sample", metavar="KIND[:COUNT]", help="grid, list, random:COUNT, latin:COUNT or sobol:COUNT.")
@click.option("--seed", metavar="NUMBER", default="0", show_default=True, help="Another one draws other numbers.")
@click.option("--keep", metavar="WHAT", multiple=True, help="extremes (if not given), or instants; may be repeated.")
@click.option("--tol", metavar="NUMBER", help="Largest error, relative to a run's amplitude; the scene's, or 1e-6.")
@click.option("--workers", metavar="NUMBER", help="Processes; as many as processors for long work if not given.")
@click.option(
    "--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster that makes the runs, such as tcp://host:8786."
)
@click.option("--resume", metavar="FILE.npz", help="Go on from this file, and write it meanwhile.")
@click.option("--npz", metavar="FILE.npz", help="All inputs and what was kept as NumPy arrays, with the scene.")
@click.option("--netcdf", metavar="FILE.nc", help="The same for xarray and others.")
@click.option("--csv", metavar="FILE.csv", help="A row for each run, SI, full precision.")
@click.option("--plot", metavar="FILE", help="Extremes over values, or histograms; .png, .svg or .pdf.")
@click.option("--active", is_flag=True, help="Make runs with loads that are active, that is, not positive real.")
@confined_option
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def sweep(
    scene: str,
    vary: tuple[str, ...],
    keep: tuple[str, ...],
    dask: str | None,
    active: bool,
    confined: bool,
    as_json: bool,
    **given: Any,
) -> None:
    """Run a scene with many values, and print the extremes at its probes.

    PATH is dotted, as in a scene file: lines.cable.z0, sources.pump.value.duration, t_end. VALUES are values with
    commas between; FROM:TO:COUNT, both ends included, or FROM:TO:COUNT:log; or a distribution: uniform(LOW, HIGH),
    loguniform(LOW, HIGH), normal(MEAN, DEVIATION). All with units; plain numbers are SI.

    Without distributions every value of a path meets every one of the others (a grid); with --sample list, values stand
    side by side. Distributions need a count: --sample random:1000, latin:100 (hypercube) or sobol:128.

    A run that fails is a row with a sentence. Where runs failed or missed the tolerance, a note says so, and the exit
    status is 1. After Ctrl-C there is what was done until then, with a note, and the exit status is 130.
    """
    files = {name: given.pop(name) for name in ("npz", "netcdf", "csv", "plot")}
    suffixes = ((".npz",), (".nc",), (".csv",), PICTURE)
    check_files({f"--{name}": (file, kind) for (name, file), kind in zip(files.items(), suffixes, strict=True)})
    wanted, written = _wanted(vary), [file for file in files.values() if file]
    from tline import sweeps
    from tline.cli.sweep_report import as_text, notes, summary
    from tline.scene.file import read_scene
    from tline.solver.simulate import UnresolvedWarning

    read = read_scene(scene, confined=confined)
    with _executor(dask) as executor, options_named({name: f"--{name}" for name in OPTIONS}):
        with warnings.catch_warnings():
            for said in (sweeps.InterruptedWarning, UnresolvedWarning):  # notes tell
                warnings.simplefilter("ignore", said)
            found = sweeps.sweep(
                read,
                wanted,
                keep=list(keep) or "extremes",
                executor=executor,
                active=active,
                progress=sys.stderr.isatty(),
                **given,
            )
        _write(found, files)
    told = notes(found)
    for note in (*told, *filter(None, [found.told_unresolved])):
        click.echo(f"note: {note}", err=True)
    if as_json:
        click.echo(json.dumps(summary(found) | {"files": written}, indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join([*as_text(found), *(f"wrote {file}" for file in written)]))
    if told:
        sys.exit(1 if found.done.all() else INTERRUPTED)


def _wanted(vary: tuple[str, ...]) -> dict[str, str]:
    """Values by path."""
    wanted = {}
    for each in vary:
        where, equals, text = each.rpartition("=")
        if not equals:
            raise InputError("--vary", "no values", "PATH=VALUES", f"'{each:.60}'")
        if where.strip() in wanted:
            raise InputError("--vary", f"{where.strip()} varies twice", "each path once")
        wanted[where.strip()] = text
    if not wanted:
        raise InputError("--vary", "nothing varies", 'such as --vary "lines.NAME.z0=40 ohm:60 ohm:5"')
    return wanted


@contextmanager
def _executor(dask: str | None) -> "Iterator[Executor | None]":
    """The executor of a Dask cluster, if one is named."""
    if dask is None:
        yield None
        return
    distributed = import_extra("distributed", "Dask's scheduler", "dask", "--dask")
    try:
        client = distributed.Client(dask, timeout="10 s")
    except (OSError, ValueError) as error:
        raise InputError("--dask", "no scheduler answers", "such as tcp://host:8786", f"'{dask}' ({error})") from None
    with client:
        yield client.get_executor()


def _write(found: "Sweep", files: dict[str, str | None]) -> None:
    for name in ("npz", "netcdf", "csv"):
        if file := files[name]:
            found.save(file)
    if plot := files["plot"]:
        from tline.pictures.style import save_figure
        from tline.pictures.sweep import plot_sweep

        save_figure(plot_sweep(found), plot)
