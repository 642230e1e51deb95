"""A one-way tank at a summit: waves on whole steps, an orifice and a level by hand, from the pressure at the pump."""

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from tline.scene.file import read_scene
from tline.scene.heights import GRAVITY
from tline.solver.simulate import simulate

SCENE = Path(__file__).parents[2] / "scenes" / "one_way_tank.toml"
STEP, UP, DOWN = 0.01, 40, 50  # s, and steps in the delays of 400 m and 500 m at 1000 m/s
Z0 = 1000 * 1000 / (pi / 4 * 0.25**2)
CAPACITY, AREA = 0.06 / sqrt(0.2e5), pi / 4 * 1.5**2
WEIGHT, SUMMIT, LEVEL, TANK = 1000 * GRAVITY, 30.0, 3.0, 4e5


def by_hand(pump: np.ndarray, flow: float) -> np.ndarray:
    """Piezometric pressure at the summit, flow out of the tank and its level, at steps, from the pressure at the pump.

    Both pipes bring what left their other end a delay ago: 2 p - w from where a pressure p is held. The tank gives
    q = C sqrt(d - z0/2 q), with d its pressure above the mean of the two waves, and its level falls by q over its area.
    """
    forward, backward = TANK + Z0 * flow, TANK - Z0 * flow
    to_summit, to_pump = [forward] * UP, [backward] * UP
    to_end, from_end = [forward] * DOWN, [backward] * DOWN
    level, given, rows = LEVEL, 0.0, []
    for p in pump:
        a, b = to_summit.pop(0), from_end.pop(0)
        start, q = level - given * STEP / 2 / AREA, given
        for _ in range(5):  # of the trapezoidal rule
            level = start - q * STEP / 2 / AREA
            d = max(WEIGHT * (SUMMIT + level) - (a + b) / 2, 0.0)
            q = 2 * d / (Z0 / 2 + sqrt((Z0 / 2) ** 2 + 4 * d / CAPACITY**2))
        given, u = q, (a + b + Z0 * q) / 2
        to_summit.append(2 * p - to_pump.pop(0))
        from_end.append(2 * TANK - to_end.pop(0))
        to_pump.append(2 * u - a)
        to_end.append(2 * u - b)
        rows.append((u, q, level))
    return np.array(rows).T


def test_the_summit_and_the_tank_are_those_of_the_equations_by_hand():
    probes = {"summit": {"at": "summit"}, "pump": {"at": "pump", "line": "rising_main"}, "store": {"at": "store"}}
    seen = simulate(read_scene(SCENE).with_changes(probes=probes)).probes
    t = STEP * np.arange(1, 2001)
    pump, summit, store = (seen[name].at(t) for name in ("pump", "summit", "store"))
    u, q, level = by_hand(pump.u, float(seen["pump"].y[0]))
    assert np.abs(summit.u - u).max() < 1e-5 * np.ptp(u)  # of the trapezoidal rule; 2e-6 it is
    assert store.gauge_pressure / WEIGHT == pytest.approx(level, abs=1e-5)  # kinks of the flow within steps
    assert (q.max(), LEVEL - level[-1]) == pytest.approx((0.0725, 0.168), abs=1e-3)  # the tank works
