"""Scenes of which pictures are tested, and the texts of a picture."""

import warnings
from typing import Any

from matplotlib.figure import Figure

from tline import Result, Scene
from tline.pictures.path import Route
from tline.solver.simulate import UnresolvedWarning, simulate

Z0, TANK, FLOW = 4.7e7, 6e5, 0.01
JOUKOWSKY = Z0 * FLOW  # pressure rise when the valve shuts


def quietly(scene: Scene, way: Route | None = None) -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        return simulate(scene, record=way.lines if way else ())


def water_hammer(close: str = "0.1 s", **more: Any) -> Scene:
    return Scene(
        **{
            "title": "Closing valve",
            "medium": "hydraulic",
            "t_end": "2 s",
            "start": "steady",
            "lines": {"pipe": {"nodes": ["tank", "valve"], "length": "300 m", "wave_speed": 1500, "z0": Z0}},
            "loads": {
                "tank": {"at": "tank", "kind": "reservoir", "pressure": TANK},
                "valve": {"at": "valve", "kind": "valve", "before": TANK / FLOW, "after": float("inf"), "time": close},
            },
            "probes": {"valve": {"at": "valve"}, "_middle": {"line": "pipe", "position": "50 %"}},
        }
        | more
    )


def cables(lines: dict[str, tuple[str, str, str]], **more: Any) -> Scene:
    """An electrical scene of 50-ohm cables given as (end 1, end 2, delay), stepped at the first one's end 1."""
    first = next(iter(lines.values()))[0]
    source = {"at": first, "kind": "voltage", "resistance": 25, "value": {"shape": "step", "to": "1 V"}}
    return Scene(
        **{
            "medium": "electrical",
            "t_end": "50 ns",
            "lines": {name: {"nodes": [p, q], "z0": 50, "delay": t} for name, (p, q, t) in lines.items()},
            "sources": {"in": source},
            "probes": {"in": {"at": first, "line": next(iter(lines))}},
        }
        | more
    )


FORK = {"stem": ("in", "fork", "4 ns"), "left": ("fork", "up", "2 ns"), "right": ("down", "fork", "6 ns")}


RC_END = {"end": {"at": "far", "kind": "parallel", "resistance": 200, "capacitance": "20 pF"}}


def texts(picture: Figure) -> list[str]:
    return [text.get_text() for axes in picture.axes for text in axes.texts]
