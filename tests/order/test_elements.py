"""Errors of circuits, valves and vessels between lines fall at the order of the method, and at slab ends faster."""

import numpy as np
import pytest
from bounces import COILS, SERIES, closed_form, scene_of
from one_line import from_tank

from tline import simulate

SWING = {"shape": "sine", "amplitude": 0.2, "frequency": 0.7, "offset": 0.7, "phase": "90 deg"}


def efforts(order: int, slab: float, loads: dict) -> np.ndarray:
    out = {"out": {"at": "end", "kind": "flow", "value": SWING | {"amplitude": 0.01, "offset": -0.02}}}
    solver = {"order": order, "slab": slab}
    probe = simulate(from_tank(3.2, {"z0": 2e7, "delay": 0.1173}, 6e5, loads, sources=out, solver=solver)).probes["end"]
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


SLABS = np.array([0.125, 0.0625, 0.03125])
INSTANTS = np.arange(0.5, 10, 0.5)[3::2]  # halfway between echoes


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("link", [SERIES, COILS], ids=["series RLC", "coupled coils"])
def test_the_error_falls_at_twice_the_order_less_one(link, order):
    exact = closed_form(link, INSTANTS)
    errors = []
    for slab in SLABS:
        probes = simulate(scene_of(link, order, slab)).probes
        ends = np.round(INSTANTS / slab).astype(int)
        assert np.abs(probes["far"].t[ends] - INSTANTS).max() < 1e-12
        errors.append(
            max(np.abs(probes[name].u[ends] - u).max() for name, u in zip(("near", "far"), exact, strict=True))
        )
    assert np.polyfit(np.log(SLABS), np.log(errors), 1)[0] > 2 * order - 1.3
