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


def behind_a_pump(t, begins, takes):
    """Pressure behind a pump, before a short pipe to a valve that shuts, bounce by bounce.

    The pump, with a rise of h - c q |q|, has no check valve: the flow through it turns. Beyond the valve is a main.
    """
    z = 1e6 / (np.pi * 0.1**2)  # of both pipes, whose delays are 0.03 s and 33 times that
    sump, lake, h, c, rated = 0.5e5, 4e5, 4 / 3 * 5e5, 5e5 / 3 / 0.04**2, 500 / 3600
    flow = np.sqrt((sump + h - lake) / (c + 1e5 / rated**2))
    drop = 1e5 * (flow / rated) ** 2
    bounces = np.floor(t / 0.06).astype(int)
    begin = t - 0.06 * bounces
    after, main, seen = np.full_like(t, lake + drop - z * flow), [], np.empty_like(t)
    for k in range(bounces.max() + 1):
        w = after - sump - h  # of the pump: u = after + z q, and u = sump + h - c q |q|
        q = -2 * w / (z + np.sqrt(z * z + 4 * c * np.abs(w)))
        u = after + z * q
        seen[bounces == k] = u[bounces == k]
        arrives = 2 * u - after  # at the valve, after one delay
        left = lake - z * flow if k < 33 else 2 * lake - main[k - 33]
        opening = np.clip(1 - (begin + 0.06 * k + 0.03 - begins) / takes, 0, 1)
        v = (z * rated * opening) ** 2 / 1e5
        d = arrives - left
        q = np.sign(d) * (np.sqrt(v * v + v * np.abs(d)) - v) / z
        main.append(left + 2 * z * q)
        after = arrives - 2 * z * q
    return seen


@pytest.mark.parametrize(("tol", "takes"), [(1e-3, 1e-3), (1e-5, 1e-3), (1e-5, 20e-3)])
def test_the_flow_through_a_pump_turns_while_a_valve_shuts(tol, takes):
    pipe = {"diameter": "20 cm", "wave_speed": 1000, "density": 1000}
    opening = {"shape": "ramp", "from": 1, "to": 0, "at": 1.0137, "duration": takes}
    scene = {
        "medium": "hydraulic", "t_end": "3 s", "start": "steady", "probes": {"header": {"at": "header"}},
        "lines": {
            "short": {"nodes": ["header", "before"], "length": 30, **pipe},
            "main": {"nodes": ["behind", "lake"], "length": 990, **pipe},
        },
        "loads": {
            "sump": {"at": "sump", "kind": "reservoir", "pressure": "0.5 bar"},
            "lake": {"at": "lake", "kind": "reservoir", "pressure": "4 bar"},
        },
        "links": {
            "pump": {"kind": "pump", "nodes": ["sump", "header"], "curve": [["40 L/s", "5 bar"]]},
            "valve": {
                "kind": "orifice", "nodes": ["before", "behind"], "flow": "500 m^3/h", "pressure_drop": "1 bar",
                "opening": opening,
            },
        },
    }  # fmt: skip
    result = tl.simulate(scene, tol=tol)
    beside = np.random.default_rng(1).uniform(0, 3, 20_000), np.random.default_rng(2).uniform(1.04, 1.07, 20_000)
    t = np.concatenate(beside)
    expected = behind_a_pump(t, 1.0137, takes)
    off = np.abs(result.probes["header"].at(t).u - expected).max() / np.abs(expected).max()
    assert result.accuracy.met
    assert off <= 3 * min(tol, result.accuracy.worst)
