"""The mechanism, moving, as a web page of its own."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from math import hypot, tan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from tline.errors import InputError

FRAMES = 150
NEEDED = ("phi1", "phi2", "x_k", "tension", "belt_speed")
HALF_WIDTH, SPOOL, PULLEY = 2.0, 0.7, 0.35  # of the drawing: from the middle to a spool, and radii
TRAVEL = 0.55  # of the pulley, at its largest deflection
LOW, HIGH = np.array([0x21, 0x66, 0xAC]), np.array([0xB2, 0x18, 0x2B])  # no tension, largest tension


@dataclass(frozen=True)
class Motion:
    """What is drawn: frames of positions, and what stands still."""

    # per frame the time, turns of spools and pulley (rad, clockwise), pulley's height, ends of the two straight
    # pieces of belt, colour, tension and belt speed
    frames: list[dict[str, Any]]
    radii: tuple[float, float]  # of spool 1 and spool 2 as drawn
    height: float  # of the pulley at rest
    magnified: float  # how much larger than drawn to scale the pulley's deflection is


def animate(drives: CoupledDrives, t: NDArray, outputs: Mapping[str, NDArray], filename: str | Path) -> None:
    """Write an animation: spools and pulley turn, the pulley moves, the belt's colour shows its tension.

    Parameters
    ----------
    drives : CoupledDrives
    t : numpy.ndarray
        s, shape (n,).
    outputs : mapping of str to numpy.ndarray
        Of a run, linear or controlled: phi1, phi2, x_k, tension, belt_speed, each of shape (n,).
    filename : str or Path
        Of a page that needs nothing else.

    Raises
    ------
    InputError
        An output is missing.

    Examples
    --------
    >>> import os
    >>> from drives import CoupledDrives, Torque, animate, simulate
    >>> run = simulate(CoupledDrives(), T2=Torque.step(0.1), t_end=2.0, step=0.01)
    >>> animate(CoupledDrives(), run.t, run.outputs, os.devnull)
    """
    for name in NEEDED:
        if name not in outputs:
            raise InputError("outputs", "not enough to draw", ", ".join(NEEDED), f"no {name}")
    Path(filename).write_text(_page(_motion(drives, t, outputs)), encoding="utf-8")


def _motion(drives: CoupledDrives, t: NDArray, outputs: Mapping[str, NDArray]) -> Motion:
    times = np.linspace(t[0], t[-1], FRAMES)
    seen = {name: np.interp(times, t, outputs[name]) for name in NEEDED}
    largest, real = max(float(drives.left.radius), float(drives.right.radius)), float(np.abs(outputs["x_k"]).max())
    radii = tuple(max(0.3, SPOOL * float(x.radius) / largest) for x in (drives.left, drives.right))
    scale = TRAVEL / real if real else 0.0
    most = float(np.abs(outputs["tension"]).max()) or 1.0
    height = min(max(HALF_WIDTH / tan(drives.pulley.angle), 0.9), 2.4) + TRAVEL
    speed = np.concatenate([[0.0], np.cumsum((seen["belt_speed"][1:] + seen["belt_speed"][:-1]) / 2 * np.diff(times))])
    frames = []
    for k, time in enumerate(times):
        x_k = seen["x_k"][k]
        y = height + scale * x_k
        left = _tangent((-HALF_WIDTH, 0.0), radii[0], (0.0, y), PULLEY)
        right = _tangent((HALF_WIDTH, 0.0), radii[1], (0.0, y), PULLEY, side=-1)
        colour = np.rint(LOW + (HIGH - LOW) * min(abs(seen["tension"][k]) / most, 1)).astype(int)
        frames.append(
            {
                "t": round(float(time), 6),
                "turns": [round(float(x), 4) for x in (seen["phi1"][k], speed[k] / largest * 2, seen["phi2"][k])],
                "y": round(float(y), 4),
                "belt": [[round(x, 4) for x in ends] for ends in (left, right)],
                "colour": "#{:02x}{:02x}{:02x}".format(*colour),
                "tension": float(f"{seen['tension'][k]:.4g}"),
                "speed": float(f"{seen['belt_speed'][k]:.4g}"),
                "x_k": float(f"{x_k:.4g}"),
            }
        )
    return Motion(frames, (radii[0], radii[1]), height, scale * largest / SPOOL)


def _tangent(
    a: tuple[float, float], radius_a: float, b: tuple[float, float], radius_b: float, side: int = 1
) -> list[float]:
    """Ends x1, y1, x2, y2 of the straight piece that touches both circles on their upper sides."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = hypot(dx, dy)
    along, across = (radius_a - radius_b) / length, side * (1 - ((radius_a - radius_b) / length) ** 2) ** 0.5
    nx, ny = (dx * along - dy * across) / length, (dy * along + dx * across) / length
    return [a[0] + radius_a * nx, a[1] + radius_a * ny, b[0] + radius_b * nx, b[1] + radius_b * ny]


def _page(motion: Motion) -> str:
    text = json.dumps({**vars(motion), "width": HALF_WIDTH, "pulley": PULLEY}, separators=(",", ":"))
    template = files("drives").joinpath("animation.html").read_text(encoding="utf-8")
    return template.replace("DATA", text.replace("<", "\\u003c"), 1)
