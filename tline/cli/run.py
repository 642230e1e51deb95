"""Command `tline run`: simulate a scene, print the values at its probes, and write files and pictures."""

import sys
import warnings
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import FileKind, Output, command, drawn, picture, table
from tline.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tline.pictures.path import Route
    from tline.scene.scene import Scene
    from tline.solver.result.accuracy import Accuracy
    from tline.solver.result.result import Result


FILES = {
    "csv": table("Table of what the probes saw, SI, full precision"),
    "npz": FileKind((".npz",), "The same as NumPy arrays, with the scene"),
    "envelope": table("Table of the extremes at every node, and when"),
    "states": table("What pumps, vessels, tanks, cavities and valves do over time"),
    "ledger_csv": table("The energy ledger as a table, in full precision"),
    "plot": picture("Probes over time"),
    "profile": picture("Lowest and highest effort along a path, with ground and limits"),
    "map": picture("Map of the network, coloured by how far the effort rose and fell"),
    "space_time": picture("Image of the effort over place and time"),
    "plot_waves": picture("Waves along a path and against it, over place and time"),
    "lattice": picture("Bounce diagram, for a scene with one line"),
    "load_lines": picture("Bergeron's diagram, for one line between resistive ends"),
    "animate": FileKind((".html", ".gif", ".mp4"), "Waves and effort along a path, moving"),
}
ALONG = ("profile", "space_time", "plot_waves", "animate")  # show a path
ENVELOPES = ("envelope", "map")  # show the extremes at nodes


def recorded(scene: "Scene", way: "Route | None", mapped: bool) -> tuple[str, ...]:
    """Lines whose interior appears in pictures."""
    if not mapped:
        return way.lines if way else ()
    from tline.pictures.map import lines_to_map

    return (*(way.lines if way else ()), *lines_to_map(scene))


def writers(
    result: "Result", way: "Route | None" = None, times: "NDArray | None" = None
) -> dict[str, Callable[[str], Any]]:
    """Writers for each kind of file, with tables at some instants, s, or else at slab ends."""
    from tline.solver.result import export

    return {
        "csv": lambda file: export.save_csv(result, file, times),
        "npz": lambda file: export.save_npz(result, file, times),
        "envelope": lambda file: export.save_envelope(result, file),
        "states": lambda file: export.save_states(result, file),
        "ledger_csv": lambda file: export.save_ledger(result, file),
        "plot": drawn("tline.pictures.traces:plot", result, t=times),
        "profile": drawn("tline.pictures.profile:plot_profile", result, way),
        "map": drawn("tline.pictures.map:plot_map", result),
        "space_time": drawn("tline.pictures.profile:plot_space_time", result, way),
        "plot_waves": drawn("tline.pictures.profile:plot_path_waves", result, way),
        "lattice": drawn("tline.pictures.lattice:plot_lattice", result),
        "load_lines": lambda file: _draw_load_lines(result.scene, file),
        "animate": lambda file: _animate(result, way, file),
    }


def _draw_load_lines(scene: "Scene", file: str) -> None:
    from tline.signal.load_line import bergeron

    found = bergeron(scene)
    drawn(found.picture, found)(file)


def _animate(result: "Result", way: "Route | None", file: str) -> None:
    from tline.pictures.animation import animated

    assert way is not None
    animated(result, way).save(file)


EXPECTED = "FROM:TO:COUNT, such as '0:1 us:1001'"
MOST_INSTANTS = 10_000_000
UNCERTAIN = 0.05  # of an amplitude
EXAMPLES = """\b
Examples:
  tline run valve.toml --tol 1e-8 --plot valve.png
  tline run network.toml --order 8 --slab "10 us" --csv probes.csv \\
      --path tank,valve --animate surge.html
  tline run valve.toml --csv out.csv --at "0:2 s:2001"
  tline run valve.toml --animate waves.html --plot-waves waves.png
  tline run valve.toml --ledger
  tline run town.toml --map surge.png --profile main.png --path lake,b,tower
"""


@command(files=FILES, epilog=EXAMPLES)
def run(
    scene: str,
    *,
    tol: str | None = None,
    order: str | None = None,
    slab: str | None = None,
    at: str | None = None,
    path: str | None = None,
    units: str | None = None,
    ledger: bool | None = None,
    active: bool = False,
    seconds: str | None = None,
    confined: bool = False,
    files: dict[str, str],
) -> Output:
    """Simulate a scene and print the values at its probes.

    SCENE is a TOML file with lines, sources, loads and probes (`tline schema` describes it), or a SPICE netlist or a
    network of EPANET, as `tline import` reads them. A scene with a load that is not positive real runs only with
    --active; without it the growth of its waves is reported, if any.

    Order and slab are refined until the estimated error of every probe meets the tolerance; if it is not met, the error
    reached is printed, and the exit status is 1. With an order or a slab and no tolerance there is one run.

    Parameters
    ----------
    tol : NUMBER
        Largest error, relative to a probe's amplitude; the scene's, or 1e-6, if not given.
    order : 1…16
        Order of the method, instead of the scene's.
    slab : TIME
        Width of a time slab, such as '1 us', instead of the scene's.
    at : FROM:TO:COUNT
        Instants of table, arrays, plot and --json, as '0:1 us:1001'.
    path : FROM,…,TO
        Path of --profile, --space-time, --plot-waves, --animate: ends, any passed.
    units
        Units of results: 'SI', 'US', or units such as 'US, MGD'; the scene's if not given.
    ledger
        Show energy by element: supplied, dissipated, stored, and the residual; or do not keep it.
    seconds : TIME
        Time for all runs; the best result by then is printed, with its error estimate.
    """
    if ledger is False and "ledger_csv" in files:
        raise InputError("--ledger-csv", "there is no ledger to write", "no --no-ledger beside it")
    shown = ledger or "ledger_csv" in files
    solver = {key: value for key, value in (("tol", tol), ("order", order), ("slab", slab)) if value is not None}
    with run.named(units="--units", **{f"solver.{key}": f"--{key}" for key in solver}):
        read = _read(scene, {"solver": solver, "units": units}, confined)
        times = _instants(at, read)
        way = _route(read, path, files)
        result = _simulate(read, way, files, active=active, ledger=shown or ledger, seconds=seconds)
    from tline.cli.report import judgement, summary

    accuracy = judgement(result)
    return Output(
        _text(result, accuracy, bool(shown)),
        lambda: summary(result, accuracy, times) | {"files": list(files.values())},
        writers(result, way, times),
        [*result.notes, *_advice(result, accuracy)],
        1 if accuracy and not accuracy.met else 0,
    )


def _text(result: "Result", accuracy: "Accuracy | None", with_ledger: bool) -> Iterator[str]:
    from tline.cli.report import as_table, ledger_as_table

    yield as_table(result, accuracy)
    if with_ledger and result.ledger is not None:
        yield f"\n{ledger_as_table(result.ledger)}"


def _advice(result: "Result", accuracy: "Accuracy | None") -> Iterator[str]:
    """Advise on cavities along pipes where a run gives no pressure to design for."""
    from tline.scene.cavities import with_cavities

    if accuracy and accuracy.at_slab_ends > UNCERTAIN and with_cavities(result.scene.lines):
        yield (
            "spikes between cavities that collapse do not converge: for a pressure to design for, "
            "`tline design separation` takes the highest over several numbers of places"
        )


def _read(scene: str, given: dict[str, Any], confined: bool) -> "Scene":
    from tline.interchange.any_file import read as read_any

    read = read_any(scene, progress=sys.stderr.isatty(), confined=confined)
    given = {key: value for key, value in given.items() if value}
    if "solver" in given:
        given["solver"] = read.table().get("solver", {}) | given["solver"]
    return read.with_changes(**given) if given else read


def _instants(at: str | None, scene: "Scene") -> "NDArray | None":
    if at is None:
        return None
    from tline.units import engineering

    times, end = instants(at, "--at"), float(scene.t_end)
    if times[-1] > end * (1 + 1e-12):
        raise InputError("--at", "ends after the run", f"at most {engineering(end, 's')}", f"'{at}'")
    return times


def instants(text: str, where: str) -> "NDArray":
    """Parse instants, s, apart by equal times, first and last included.

    Examples
    --------
    >>> instants("0:1 us:3", "--at").tolist()
    [0.0, 5e-07, 1e-06]
    """
    import numpy as np

    from tline.units import to_si

    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 3:
        raise InputError(where, "not two instants and a count", EXPECTED, f"'{text}'")
    first, last = (to_si(part, "s", where) for part in parts[:2])
    count = int(parts[2]) if parts[2].isdecimal() and len(parts[2]) <= len(str(MOST_INSTANTS)) else 0
    if not 2 <= count <= MOST_INSTANTS:
        raise InputError(where, "not a count", f"2 to {MOST_INSTANTS:,} instants", f"'{parts[2]}'")
    if not 0 <= first < last:
        raise InputError(where, "does not run from an instant to a later one", EXPECTED, f"'{text}'")
    return np.linspace(first, last, count)


def _route(scene: "Scene", path: str | None, wanted: dict[str, str]) -> "Route | None":
    """Find the path for pictures, None if none needs it."""
    if "lattice" in wanted:
        from tline.pictures.lattice import only_line

        only_line(scene)
    if "load_lines" in wanted:
        from tline.signal.load_line import bergeron

        bergeron(scene)
    if not any(kind in wanted for kind in ALONG):
        if path is not None:
            raise InputError("path", "nothing shows it", "--profile, --space-time, --plot-waves or --animate beside it")
        return None
    from tline.pictures.path import route

    nodes = [node.strip() for node in path.split(",")] if path is not None else []
    if len(nodes) == 1:
        raise InputError("path", "not two nodes or more", "FROM,TO or FROM,…,TO", f"'{path}'")
    return route(scene, *nodes)


def _simulate(
    scene: "Scene",
    way: "Route | None",
    wanted: dict[str, str],
    *,
    active: bool,
    ledger: bool | None,
    seconds: str | None,
) -> "Result":
    from tline.solver.simulate import UnresolvedWarning, simulate

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)  # said as notes
        return simulate(
            scene,
            record=recorded(scene, way, "map" in wanted),
            envelope=any(kind in wanted for kind in ENVELOPES),
            ledger=ledger,
            active=active,
            progress=sys.stderr.isatty(),
            seconds=seconds,
        )
