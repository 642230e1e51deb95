"""`tline surge`: operate a network without editing a file, and see what is worst."""

import json
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tline.cli.options import PICTURE, check_files, check_readable, hours, options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.pictures.path import Route
    from tline.scene.scene import Scene
    from tline.solver.result.accuracy import Accuracy
    from tline.solver.result.result import Result
    from tline.surge.event import Event

EXAMPLES = """\b
Examples:
  tline surge town.inp --trip duty@1s --for 30s
  tline surge town.inp --close ease@1s+5s --burst "b:20 L/s@2s" --demand "c:-5 L/s@0s" \\
      --at-hour 8 --save surge.toml --map surge.png
"""
OPERATIONS = ("trip", "stop", "close", "open", "burst", "demand")
SUFFIXES = {"save": (".toml",), "map": PICTURE, "profile": PICTURE, "heads": PICTURE, "envelope": (".csv",)}
SHOWN, USUAL_TOL = 5, "1e-2"  # nodes in tables; of a scene that states none


@click.command("surge", epilog=EXAMPLES)
@click.argument("network")
@click.option("--trip", multiple=True, metavar="PUMP@TIME", help="A pump's motor fails, and it runs down.")
@click.option("--stop", multiple=True, metavar="PUMP@TIME+DURATION", help="A pump's speed falls to nothing, linearly.")
@click.option(
    "--close",
    multiple=True,
    metavar="LINK@TIME+DURATION",
    help="Shut a valve, or one put into a pipe; :20%+8s behind it is a second stage from there, :FILE.csv a course.",
)
@click.option("--open", multiple=True, metavar="LINK@TIME+DURATION", help="Open a valve.")
@click.option("--burst", multiple=True, metavar="NODE:FLOW@TIME", help="A hole, and its flow at the pressure before.")
@click.option("--demand", multiple=True, metavar="NODE:±FLOW@TIME", help="Draw more, or less, at a node.")
@click.option(
    "--when", multiple=True, metavar='"NODE>PRESSURE:close LINK+DURATION"', help="Operate once a pressure is reached."
)
@click.option("--for", "t_end", default="60s", metavar="TIME", help="How long to run; 60 s if not given.")
@click.option("--tol", metavar="NUMBER", help="Largest error at the nodes that are told, relative to their amplitude.")
@click.option("--order", metavar="1…16", help="One run of this order, in the slabs that suit it.")
@click.option("--inertia", metavar="J", help="Of pumps that trip, such as '2 kg m^2'; a usual one if not given.")
@click.option("--rated-speed", metavar="N", help="Of pumps that trip, such as '1450 rpm'.")
@click.option("--rating", metavar="PRESSURE", help="What the pipes bear, such as '16 bar'.")
@click.option("--wave-speed", metavar="SPEED", help="In the pipes of an .inp file; 1000 m/s if nothing is said.")
@click.option("--material", metavar="FILE.csv", help="Rows pipe, wall, thickness or pipe, wave speed; * is all others.")
@click.option("--at-hour", metavar="HOURS", help="Begin so long after an .inp file's start.")
@click.option("--moving-tanks", is_flag=True, help="Tanks of an .inp file fill and empty, instead of holding levels.")
@click.option("--at", "places", metavar="NODE,…", help="Nodes that --heads shows, instead of those operated.")
@click.option("--path", metavar="FROM,…,TO", help="Path of --profile.")
@click.option("--save", metavar="SCENE.toml", help="Write the scene that `tline run` runs just so.")
@click.option("--map", metavar="FILE", help="Map of the network, coloured by how far the head rose and fell.")
@click.option("--profile", metavar="FILE", help="Lowest and highest head along a path.")
@click.option("--heads", metavar="FILE", help="Pressure and head over time.")
@click.option("--envelope", metavar="FILE.csv", help="Table of the extremes at every node, and when.")
@click.option("--json", "as_json", is_flag=True, help="Print the numbers in SI and full precision.")
def surge(network: str, t_end: str, as_json: bool, path: str | None, places: str | None, **given: Any) -> None:
    """Operate a network, and print the worst of it.

    NETWORK is a file of EPANET (.inp) or a scene (.toml) of pipes that starts in the steady state. Times and durations
    have units, and an operation without a duration is done at once.
    """
    from tline.cli.report import judgement
    from tline.surge.control import read_control, triggered
    from tline.surge.event import read_event

    files = {key: given[key] for key in SUFFIXES}
    check_files({f"--{key}": (file, SUFFIXES[key]) for key, file in files.items()})
    events = [read_event(kind, text) for kind in OPERATIONS for text in given[kind]]
    if path is not None and files["profile"] is None:
        raise InputError("--path", "nothing shows it", "--profile beside it")
    controls = [read_control(text) for text in given["when"]]
    check_readable(network)
    scene, notes = _read(network, given)
    if controls:
        events, more = triggered(
            controls,
            events,
            lambda done: _operated(scene, list(done), t_end, places, given)[0],
            lambda each: _simulated(each, None, False),
        )
        notes = (*notes, *more)
    scene, guesses = _operated(scene, events, t_end, places, given)
    if files["save"] is not None:
        _save(scene, files["save"])
    way = _route(scene, path) if files["profile"] is not None else None
    result = _simulated(scene, way, files["map"] is not None)
    accuracy = judgement(result)
    for note in (*notes, *guesses, *result.notes):
        click.echo(f"note: {note}", err=True)
    _print(result, accuracy, as_json)
    _draw(result, way, files)
    for file in files.values():
        if file is not None and not as_json:
            click.echo(f"wrote {file}")
    if accuracy and accuracy.tol and accuracy.at_slab_ends > accuracy.tol:
        sys.exit(1)


def _read(network: str, given: dict[str, Any]) -> tuple["Scene", tuple[str, ...]]:
    suffix = Path(network).suffix.lower()
    if suffix == ".inp":
        from tline.interchange.water_scene import read_inp

        with options_named({"hour": "--at-hour", "wave_speed": "--wave-speed"}):
            more = {"hour": hours(given["at_hour"]), "moving_tanks": given["moving_tanks"]}
            return read_inp(network, given["wave_speed"], material=given["material"], **more)
    if suffix != ".toml":
        raise InputError(network, "unknown kind of file", ".inp or .toml", suffix or "no suffix")
    for option in ("wave_speed", "material", "at_hour", "moving_tanks"):
        if given[option]:
            raise InputError(f"--{option.replace('_', '-')}", "is for .inp files", "none", str(given[option]))
    from tline.scene.file import read_scene

    return read_scene(network), ()


def _operated(
    scene: "Scene", events: list["Event"], t_end: str, places: str | None, given: dict[str, Any]
) -> tuple["Scene", list[str]]:
    """The scene with all that is asked for, and notes."""
    from tline.surge.operate import operated

    with options_named({"inertia": "--inertia", "rated_speed": "--rated-speed"}):
        changed, notes = operated(scene, events, inertia=given["inertia"], rated_speed=given["rated_speed"])
    nodes = {node for line in changed.lines.values() for node in line.nodes}
    wanted = [place.strip() for place in places.split(",")] if places else _at_events(changed, events)
    for node in wanted:
        if node not in nodes:
            from tline.wording import nearest

            raise InputError("--at", "no such node", nearest(node, sorted(nodes)), f"'{node}'")
    solver = {"order": given["order"]} if given["order"] else {"tol": given["tol"] or USUAL_TOL}
    more = {"t_end": t_end, "solver": solver} | ({"rating": given["rating"]} if given["rating"] else {})
    probes = {node: {"at": node} for node in wanted} or changed.table()["probes"]
    keys = ("t_end", "--for"), ("rating", "--rating"), ("solver.order", "--order"), ("solver.tol", "--tol")
    with options_named(dict(keys)):
        return changed.with_changes(probes=probes, **more), notes


def _at_events(scene: "Scene", events: list["Event"]) -> list[str]:
    """Nodes at which something is operated."""
    found: list[str] = []
    for event in events:
        link = scene.links.get(event.name) or scene.links.get(f"{event.name}:gate")
        load = scene.loads.get(event.name)
        found += link.nodes if link else [load.at] if load else [event.name]
    ends = {node for line in scene.lines.values() for node in line.nodes}
    return [node for node in dict.fromkeys(found) if node in ends][:SHOWN]


def _save(scene: "Scene", file: str) -> None:
    from tline.scene.file import scene_text
    from tline.solver.result.atomic import replacing

    with replacing(file) as temporary:
        temporary.write_text(scene_text(scene), encoding="utf-8")


def _route(scene: "Scene", path: str | None) -> "Route":
    from tline.pictures.path import route

    with options_named({"path": "--path"}):
        return route(scene, *(node.strip() for node in path.split(","))) if path else route(scene)


def _simulated(scene: "Scene", way: "Route | None", mapped: bool) -> "Result":
    from tline.pictures.surge import lines_to_map
    from tline.solver.simulate import UnresolvedWarning, simulate

    record = [*(way.lines if way else ()), *(lines_to_map(scene) if mapped else ())]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)  # said as notes
        return simulate(scene, record=record, envelope=True, ledger=False, progress=sys.stderr.isatty())


def _draw(result: "Result", way: "Route | None", files: dict[str, str | None]) -> None:
    from tline.pictures.style import save_figure

    if files["envelope"]:
        from tline.solver.result.save import save_envelope

        save_envelope(result, files["envelope"])
    if files["map"]:
        from tline.pictures.map import plot_map

        save_figure(plot_map(result), files["map"])
    if files["profile"] and way:
        from tline.pictures.profile import plot_profile

        save_figure(plot_profile(result, way), files["profile"])
    if files["heads"]:
        from tline.pictures.traces import plot

        save_figure(plot(result), files["heads"])


def _print(result: "Result", accuracy: "Accuracy | None", as_json: bool) -> None:
    from tline.cli.surge_report import as_dict, as_text
    from tline.surge.worst import worst

    found = worst(result, SHOWN)
    click.echo(
        json.dumps(as_dict(result, found), indent=2, ensure_ascii=False)
        if as_json
        else as_text(result, accuracy, found)
    )
