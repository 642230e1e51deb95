"""Command `tline design`: size of a protection against surges."""

import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tline.cli.from_signature import Command, FileKind, Output, command, picture, table
from tline.cli.options import tolerance, write_text
from tline.cli.surge import NAMES, OPERATE, OPERATING, operated_network
from tline.presentation import Presentation

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
FILES = {
    "output": FileKind((".toml",), "Write the scene with what was found"),
    "plot": picture("Extremes over the size"),
    "csv": table("The same as a table, SI"),
}


@click.group("design", epilog=EXAMPLES)
def design() -> None:
    """Size a protection against surges, by runs of a scene with other sizes.

    A network is a scene (.toml) that starts in the steady state and has the surge in it, or a file of EPANET (.inp);
    --trip, --close and the like operate it, as in `tline surge`. Limits are gauge pressures ("0.5 bar"), or heads
    ("35 m") above the zero of elevations, at all nodes that no reservoir holds or all along a path. Printed are the
    size, its margin to the limit, and the curve of extremes over sizes.
    """


def _search(function: Callable[..., Output]) -> Command:
    """Make a search of `tline.design` a command."""
    name = function.__name__
    sources = f"tline.design.{'closure' if name == 'closure' else 'protection'}:{name}", OPERATE
    omit = ("at", "order", "rating", "record", "network", "seconds")
    length = click.Option(
        ["--for", "t_end"], metavar="TIME", help="How long to run; 60 s, or as long as a scene says, if not given."
    )
    made = command(*sources, names=NAMES, files=FILES, omit=omit, more=[length], group=design, epilog=EXAMPLES)
    return made(function)


@_search
def vessel(
    network: str, *, at: str, kv: str | None = None, exponent: str | None = None, confined: bool = False, **given: Any
) -> Output:
    """Find the smallest air vessel at a node, and its precharge.

    Parameters
    ----------
    at : NODE
        Its node.
    kv : NUMBER
        Of the throttle between pipe and vessel, m³/h at 1 bar; none if not given.
    exponent : NUMBER
        Of the gas: 1.2 if not given.
    """
    more = {key: value for key, value in (("kv", kv), ("exponent", exponent)) if value is not None}
    return _found(vessel, network, confined, given | more | {"at": at})


@_search
def closure(network: str, valve: str, *, confined: bool = False, **given: Any) -> Output:
    """Find the shortest closure of a valve under a pressure rating."""
    return _found(closure, network, confined, given | {"valve": valve})


@_search
def relief(network: str, *, at: str, confined: bool = False, **given: Any) -> Output:
    """Find the smallest relief valve at a node, or its set pressure.

    Parameters
    ----------
    at : NODE
        Its node.
    """
    return _found(relief, network, confined, given | {"at": at})


@_search
def flywheel(network: str, pump: str, *, confined: bool = False, **given: Any) -> Output:
    """Find the smallest inertia of a pump that trips."""
    return _found(flywheel, network, confined, given | {"pump": pump})


@command(group=design, epilog=EXAMPLES)
def separation(scene: "Scene") -> Presentation:
    """Find the highest pressure where columns separate, over three numbers of places."""
    from tline.design.columns import separation as search

    return search(scene)


def _found(search: Command, network: str, confined: bool, given: dict[str, Any]) -> Output:
    from tline import design as searches
    from tline.scene.file import scene_text
    from tline.solver.simulate import UnresolvedWarning

    operations = {key: given.pop(key) for key in OPERATING if key in given}
    tol, t_end = given.pop("tol", None), given.pop("t_end", None)
    scene, guesses = _operated(network, confined, t_end, tol, operations)
    given |= {"path": [node.strip() for node in given["path"].split(",")]} if "path" in given else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)  # said as notes
        found: Sizing = getattr(searches, str(search.name))(
            scene, tol=None if tol is None else tolerance(tol), progress=sys.stderr.isatty(), **given
        )
    output = search.shown(found, output=lambda file: write_text(scene_text(found.scene), file))
    return output._replace(notes=(*guesses, *output.notes))


def _operated(
    network: str, confined: bool, t_end: str | None, tol: str | None, operations: dict[str, Any]
) -> "tuple[Scene, tuple[str, ...]]":
    """Return the scene for a search, and notes on quantities assumed in it."""
    from tline.design.sizing import USUAL_TOL
    from tline.interchange.any_file import read as read_any
    from tline.scene.file import EPANET

    if Path(network).suffix.lower() in EPANET:
        return operated_network(network, t_end=t_end or "60 s", tol=tol or USUAL_TOL, **operations)
    scene = read_any(network, confined=confined)
    if operations:
        return operated_network(scene, t_end=t_end or scene.t_end, tol=tol or USUAL_TOL, **operations)
    return scene.with_changes(t_end=t_end) if t_end else scene, ()
