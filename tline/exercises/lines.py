"""Problem 2: what a pipe and a cable are, and their waves."""

from functools import cache
from typing import Any

import numpy as np

from tline.exercises.answer import Found
from tline.line import ElectricalLine, HydraulicLine

PIPE: dict[str, Any] = {"radius": 0.1, "wave_speed": 1500, "density": 980}
CABLE: dict[str, Any] = {"wave_speed": 3e8, "z0": 300}
LENGTH, PLACES = 3000.0, 400  # m; points of a curve
SNAPSHOTS = (0.6, 1.4, 2.2)  # in delays of the line


def pipe() -> Found:
    """The hydraulic line."""
    line = HydraulicLine(**PIPE)
    assert line.bulk_modulus is not None
    assert line.area is not None
    numbers = {
        "bulk_modulus": line.bulk_modulus,
        "bulk_bar": line.bulk_modulus / 1e5,
        "z0": line.z0,
        "z0_bar": line.z0 / 1e5,
        "area": line.area,
        "per_litre": line.z0 * 1e-3 / 1e5,
    }
    return Found(numbers, draw=("draw_snapshots", "hydraulic"))


def cable() -> Found:
    """The electrical line."""
    line = ElectricalLine(**CABLE)
    assert line.capacitance is not None
    assert line.inductance is not None
    numbers = {"capacitance": line.capacitance, "inductance": line.inductance}
    numbers |= {"capacitance_pf": line.capacitance * 1e12, "inductance_uh": line.inductance * 1e6}
    return Found(numbers, draw=("draw_snapshots", "electrical"))


@cache
def snapshots(medium: str) -> tuple[Any, ...]:
    """Places [m], and for each snapshot its time [s] and both waves, relative to the largest effort sent."""
    import tline as tl
    from tline.solver.result.interior import inside

    line = HydraulicLine(**PIPE) if medium == "hydraulic" else ElectricalLine(**CABLE)
    delay = LENGTH / (line.wave_speed or 0.0)
    sent = {"shape": "sine", "amplitude": 1.0, "frequency": 1 / delay}
    scene = {
        "medium": medium,
        "t_end": 2.5 * delay,
        "lines": {"line": {"nodes": ["near", "far"], "z0": line.z0, "delay": delay}},
        "probes": {"far": {"at": "far"}},
        "sources": {"s": {"at": "near", "kind": "pressure" if medium == "hydraulic" else "voltage", "value": sent}},
    }
    scene["sources"]["s"]["resistance"] = line.z0
    result = tl.simulate(scene, record=["line"])
    shares, seen = np.linspace(0.0, 1.0, PLACES), inside(result, "line")
    times = [part * delay for part in SNAPSHOTS]
    waves = [np.array([seen.waves(np.array([t]), float(x)) for x in shares])[..., 0].T for t in times]
    return LENGTH * shares, times, waves


FOUND = {"2a": pipe, "2b": cable}
