"""Corners of a valve that closes, at any place of a slab, against its recursion, bounce by bounce."""

from pathlib import Path

import numpy as np
import pytest

import tline as tl

HOSE = tl.read(Path(__file__).parents[2] / "scenes" / "hydraulic_hose.toml")
NO_LOSS = {"kind": "darcy", "factor": 1e-12}
DENSITY, MODULUS, LENGTH, DIAMETER = 870.0, 7e8, 6.0, 12.7e-3
SUPPLY, DROP, FLOW = 160e5, 150e5, 40e-3 / 60
SPEED = np.sqrt(MODULUS / DENSITY)
Z0, TRANSIT = DENSITY * SPEED / (np.pi * DIAMETER**2 / 4), LENGTH / SPEED


def exact(t, at, duration):
    """Pressure at the valve: p + Z0 q arrives, with q = k √p through what is open."""

    def through(t, arrives):
        k = FLOW / np.sqrt(DROP) * np.clip(1 - (t - at) / duration, 0, 1)
        root = -k * Z0 / 2 + np.sqrt((k * Z0 / 2) ** 2 + arrives)
        return root**2, k * root

    k = FLOW / np.sqrt(DROP)
    arrives = np.full_like(t, SUPPLY + Z0 * k * np.sqrt(SUPPLY))
    bounces = np.floor(t / (2 * TRANSIT)).astype(int)
    for bounce in range(bounces.max(), 0, -1):
        early = bounces >= bounce
        p, q = through(t[early] - 2 * TRANSIT * bounce, arrives[early])
        arrives[early] = 2 * SUPPLY - (p - Z0 * q)
    return through(t, arrives)[0]


# the first corner is 3 % of a slab before its end, also of slabs half and a quarter as wide
@pytest.mark.parametrize(("at", "duration"), [(10e-3, 5e-3), (2.86e-3, 4.18e-3), (9.38e-3, 7.78e-3)])
@pytest.mark.parametrize("tol", [1e-2, 1e-3])
def test_runs_that_err_alike_are_not_called_met(at, duration, tol):
    scene = HOSE.change({"lines.hose.friction": NO_LOSS, "solver": {"tol": tol}})
    scene = scene.change({"loads.valve.opening.at": at, "loads.valve.opening.duration": duration})
    t = np.random.default_rng(5).uniform(0, 0.15, 20_000)
    result = tl.simulate(scene)
    expected = exact(t, at, duration)
    off = np.abs(result.probes["valve"].at(t).u - expected).max() / np.ptp(expected)
    assert result.accuracy.met
    assert off <= 3 * min(tol, result.accuracy.worst)


@pytest.mark.parametrize("tol", [1e-2, 1e-3])
def test_a_hose_whose_valve_shuts_is_met_on_the_whole_curve(tol):
    assert tl.simulate(HOSE.change({"solver": {"tol": tol}})).accuracy.met
