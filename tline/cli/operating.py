"""How commands read a network and operate it."""

import sys
from typing import TYPE_CHECKING, Any

from tline.cli.from_signature import Command
from tline.cli.options import check_readable, hours, options_named

if TYPE_CHECKING:
    from tline.scene.scene import Scene

OPERATE = "tline.surge.operation:operate"
OPERATIONS = ("trip", "start", "stop", "close", "open", "burst", "demand")
READING = ("wave_speed", "material", "hour", "moving_tanks")
OPERATING = (*OPERATIONS, "when", "inertia", "rated_speed", *READING)
NAMES = {"t_end": "for", "hour": "at_hour"}  # of options


def operated_network(command: Command, network: "Scene | str", **given: Any) -> "tuple[Scene, tuple[str, ...]]":
    """The operated scene of a network, and notes on what was left out or guessed.

    Parameters
    ----------
    command : Command
        Whose options errors name.
    network : Scene or str
        Or the path of its file.
    **given
        Arguments of `tline.surge.operation.operate`.
    """
    from tline.surge.operation import plan, read_network

    if isinstance(network, str):
        check_readable(network)
    operations = {kind: given.pop(kind) for kind in OPERATIONS if kind in given}
    reading = {key: given.pop(key) for key in READING if key in given}
    reading |= {"hour": hours(reading["hour"])} if "hour" in reading else {}
    with options_named({"hour": "--at-hour", **{key: f"--{key.replace('_', '-')}" for key in READING[:2]}}):
        scene, read, controls = read_network(network, **reading)
    with command.named(**{"solver.order": "--order", "solver.tol": "--tol"}):
        scene, guesses = plan(scene, operations, controls=controls, progress=sys.stderr.isatty(), **given)
    return scene, (*read, *guesses)
