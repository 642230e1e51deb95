"""`tline surge`: operate a network without editing a file, and see what is worst."""

import json
import sys
from typing import TYPE_CHECKING, Any

import click

from tline.cli.operating import operated_network, operating
from tline.cli.options import PICTURE, check_files, options_named
from tline.errors import InputError

if TYPE_CHECKING:
    from tline.pictures.path import Route
    from tline.scene.scene import Scene
    from tline.solver.result.result import Result

EXAMPLES = """\b
Examples:
  tline surge town.inp --trip duty@1s --for 30s
  tline surge town.inp --close ease@1s+5s --burst "b:20 L/s@2s" --demand "c:-5 L/s@0s" \\
      --at-hour 8 --save surge.toml --map surge.png
"""
SUFFIXES = {"save": (".toml",), "map": PICTURE, "profile": PICTURE, "heads": PICTURE, "envelope": (".csv",)}


@click.command("surge", epilog=EXAMPLES)
@click.argument("network")
@operating
@click.option("--for", "t_end", default="60s", metavar="TIME", help="How long to run; 60 s if not given.")
@click.option("--tol", metavar="NUMBER", help="Largest error at the nodes that are told, relative to their amplitude.")
@click.option("--order", metavar="1…16", help="One run of this order, in the slabs that suit it.")
@click.option("--rating", metavar="PRESSURE", help="What the pipes bear, such as '16 bar'.")
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
    have units, and an operation without a duration is done at once. The exit status is 1 if the tolerance is not met,
    or no pressure class can be told: columns separate, or the highest pressure comes at the end of the run.
    """
    from tline.cli.report import judgement
    from tline.surge.operation import SHOWN, run
    from tline.surge.report import as_dict, as_text
    from tline.surge.worst import worst

    files = {key: given.pop(key) for key in SUFFIXES}
    check_files({f"--{key}": (file, SUFFIXES[key]) for key, file in files.items()})
    if path is not None and files["profile"] is None:
        raise InputError("--path", "nothing shows it", "--profile beside it")
    at = [place.strip() for place in places.split(",")] if places else ()
    scene, guesses = operated_network(network, t_end=t_end, at=at, **given)
    if files["save"] is not None:
        _save(scene, files["save"])
    way = _route(scene, path) if files["profile"] is not None else None
    result = run(scene, _shown(scene, way, files["map"] is not None), sys.stderr.isatty())
    accuracy = judgement(result)
    for note in (*guesses, *result.notes):
        click.echo(f"note: {note}", err=True)
    found = worst(result, SHOWN)
    click.echo(
        json.dumps(as_dict(result, found), indent=2, ensure_ascii=False)
        if as_json
        else as_text(result, accuracy, found)
    )
    _draw(result, way, files)
    for file in files.values():
        if file is not None and not as_json:
            click.echo(f"wrote {file}")
    if found.untold or (accuracy and accuracy.tol and accuracy.at_slab_ends > accuracy.tol):
        sys.exit(1)


def _save(scene: "Scene", file: str) -> None:
    from tline.scene.file import scene_text
    from tline.solver.result.atomic import replacing

    with replacing(file) as temporary:
        temporary.write_text(scene_text(scene), encoding="utf-8")


def _route(scene: "Scene", path: str | None) -> "Route":
    from tline.pictures.path import route

    with options_named({"path": "--path"}):
        return route(scene, *(node.strip() for node in path.split(","))) if path else route(scene)


def _shown(scene: "Scene", way: "Route | None", mapped: bool) -> tuple[str, ...]:
    """Lines of whose inside a picture is drawn."""
    from tline.pictures.surge import lines_to_map

    return (*(way.lines if way else ()), *(lines_to_map(scene) if mapped else ()))


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
