"""The mechanism, moving."""

from math import hypot, tan

import numpy as np

from drives.coupled import CoupledDrives
from drives.simulation import Run
from tline.pictures.player import Animation, player

FRAMES = 150
NEEDED = ("phi1", "phi2", "x_k", "tension", "belt_speed")
HALF_WIDTH, SPOOL, PULLEY = 2.0, 0.7, 0.35  # of the drawing: from the middle to a spool, and radii
TRAVEL = 0.55  # of the pulley, at its largest deflection
LOW, HIGH = np.array([0x21, 0x66, 0xAC]), np.array([0xB2, 0x18, 0x2B])  # no tension, largest tension
NOTE = (
    "Blue: no tension; red: the largest of the run. The pulley's deflection is drawn {:.2g} times as large as the "
    "spools."
)


def animate(drives: CoupledDrives, run: Run) -> Animation:
    """Spools and pulley turn, the pulley moves, the belt's colour shows its tension.

    Parameters
    ----------
    drives : CoupledDrives
    run : Run
        What it did, linear or controlled.

    Returns
    -------
    Animation
        Its method ``save`` writes a page that needs nothing else.

    Examples
    --------
    >>> from drives import CoupledDrives, Torque, animate, simulate
    >>> run = simulate(CoupledDrives(), T2=Torque.step(0.1), t_end=2.0, step=0.01)
    >>> animate(CoupledDrives(), run).html[:15]
    '<!DOCTYPE html>'
    """
    t, outputs = run.t, run.outputs
    times = np.linspace(t[0], t[-1], FRAMES)
    seen = {name: np.interp(times, t, outputs[name]) for name in NEEDED}
    largest, real = max(float(drives.left.radius), float(drives.right.radius)), float(np.abs(outputs["x_k"]).max())
    radii = [max(0.3, SPOOL * float(x.radius) / largest) for x in (drives.left, drives.right)]
    scale = TRAVEL / real if real else 0.0
    most = float(np.abs(outputs["tension"]).max()) or 1.0
    height = min(max(HALF_WIDTH / tan(drives.pulley.angle), 0.9), 2.4) + TRAVEL
    speed = np.concatenate([[0.0], np.cumsum((seen["belt_speed"][1:] + seen["belt_speed"][:-1]) / 2 * np.diff(times))])
    frames = []
    for k in range(FRAMES):
        x_k = seen["x_k"][k]
        y = height + scale * x_k
        left = _tangent((-HALF_WIDTH, 0.0), radii[0], (0.0, y), PULLEY)
        right = _tangent((HALF_WIDTH, 0.0), radii[1], (0.0, y), PULLEY, side=-1)
        colour = np.rint(LOW + (HIGH - LOW) * min(abs(seen["tension"][k]) / most, 1)).astype(int)
        frames.append(  # turns of spools and pulley, rad, clockwise; the pulley's height, ends of two pieces of belt
            {
                "turns": [round(float(x), 4) for x in (seen["phi1"][k], speed[k] / largest * 2, seen["phi2"][k])],
                "y": round(float(y), 4),
                "belt": [[round(x, 4) for x in ends] for ends in (left, right)],
                "colour": "#{:02x}{:02x}{:02x}".format(*colour),
                "tension": float(f"{seen['tension'][k]:.4g}"),
                "speed": float(f"{seen['belt_speed'][k]:.4g}"),
                "x_k": float(f"{x_k:.4g}"),
            }
        )
    drawn = {"radii": radii, "height": height, "width": HALF_WIDTH, "pulley": PULLEY}
    told = {"title": "Coupled drives", "note": NOTE.format(scale * largest / SPOOL), "keys": ""}
    clock = {"step": float(times[1] - times[0]), "decimals": 3, "time": "s"}
    shown = "two spools, a belt and a pulley on a spring, moving"
    return Animation(player("drives", "mechanism.js", shown, {**told, **drawn, **clock, "frames": frames}))


def _tangent(
    a: tuple[float, float], radius_a: float, b: tuple[float, float], radius_b: float, side: int = 1
) -> list[float]:
    """Ends x1, y1, x2, y2 of the straight piece that touches both circles on their upper sides."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = hypot(dx, dy)
    along, across = (radius_a - radius_b) / length, side * (1 - ((radius_a - radius_b) / length) ** 2) ** 0.5
    nx, ny = (dx * along - dy * across) / length, (dy * along + dx * across) / length
    return [a[0] + radius_a * nx, a[1] + radius_a * ny, b[0] + radius_b * nx, b[1] + radius_b * ny]
