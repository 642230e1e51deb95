"""Command `tline sweep`: a scene in many runs, with values of a grid or drawn from distributions."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import FileKind, Output, command, drawn, picture, table
from tline.errors import InputError, import_extra

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from tline.scene.scene import Scene

FILES = {
    "npz": FileKind((".npz",), "All inputs and what was kept as NumPy arrays, with the scene"),
    "netcdf": FileKind((".nc",), "The same for xarray and others"),
    "csv": table("A row for each run, SI, full precision"),
    "plot": picture("Extremes over values, or histograms"),
}
INTERRUPTED = 130  # exit status, as of any interrupted command
EXAMPLES = """\b
Examples:
  tline sweep cable.toml --vary "lines.cable.z0=40 ohm:60 ohm:5"
  tline sweep cable.toml --vary "lines.cable.z0=normal(50 ohm, 2 ohm)" \\
      --vary "loads.end.capacitance=uniform(3.5 pF, 4.5 pF)" \\
      --sample random:10000 --seed 7 --csv runs.csv --plot runs.png
  tline sweep cable.toml --vary "loads.end.resistance=50, 75, 100" \\
      --keep "0 ns:20 ns:101" --resume runs.npz --workers 2
"""


@command("tline.sweeps.runs:sweep", files=FILES, omit=("executor",), epilog=EXAMPLES)
def sweep(
    scene: "Scene",
    *,
    vary: tuple[str, ...] = (),
    keep: tuple[str, ...] = (),
    dask: str | None = None,
    files: dict[str, str],
    **given: Any,
) -> Output:
    """Run a scene with many values, and print the extremes at its probes.

    PATH is dotted, as in a scene file: lines.cable.z0, sources.pump.value.duration, t_end. VALUES are values with
    commas between; FROM:TO:COUNT, both ends included, or FROM:TO:COUNT:log; or a distribution: uniform(LOW, HIGH),
    loguniform(LOW, HIGH), normal(MEAN, DEVIATION). All with units; plain numbers are SI.

    Without distributions every value of a path meets every one of the others (a grid); with --sample list, values are
    side by side. Distributions need a count: --sample random:1000, latin:100 (hypercube) or sobol:128.

    A run that fails is a row with a sentence. Where runs failed or missed the tolerance, a note is printed and the exit
    status is 1. After Ctrl-C the runs done until then are shown, with a note, and the exit status is 130.

    Parameters
    ----------
    vary : PATH=VALUES
        Path that varies, with its values; may be repeated.
    keep : WHAT
        extremes (if not given), or instants; may be repeated.
    dask : ADDRESS
        Scheduler of a Dask cluster that makes the runs, such as tcp://host:8786.
    """
    wanted = _wanted(vary)
    from tline import sweeps
    from tline.solver.simulate import UnresolvedWarning
    from tline.sweeps.table import as_text, notes, summary

    with _executor(dask) as executor, warnings.catch_warnings():
        for said in (sweeps.InterruptedWarning, UnresolvedWarning):  # notes report these
            warnings.simplefilter("ignore", said)
        kept = list(keep) or "extremes"
        found = sweeps.sweep(scene, wanted, keep=kept, executor=executor, progress=sys.stderr.isatty(), **given)
    told = notes(found)
    return Output(
        as_text(found),
        lambda: summary(found) | {"files": list(files.values())},
        dict.fromkeys(("npz", "netcdf", "csv"), found.save) | {"plot": drawn(found.picture, found)},
        [*told, *filter(None, [found.told_unresolved])],
        0 if not told else 1 if found.done.all() else INTERRUPTED,
    )


def _wanted(vary: tuple[str, ...]) -> dict[str, str]:
    """Parse the values by path."""
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
    """Executor of a Dask cluster, if one is named."""
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
