"""Pipes with friction behind a valve that shuts, for tests of several kinds; delays of 1 s, Joukowsky's rise 1 MPa."""

import numpy as np

from tline.scene.scene import Scene

AREA = np.pi * 0.25**2
RISE = 1e6  # Pa


def pipes(*delays: float, **friction) -> dict:
    """Lines one after the other from the reservoir to the valve, in which 1 m/s is 1 MPa."""
    nodes = ["reservoir", *(f"joint{k}" for k in range(1, len(delays))), "valve"]
    given = {"diameter": 0.5, "wave_speed": 1000, "density": 1000, "friction": friction}
    return {
        f"pipe{k}": {"nodes": [nodes[k], nodes[k + 1]], "length": 1000 * delay, **given}
        for k, delay in enumerate(delays)
    }


def shut(flow, lines: dict, t_end: float, **scene) -> Scene:
    """A flow of 1 m/s out of the valve until it follows a waveform; the reservoir stays at 0 Pa."""
    return Scene(
        medium="hydraulic",
        t_end=t_end,
        start="steady",
        lines=lines,
        sources={
            "reservoir": {"at": "reservoir", "kind": "pressure", "value": 0, "resistance": 0},
            "valve": {"at": "valve", "kind": "flow", "value": flow},
        },
        probes={"valve": {"at": "valve"}},
        **scene,
    )


def at_once(instant: float) -> dict:
    """The flow that stops at an instant."""
    return {"shape": "step", "from": -AREA, "to": 0.0, "at": instant}
