"""Copies with valves and diodes side by side, against waves followed from bounce to bounce, and runs of their own."""

import numpy as np
import pytest
from scipy.optimize import brentq

import tline as tl
from tline.solver.result.dense_output import extremes
from tline.sweeps import sweep

TOL = 1e-7
TIMES = np.linspace(0.013, 5.93, 37)
AMONG = np.random.default_rng(3).integers(200, size=3)  # copies that are looked at


def valve(start="steady"):
    return tl.examples["valve_closure"].change({"start": start, "loads.valve.characteristic": None})


def closing(z0, delay, supply, capacity, begin, duration, times):
    """Pressure at a valve that shuts in a straight line, behind a pipe from a reservoir."""

    def share(t):
        return capacity * np.clip(1 - (t - begin) / duration, 0.0, 1.0)

    def at(t):
        if t <= 0:
            flow = capacity * np.sqrt(supply)
            return supply, supply + z0 * flow
        pressure, arrived = at(t - 2 * delay)
        arriving = 2 * supply - (2 * pressure - arrived)
        c = z0 * share(t)
        root = (np.sqrt(c * c + 4 * abs(arriving)) - c) / 2
        return np.copysign(root**2, arriving), arriving

    return np.array([at(t)[0] for t in times])


def clamped(z0, delay, resistance, high, rail, saturation, thermal, source, times):
    """Voltage at the open end of a cable with a diode to a rail."""

    def at(t):
        if t < delay:
            return 0.0
        arriving = sent(t - delay)
        return brentq(
            lambda u: (arriving - u) / z0 - saturation * np.expm1((u - rail) / thermal), -high, rail + 2.0, xtol=1e-15
        )

    def sent(t):
        """a from the near end: the source's share, and what comes back."""
        if t < 0:
            return 0.0
        back = 2 * at(t - delay) - sent(t - 2 * delay) if t >= delay else 0.0
        u = (high * source(t) / resistance + back / z0) / (1 / resistance + 1 / z0)
        return 2 * u - back

    return np.array([at(t) for t in times])


@pytest.mark.parametrize("path", ["loads.valve.kv", "loads.valve.opening.duration"])
def test_closing_valves_are_those_of_the_bounces(path):
    rng = np.random.default_rng(0)
    numbers = {path: rng.uniform(0.8, 1.2, 200) * {"loads.valve.kv": 200.0, "loads.valve.opening.duration": 1.5}[path]}
    scene = valve()
    found = sweep(scene, numbers, sample="list", keep=["extremes", TIMES], tol=TOL)
    assert found.method == "vectorised"
    assert found["estimate"].max() <= TOL
    line = scene.lines["pipe"].parameters
    for k in AMONG:
        copy = scene.change({path: float(numbers[path][k])})
        duration = numbers[path][k] if path.endswith("duration") else 1.5
        numbers_of = line.z0, line.delay, 6e5, copy.loads["valve"].capacity, 0.5, duration
        exact = closing(*map(float, numbers_of), TIMES)
        np.testing.assert_allclose(found["u"][k, 0], exact, rtol=0, atol=TOL * np.abs(exact).max())


def test_clamp_diodes_are_those_of_the_bounces():
    scene = tl.examples["diode_clamp"]
    numbers = {"links.clamp.saturation": np.geomspace(1e-13, 1e-11, 200), "lines.cable.z0": np.linspace(40, 60, 200)}
    times = TIMES * 1e-8
    found = sweep(scene, numbers, sample="list", keep=["extremes", times], tol=TOL)
    assert found.method == "vectorised"
    thermal = 1.380649e-23 * 300.15 / 1.602176634e-19
    for k in AMONG:
        saturation, z0 = (values[k] for values in numbers.values())
        exact = clamped(
            z0, 5e-9, 15.0, 3.3, 3.3, saturation, thermal, lambda t: np.clip((t - 1e-9) / 0.7e-9, 0, 1), times
        )
        np.testing.assert_allclose(found["u"][k, 0], exact, rtol=0, atol=TOL * np.abs(exact).max())


BRANCHED = {
    "medium": "hydraulic",
    "start": "steady",
    "t_end": 6.0,
    "lines": {
        "in": {"nodes": ["tank", "tee"], "z0": 2e6, "delay": 0.5, "density": 1000},
        "up": {"nodes": ["tee", "valve"], "z0": 3e6, "delay": 0.25},
        "beside": {"nodes": ["valve", "tee"], "z0": 4e6, "delay": 0.75},
        "on": {"nodes": ["far", "tee"], "z0": 5e6, "delay": 0.5},
    },
    "loads": {
        "tank": {"at": "tank", "kind": "reservoir", "pressure": 6e5},
        "valve": {
            "at": "valve", "kind": "orifice", "kv": 300,
            "opening": {"shape": "ramp", "from": 1, "to": 0.2, "at": 0.3, "duration": 1.1},
        },
        "leak": {"at": "tee", "kind": "resistor", "resistance": 1e7},
        "relief": {"at": "far", "kind": "relief valve", "kv": 100, "set_pressure": 7e5, "band": 1e5},
    },
    "probes": {"valve": {"at": "valve", "line": "up"}, "far": {"at": "far"}},
}  # fmt: skip


@pytest.mark.parametrize(
    "change", [{}, {"nodes": {"tank": {"elevation": 20.0}, "far": {"elevation": -5.0}}}, {"start": "rest"}]
)
def test_copies_are_runs_of_their_own(change):
    """Loops, trees and heights, from a steady state or rest; kinks of a relief valve are found copy by copy."""
    scene = tl.Scene(**BRANCHED | change)
    numbers = {"loads.valve.kv": np.linspace(200, 400, 8), "loads.leak.resistance": np.linspace(1e7, 3e7, 8)}
    tol = 1e-5
    found = sweep(scene, numbers, sample="list", keep=["extremes", TIMES], tol=tol)
    assert found.method == "vectorised"
    assert found["estimate"].max() <= tol
    for k in (0, 3, 7):
        alone = tl.simulate(scene.change({path: float(values[k]) for path, values in numbers.items()}), tol=tol / 10)
        for j, probe in enumerate(alone.probes.values()):
            (low, _), (high, _) = extremes(probe, "gauge_pressure")
            seen, most = probe.at(TIMES), max(abs(low), abs(high))
            pairs = ((found["u"], seen.u), (found["y"], seen.y))
            for ours, theirs in pairs:
                np.testing.assert_allclose(ours[k, j], theirs, rtol=0, atol=2 * tol * max(np.abs(theirs).max(), 1e-9))
            assert abs(found["lowest"][k, j] - low) <= 2 * tol * most
            assert abs(found["highest"][k, j] - high) <= 2 * tol * most


@pytest.mark.parametrize("start", ["rest", "steady"])
def test_diodes_beside_loads_with_states_are_runs_of_their_own(start):
    ramp = {"shape": "ramp", "from": 0.3 if start == "steady" else 0.0, "to": 3.0, "at": "0.4 ns", "duration": "0.7 ns"}
    scene = tl.Scene(
        medium="electrical",
        start=start,
        t_end="12 ns",
        lines={
            "in": {"nodes": ["near", "tee"], "z0": 50, "delay": "1 ns"},
            "up": {"nodes": ["tee", "clamp"], "z0": 75, "delay": "1.5 ns"},
            "on": {"nodes": ["tee", "receiver"], "z0": 60, "delay": "0.5 ns"},
        },
        loads={
            "clamp": {"at": "clamp", "kind": "diode", "saturation": 1e-12},
            "receiver": {"at": "receiver", "kind": "series", "resistance": 40, "capacitance": "4 pF"},
        },
        sources={"s": {"at": "near", "kind": "voltage", "value": ramp, "resistance": 25}},
        probes={"clamp": {"at": "clamp"}, "receiver": {"at": "receiver"}},
    )
    capacitance, z0 = np.linspace(3e-12, 5e-12, 20), np.linspace(40, 60, 20)
    numbers, times = {"loads.receiver.capacitance": capacitance, "lines.in.z0": z0}, TIMES * 2e-9
    found = sweep(scene, numbers, sample="list", keep=["extremes", times], tol=1e-5)
    assert found.method == "vectorised"
    for k in (0, 7, 19):
        alone = tl.simulate(scene.change({path: float(each[k]) for path, each in numbers.items()}), tol=1e-9)
        for j, probe in enumerate(alone.probes.values()):
            seen = probe.at(times)
            for ours, theirs in ((found["u"], seen.u), (found["y"], seen.y)):
                np.testing.assert_allclose(ours[k, j], theirs, rtol=0, atol=1e-5 * np.abs(theirs).max())


def test_numbers_that_do_not_fit_are_told_beside_the_others():
    found = sweep(valve(), {"loads.valve.kv": [100.0, -1.0, 200.0, 300.0]}, tol=1e-4)
    assert found.method == "vectorised"
    assert [*found.errors] == [1]
    assert "loads.valve.kv" in found.errors[1]
    assert np.isfinite(found["highest"][[0, 2, 3]]).all()
