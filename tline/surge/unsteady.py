"""Friction added while flows change, in all pipes of a network by one word."""

from math import pi
from typing import Any

from tline.errors import InputError
from tline.interchange.water_network import listed
from tline.scene.friction import ByFlow, VardyBrown
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import above_level
from tline.words.wording import nearest

KINDS = ("none", "vardy-brown", "zielke")
VISCOSITY, LEAST, MOST = 1e-3, 2e3, 1e8  # Pa s, of water at 20 °C; Reynolds numbers of Vardy's and Brown's fit


def with_unsteady(scene: Scene, kind: str) -> tuple[Scene, list[str]]:
    """The scene whose pipes with a law of steady friction have this unsteady part, and notes; "none" takes it away.

    That of Vardy and Brown is about the flow that a pipe has at the start.
    """
    if kind not in KINDS:
        raise InputError("unsteady", "unknown law of friction", nearest(kind, [*KINDS]), f"'{kind}'")
    description = describe(scene)
    flows = dict(zip(description.lines, above_level(description).flows[:, 0].tolist(), strict=True))
    lines, left, numbers = scene.with_lines(), set[str](), list[float]()
    for name, line in scene.lines.items():
        friction = getattr(line, "friction", None)
        diameter, density = (getattr(line.parameters, key, None) for key in ("diameter", "density"))
        if not isinstance(friction, ByFlow) or isinstance(friction, VardyBrown) or not diameter or not density:
            left |= {name}
            continue
        table: dict[str, Any] = {key: value for key, value in friction.table().items() if key != "unsteady"}
        viscosity = float(getattr(friction, "viscosity", VISCOSITY))
        if kind != "none":
            table["unsteady"] = {"kind": kind, "viscosity": viscosity}
        if kind == "vardy-brown":
            flow = abs(flows[name])
            numbers.append(min(max(4 * density * flow / (pi * diameter * viscosity), LEAST), MOST))
            table["unsteady"] |= {"reynolds": numbers[-1], "roughness": float(getattr(friction, "roughness", 0.0))}
        lines["lines"][name] = line.table() | {"friction": table}
    notes = [f"unsteady friction: pipes without a law of steady friction have none: {listed(left)}"] * bool(left)
    if numbers:
        notes.append(f"unsteady friction: about the flows of the start, Re {min(numbers):.2g} to {max(numbers):.2g}")
    return Scene(scene.folder, **lines), notes
