"""Commands `tline surge` and `study`: operate a network without editing a file."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import FileKind, Output, command, picture
from tline.cli.options import hours, options_named, write_text
from tline.cli.run import FILES, recorded, writers
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.scene.scene import Scene


OPERATE = "tline.surge.operation:operate"
OPERATIONS = ("trip", "start", "stop", "speed", "close", "open", "burst", "demand")
READING = ("wave_speed", "material", "hour", "moving_tanks")
OPERATING = (*OPERATIONS, "when", "inertia", "rated_speed", *READING)
KNOWN = {"wave_speed": "wave speed", "material": "wave speed", "inertia": "inertia"}  # options, by assumption replaced
NAMES = {"t_end": "for", "hour": "at_hour"}  # of options
STUDY = {
    "report": FileKind((".html", ".pdf"), "All in one: tables, maps, profiles"),
    "csv": FileKind((".csv",), "A row for each scenario"),
}


def operated_network(network: "Scene | str", **given: Any) -> "tuple[Scene, tuple[str, ...]]":
    """Build the operated scene of a network, and notes on parts left out or assumed.

    Parameters
    ----------
    network : Scene or str
        Network, or the path of its file.
    **given
        Arguments of `tline.surge.operation.operate`.
    """
    from tline.scene.text_file import check_readable
    from tline.surge.event import to_open
    from tline.surge.operate import read_network
    from tline.surge.operation import plan

    if isinstance(network, str) and Path(network).suffix:
        check_readable(network)
    operations = {kind: given.pop(kind) for kind in OPERATIONS if kind in given}
    reading = {key: given.pop(key) for key in READING if key in given}
    reading |= {"hour": hours(reading["hour"])} if "hour" in reading else {}
    scene, read, controls = read_network(network, **reading, opened=to_open(operations.get("open", ())))
    with options_named({"solver.order": "--order", "solver.tol": "--tol"}):
        scene, guesses = plan(scene, operations, controls=controls, progress=sys.stderr.isatty(), **given)
    return scene, (*read, *guesses)


EXAMPLES = """\b
Examples:
  tline surge town.inp --trip duty@1s --for 30s
  tline surge town.inp --close ease@1s+5s --burst "b:20 L/s@2s" --demand "c:-5 L/s@0s" \\
      --at-hour 8 --save surge.toml --map surge.png
"""
WRITTEN = {
    "save": FileKind((".toml",), "Write the scene that `tline run` runs just so"),
    "map": FILES["map"],
    "profile": FILES["profile"],
    "heads": picture("Pressure and head over time"),
    "envelope": FILES["envelope"],
    "tables": FileKind(
        (".csv", ".xlsx", ".geojson"), "Nodes, pipes and states with extremes and coordinates (three CSV files)"
    ),
    "states": FILES["states"],
}


@command(OPERATE, names=NAMES, files=WRITTEN, omit=("record",), epilog=EXAMPLES)
def surge(
    network: str,
    *,
    t_end: str = "60 s",
    at: str | None = None,
    path: str | None = None,
    cavities: bool = True,
    until_settled: bool = False,
    band: bool = False,
    seconds: str = "20 s",
    files: dict[str, str],
    **given: Any,
) -> Output:
    """Operate a network, and print its extremes.

    NETWORK is a file of EPANET (.inp) or a scene (.toml, or the name of one that comes with tline) of pipes that starts
    in the steady state. Times and durations have units, and an operation without a duration is done at once. Pipes are
    full: they drain until air valves have let a tenth of their volume in, and an empty one cannot be filled. The exit
    status is 1 if the tolerance is not met, or no pressure class can be determined: columns separate, pipes drain, or
    the highest pressure comes at the end of the run.

    Parameters
    ----------
    t_end : TIME
        How long to run.
    at : NODE,…
        Nodes that --heads shows, instead of those operated.
    path : FROM,…,TO
        Path of --profile.
    band
        Vary the values assumed, one by one (wave speed, friction, travel of valves, inertia), and print the range.
    seconds : TIME
        Computing time for all runs, and again for those of --band: then the best so far is printed, with its error.
    until_settled
        Run longer, up to an hour, until neither extreme comes at the end of the run.
    cavities
        Follow columns that separate, with cavities where water boils, or (--no-cavities) name no class there.
    """
    from tline.cli.report import judgement
    from tline.pictures.path import route
    from tline.scene.file import scene_text
    from tline.solver.simulate import as_seconds
    from tline.solver.tolerance.ladder import Budget
    from tline.surge.operation import carried_out
    from tline.surge.report import as_text, band_text

    if path is not None and "profile" not in files:
        raise InputError("--path", "nothing shows it", "--profile beside it")
    places = [place.strip() for place in at.split(",")] if at else ()
    budget = Budget(as_seconds(seconds))
    scene, guesses = operated_network(network, t_end=t_end, at=places, budget=budget, **given)
    if "save" in files:
        write_text(scene_text(scene), files["save"])
    nodes = [node.strip() for node in path.split(",")] if path else []
    way = route(scene, *nodes) if "profile" in files else None
    inner = scene.lines if "tables" in files else recorded(scene, way, "map" in files)
    more = {"cavities": cavities, "until_settled": until_settled, "progress": sys.stderr.isatty()}
    found = carried_out(scene, guesses, inner, budget, **more)
    result, columns, highest = found.result, found.columns, found.worst
    if "save" in files and columns:
        write_text(scene_text(result.scene), files["save"])
    accuracy = result.accuracy if columns else judgement(result)
    missed = accuracy and accuracy.tol and accuracy.at_slab_ends > accuracy.tol
    known = [word for key, word in KNOWN.items() if given.get(key)]
    left = found.band(known, sys.stderr.isatty(), seconds) if band else None
    wrote = writers(result, way)
    return Output(
        [as_text(result, accuracy, highest, columns), *(band_text(result, left) if left else ())],
        lambda: found.to_dict() | ({"band": left.to_dict()} if left else {}),
        wrote | {"heads": wrote["plot"], "save": lambda _: None, "tables": found.save_tables},
        found.notes,
        1 if highest.untold or missed else 0,
    )


@command(
    "tline.surge.study:surge_study",
    files=STUDY,
    omit=("executor",),
    epilog="""\b
Example:
  tline study scenes/town_study.toml --folder out/town --report out/town.html
""",
)
def study(study: str, *, files: dict[str, str], **given: Any) -> Output:
    """Operate a water network in many ways, in variants of it, and compare the results.

    STUDY is a TOML file with the network, its operations (in turn for each pump, valve, pipe or node, if wanted) and
    variants, such as protections. The exit status is 1 if a scenario has no pressure class.
    """
    from tline.surge.study import surge_study

    found = surge_study(study, progress=sys.stderr.isatty(), **given)
    return Output(
        str(found).splitlines(), found.to_dict, dict.fromkeys(STUDY, found.save), (), 1 if found.unsigned else 0
    )
