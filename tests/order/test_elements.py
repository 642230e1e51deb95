"""The error of a smooth non-linear scene falls at least at the order of the method."""

import numpy as np
import pytest

from tline.scene.scene import Scene
from tline.solver.simulate import simulate

SWING = {"shape": "sine", "amplitude": 0.2, "frequency": 0.7, "offset": 0.7, "phase": "90 deg"}


def efforts(order: int, slab: float, loads: dict) -> np.ndarray:
    scene = Scene(
        medium="hydraulic",
        t_end=3.2,
        start="steady",
        lines={"pipe": {"nodes": ["tank", "end"], "z0": 2e7, "delay": 0.1173}},
        loads={"tank": {"at": "tank", "kind": "reservoir", "pressure": 6e5}} | loads,
        sources={"out": {"at": "end", "kind": "flow", "value": SWING | {"amplitude": 0.01, "offset": -0.02}}},
        probes={"end": {"at": "end"}},
        solver={"order": order, "slab": slab},
    )
    probe = simulate(scene).probes["end"]
    return probe.u[:: round(0.1 / slab)]


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize(
    "loads",
    [
        {"valve": {"at": "end", "kind": "orifice", "kv": 90, "opening": SWING}},
        {"vessel": {"at": "end", "kind": "air vessel", "gas_volume": "20 L", "gas_pressure": 6e5}},
    ],
    ids=["valve", "vessel"],
)
def test_the_error_falls_at_the_declared_order(order, loads):
    exact = efforts(10, 0.0125, loads)
    slabs = np.array([0.05, 0.025, 0.0125])
    errors = [np.abs(efforts(order, slab, loads) - exact).max() for slab in slabs]
    assert np.polyfit(np.log(slabs), np.log(errors), 1)[0] > order - 0.2
