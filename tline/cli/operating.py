"""Options by which commands read a network and operate it."""

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from tline.cli.options import check_readable, hours, options_named

if TYPE_CHECKING:
    from tline.scene.scene import Scene

OPERATIONS = ("trip", "start", "stop", "close", "open", "burst", "demand")
ROTORS = ("inertia", "rated_speed")
READING = {key: f"--{key.replace('_', '-')}" for key in ("wave_speed", "material", "moving_tanks")}
NAMED = {key: f"--{key.replace('_', '-')}" for key in (*OPERATIONS, "when", "at", "rating", *ROTORS)} | {
    "t_end": "--for",
    "solver.order": "--order",
    "solver.tol": "--tol",
}
OPERATING = (*OPERATIONS, "when", *ROTORS, *READING, "at_hour")  # keys of the options
OPTIONS = (
    click.option("--trip", multiple=True, metavar="PUMP@TIME", help="A pump's motor fails, and it runs down."),
    click.option(
        "--start", multiple=True, metavar="PUMP@TIME", help="A motor starts its pump; +DURATION does so evenly."
    ),
    click.option(
        "--stop", multiple=True, metavar="PUMP@TIME+DURATION", help="A pump's speed falls to nothing, linearly."
    ),
    click.option(
        "--close",
        multiple=True,
        metavar="LINK@TIME+DURATION",
        help="Shut a valve, or one put into a pipe; with :20%+8s a second stage from there, with :FILE.csv a course.",
    ),
    click.option("--open", multiple=True, metavar="LINK@TIME+DURATION", help="Open a valve."),
    click.option(
        "--burst", multiple=True, metavar="NODE:FLOW@TIME", help="A hole, and its flow at the pressure before."
    ),
    click.option(
        "--demand", multiple=True, metavar="NODE:±FLOW@TIME", help="Draw more, or less, at a node; twice for a pulse."
    ),
    click.option(
        "--when",
        multiple=True,
        metavar='"NODE>PRESSURE:close LINK+DURATION"',
        help="Operate once a pressure is reached.",
    ),
    click.option("--inertia", metavar="J", help="Of pumps that trip or start, such as '2 kg m^2'; else a usual one."),
    click.option("--rated-speed", metavar="N", help="Of pumps that trip or start, such as '1450 rpm'."),
    click.option("--wave-speed", metavar="SPEED", help="In the pipes of an .inp file; 1000 m/s if nothing is said."),
    click.option(
        "--material", metavar="FILE.csv", help="Rows pipe, wall, thickness or pipe, wave speed; * is all others."
    ),
    click.option("--at-hour", metavar="HOURS", help="Begin so long after an .inp file's start."),
    click.option(
        "--moving-tanks", is_flag=True, help="Tanks of an .inp file fill and empty, instead of holding levels."
    ),
)


def operating(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of a network and of what is operated there; `operated_network` takes them."""
    for option in reversed(OPTIONS):
        command = option(command)
    return command


def operated_network(network: "Scene | str", *, at_hour: str | None, **given: Any) -> "tuple[Scene, tuple[str, ...]]":
    """The operated scene of a network, and notes on what was left out or guessed.

    Parameters
    ----------
    network : Scene or str
        Or the path of its file.
    at_hour, **given
        Values of `operating`'s options, and more of `tline.surge.operation.plan`.
    """
    from tline.surge.operation import plan, read_network

    if isinstance(network, str):
        check_readable(network)
    operations = {kind: given.pop(kind) for kind in OPERATIONS}
    reading = {key: given.pop(key) for key in READING}
    with options_named(READING | {"hour": "--at-hour"}):
        scene, read, controls = read_network(network, hour=hours(at_hour), **reading)
    with options_named(NAMED):
        scene, guesses = plan(scene, operations, controls=controls, progress=sys.stderr.isatty(), **given)
    return scene, (*read, *guesses)
