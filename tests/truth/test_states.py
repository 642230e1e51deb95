"""What elements show of their states, against their own equations with what probes saw beside them.

Integrals of probes are taken by Simpson's rule through slab ends, so a comparison is good to what that rule misses.
"""

from math import pi

import numpy as np
from scipy.integrate import cumulative_simpson

import tline as tl

PIPE = {"length": "400 m", "diameter": "30 cm", "wave_speed": 1000, "density": 1000}


def run(links, loads, *, lines=None, t_end="3 s", **more):
    lines = lines or {"main": {"nodes": ["out", "far"], **PIPE}}
    probes = {"out": {"at": "out", "line": "main"}, "far": {"at": "far", "line": "main"}}
    given = {"medium": "hydraulic", "t_end": t_end, "start": "steady", "lines": lines, "links": links, "loads": loads}
    return tl.simulate(tl.Scene(**given, probes=probes, solver={"order": 5, "slab": "20 ms"}, **more))


def states(result):
    return {trace.word: trace.values for trace in result.states}


LAKE = {"lake": {"at": "lake", "kind": "reservoir", "pressure": "1 bar"}}
HIGH = {"high": {"at": "far", "kind": "reservoir", "pressure": "5 bar"}}


def test_a_pump_that_runs_down_obeys_newtons_law():
    inertia, rated, summit = 4.0, 24.0, 6e5
    pump = {
        "kind": "pump", "nodes": ["lake", "out"], "curve": [[0, summit], [0.1, 4e5]], "trip": 0, "inertia": inertia,
        "rated_speed": rated,
    }  # fmt: skip
    result = run({"pump": pump}, LAKE | HIGH)
    seen, t = states(result), result.t
    np.testing.assert_allclose(seen["flow"][1:], result.probes["out"].y[1:], atol=1e-9)
    share = seen["speed"] / rated
    torque = summit * share * seen["flow"] / (2 * pi * rated)  # what a curve without a linear part takes from the rotor
    np.testing.assert_allclose(seen["torque"], torque, rtol=1e-12)
    np.testing.assert_allclose(seen["shaft power"], torque * 2 * pi * seen["speed"], rtol=1e-12)
    lost = cumulative_simpson(torque[1:], x=t[1:], initial=0) / (2 * pi * inertia)
    flows = seen["speed"][1] - seen["speed"][1:]
    np.testing.assert_allclose(flows, lost, atol=1e-3 * flows.max())


def test_a_pump_whose_power_returns_obeys_it_too():
    inertia, rated, motor = 1.0, 24.0, 900.0
    pump = {
        "kind": "pump", "nodes": ["lake", "out"], "curve": [[0, 6e5], [0.1, 4e5]], "trip": "0.2 s", "start": "0.8 s",
        "inertia": inertia, "rated_speed": rated, "motor_torque": motor,
    }  # fmt: skip
    result = run({"pump": pump}, LAKE | HIGH, t_end="1 s")
    seen, t = states(result), result.t
    assert seen["speed"][-1] > seen["speed"].min() + 0.5
    for begin, end, torque in ((0.2, 0.8, 0.0), (0.8, 1.0, motor)):
        part = (t > begin - 1e-9) & (t < end + 1e-9) & (seen["speed"] < 0.99 * rated)  # which its motor holds then
        net = cumulative_simpson(torque - seen["torque"][part], x=t[part], initial=0) / (2 * pi * inertia)
        assert np.abs(net).max() > 0.5
        np.testing.assert_allclose(seen["speed"][part] - seen["speed"][part][0], net, atol=2e-3 * np.abs(net).max())


def test_gas_has_the_volume_that_its_pressure_and_what_flowed_in_ask_for():
    vessel = {"at": "far", "kind": "air vessel", "gas_pressure": "4 bar", "gas_volume": "0.3 m^3", "exponent": 1.3}
    feed = {"at": "out", "kind": "flow", "value": {"shape": "sine", "amplitude": 0.02, "frequency": "0.4 Hz"}}
    result = run({}, {"vessel": vessel}, sources={"feed": feed})
    seen, far = states(result), result.probes["far"]
    np.testing.assert_allclose(seen["gas pressure"], far.u, rtol=1e-6)
    absolute = far.u + 101_325
    expected = 0.3 * (501_325 / absolute) ** (1 / 1.3)
    np.testing.assert_allclose(seen["gas volume"], expected, rtol=1e-6)
    inflow = cumulative_simpson(far.y, x=result.t, initial=0)
    np.testing.assert_allclose(seen["gas volume"][0] - seen["gas volume"], inflow, atol=2e-5)
    np.testing.assert_allclose(seen["inflow"][1:], far.y[1:], atol=1e-8)


def test_a_tank_has_the_level_of_its_pressure():
    tank = {"at": "far", "kind": "surge tank", "tank_diameter": "1 m", "density": 1000, "level": "20 m"}
    feed = {"at": "out", "kind": "flow", "value": {"shape": "ramp", "to": 0.05, "duration": "1 s"}}
    result = run({}, {"tank": tank}, sources={"feed": feed})
    np.testing.assert_allclose(states(result)["level"], result.probes["far"].u / 9806.65, rtol=1e-12)


def test_a_cavity_has_the_volume_that_flowed_away():
    valve = {"nodes": ["lake", "out"], "kind": "orifice", "flow": "50 L/s", "pressure_drop": "1 bar"}
    valve["opening"] = {"shape": "step", "from": 1, "to": 0, "at": "0.4 s"}
    cavity = {"at": "out", "kind": "vapour cavity"}
    low = {"low": {"at": "far", "kind": "reservoir", "pressure": "0 bar"}}
    result = run({"valve": valve}, LAKE | low | {"cavity": cavity}, t_end="2 s")
    seen, out = states(result), result.probes["out"]
    grown = cumulative_simpson(np.where(result.t > 0.4, out.y, 0.0), x=result.t, initial=0)
    opened = (seen["cavity"] > 0) & (result.t < 1.1)  # until the wave comes back
    assert opened.sum() > 20
    np.testing.assert_allclose(seen["cavity"][opened], grown[opened], atol=2 * 0.02 * 0.05)  # within two slabs of flow
    np.testing.assert_array_equal(seen["opening"][[0, -1]], [1, 0])


def test_a_valve_that_moves_itself_shows_the_opening_that_its_flow_asks_for():
    lines = {"feed": {"nodes": ["lake", "a"], **PIPE}, "main": {"nodes": ["out", "far"], **PIPE}}
    valve = {
        "kind": "regulating valve", "nodes": ["a", "out"], "keeps": "downstream", "set_pressure": "0.5 bar",
        "flow": "0.2 m^3/s", "pressure_drop": "1 bar", "time_constant": "1 s",
    }  # fmt: skip
    less = {"shape": "ramp", "from": 1, "to": 0.3, "at": "0.2 s", "duration": "1 s"}
    tap = {"at": "far", "kind": "orifice", "flow": "20 L/s", "pressure_drop": "0.5 bar", "opening": less}
    scene = run({"prv": valve}, LAKE | {"tap": tap}, lines=lines, t_end="4 s").scene
    scene = scene.with_changes(probes=scene.table()["probes"] | {"a": {"at": "a", "line": "feed"}})
    result = tl.simulate(scene)
    drop = result.probes["a"].u - result.probes["out"].u
    passes = drop > 1e3
    expected = result.probes["out"].y[passes] / (0.2 * np.sqrt(drop[passes] / 1e5))
    found = next(trace.values for trace in result.states if trace.where == "links.prv")
    assert np.ptp(found[passes]) > 0.02
    assert passes.sum() > 50
    np.testing.assert_allclose(found[passes], expected, rtol=1e-6)
