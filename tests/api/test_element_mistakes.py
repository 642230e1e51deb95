"""Mistakes with non-linear elements: one sentence each, that names the element and what to do."""

import re

import pytest

from tline import InputError, Scene, simulate

SOUND = {
    "medium": "hydraulic",
    "t_end": 1.0,
    "lines": {"pipe": {"nodes": ["tank", "end"], "z0": 1e7, "delay": 0.1}},
    "loads": {
        "tank": {"at": "tank", "kind": "reservoir", "pressure": 5e5},
        "v": {"at": "end", "kind": "orifice", "kv": 100},
    },
    "links": {"pump": {"kind": "pump", "nodes": ["sump", "tank2"], "curve": [[0.02, 3e5]]}},
    "sources": {},
    "probes": {"end": {"at": "end"}},
}


def scene(load: dict | None = None, link: dict | None = None, **more) -> Scene:
    loads = SOUND["loads"] | ({"x": {"at": "end"} | load} if load else {})
    links = {"x": {"nodes": ["end", "tank"]} | link} if link else {}
    return Scene(**SOUND | {"loads": loads, "links": links} | more)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ({"kind": "orifice"}, "loads.x: its capacity is not given, expected kv, cv"),
        ({"kind": "orifice", "kv": 3, "cv": 4}, "loads.x: its capacity is not given once"),
        ({"kind": "orifice", "kv": -3}, "loads.x.kv: kv out of range, expected more than 0"),
        ({"kind": "orifice", "loss_coefficient": -1, "area": 1}, "loss coefficient out of range, expected more than 0"),
        ({"kind": "orifice", "loss_coefficient": 1}, "its capacity is not given once"),
        ({"kind": "orifice", "kv": 3, "opening": 1.5}, r"loads.x.opening: out of range, expected from 0 to 1, got 1.5"),
        ({"kind": "orifice", "kv": 3, "opening": "3 bar"}, "loads.x.opening: "),
        (
            {"kind": "orifice", "kv": 3, "opening": {"shape": "ramp", "from": 1, "to": -1, "duration": 1}},
            "loads.x.opening: out of range, expected from 0 to 1, got -",
        ),
        ({"kind": "orifice", "kv": 3, "characteristic": [[0, 0], [0.5, 2], [1, 1]]}, "share out of range"),
        ({"kind": "orifice", "kv": 3, "characteristic": [[0, 0], [0.5, 1]]}, "does not cover all openings once"),
        ({"kind": "orifice", "kv": 3, "openning": 1}, "loads.x.openning: unknown key, expected 'opening'"),
        ({"kind": "relief valve", "kv": 3, "set_pressure": 1e5}, "loads.x.band: is missing"),
        ({"kind": "demand", "flow": 1, "required_pressure": -1}, "loads.x.required_pressure: too low"),
        ({"kind": "table", "points": [[0, 0], [1, -1]]}, r"loads.x.points\[1\]: the curve falls or stands still"),
        ({"kind": "surge tank"}, "loads.x: its surface is not given once"),
        ({"kind": "air vessel", "gas_volume": 1, "gas_pressure": -2e5}, "loads.x.gas_pressure: below vacuum"),
        (
            {"kind": "vapour cavity", "vapour_pressure": "2 bar"},
            "loads.x.vapour_pressure: too high, expected less than",
        ),
        ({"kind": "air valve", "inlet_diameter": 0.1}, "loads.x.outlet_diameter: is missing"),
        (
            {"kind": "air valve", "inlet_diameter": 0.1, "outlet_diameter": 0.1, "discharge_coefficient": 2},
            "loads.x.discharge_coefficient: ",
        ),
    ],
)
def test_a_load(load, message):
    with pytest.raises(InputError, match=message):
        scene(load)


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ({"kind": "pump", "curve": [[0, 3e5], [0.02, 4e5]]}, "links.x.curve: the rise does not fall with the flow"),
        ({"kind": "pump", "curve": [[0, 3e5], [1, 2.9e5], [2, 1], [3, 1]]}, "links.x.curve: the rise does not fall"),
        ({"kind": "pump", "curve": [[0, 3e5], [0.02, 2e5]], "quadrants": "radial"}, "links.x.curve: is not a rated"),
        ({"kind": "pump", "curve": [[0.02, 3e5]], "quadrants": "axial"}, "links.x.quadrants: "),
        ({"kind": "pump", "curve": [[0.02, 3e5]], "efficiency": 0.8}, "links.x.efficiency: is for curves of four"),
        ({"kind": "pump", "curve": [[0.02, 3e5]], "trip": 1}, "links.x.inertia: is missing"),
        ({"kind": "pump", "curve": [[0.02, 3e5]], "inertia": 1, "rated_speed": 1}, "links.x.trip: is missing"),
        (
            {"kind": "pump", "curve": [[0.02, 3e5]], "inertia": 1, "rated_speed": 1, "start": 1},
            "links.x.motor_torque: is missing",
        ),
        (
            {"kind": "pump", "curve": [[0.02, 3e5]], "inertia": 1, "rated_speed": 1, "start": 1, "trip": 2},
            "links.x.start: is not after the trip",
        ),
        ({"kind": "pump", "curve": [[0.02, 3e5]], "speed": -1}, "links.x.speed: out of range, expected zero or more"),
        ({"kind": "orifice", "kv": 1, "nodes": ["end", "end"]}, "links.x.nodes: both ends are at one node"),
        ({"kind": "orifice", "kv": 1, "nodes": ["end", "tnak"]}, r"nodes\[1\]: nothing else is at this node, .*'tank'"),
        ({"kind": "orifice", "kv": 1, "nodes": ["end"]}, "links.x.nodes: not two nodes"),
        ({"kind": "orifce", "kv": 1}, "links.x.kind: unknown, expected 'orifice'"),
        ({"kv": 1}, "links.x.kind: is missing, expected one of .*'orifice'"),
        ({"kind": "orifice", "kv": 1, "at": "end"}, "links.x.at: unknown key"),
    ],
)
def test_a_link(link, message):
    with pytest.raises(InputError, match=message):
        scene(link=link)


def test_pumps_are_no_cables():
    lines = {"cable": {"nodes": ["a", "b"], "z0": 50, "delay": 1}}
    pump = {"kind": "pump", "nodes": ["a", "b"], "curve": [[0.02, 3e5]]}
    with pytest.raises(InputError, match=re.escape("links.p.kind: not a word of electrical scenes")):
        Scene(medium="electrical", t_end=1, lines=lines, links={"p": pump}, probes={"a": {"at": "a"}})


@pytest.mark.parametrize(
    ("vessel", "problem"),
    [
        ({"kind": "air vessel", "gas_volume": 1, "gas_pressure": 0}, "the pressure is below vacuum"),
        ({"kind": "vapour cavity"}, "the liquid boils"),
        ({"kind": "air valve", "inlet_diameter": 0.1, "outlet_diameter": 0.1}, "it draws air"),
    ],
)
def test_what_has_no_state_at_such_a_pressure_is_named(vessel, problem):
    loads = {"tank": {"at": "tank", "kind": "reservoir", "pressure": -2e5}, "vessel": {"at": "end"} | vessel}
    with pytest.raises(InputError, match=rf"loads\.vessel: no state at rest: {problem}"):
        simulate(Scene(**SOUND | {"loads": loads, "links": {}, "start": "steady"}))


def test_a_flow_that_nothing_takes_has_no_steady_state():
    sources = {"in": {"at": "end", "kind": "flow", "value": 0.01}}
    loads = {"flap": {"at": "tank", "kind": "check valve", "kv": 10, "back_pressure": 1e5}}
    loads["shut"] = {"at": "end", "kind": "orifice", "kv": 10, "opening": 0}
    ending = Scene(**SOUND | {"loads": loads, "links": {}, "sources": sources, "start": "steady"})
    simulate(ending)  # through the flap
    shut = {"shut": loads["shut"]}
    with pytest.raises(InputError, match=r"sources\.in: no steady state: nothing takes the flow"):
        simulate(Scene(**SOUND | {"loads": shut, "links": {}, "sources": sources, "start": "steady"}))


def test_a_flow_that_nothing_limits_has_no_steady_state():
    lines = {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}}
    given = {
        "medium": "electrical",
        "t_end": "40 ns",
        "start": "steady",
        "lines": lines,
        "probes": {"far": {"at": "far"}},
    }
    given["loads"] = {"clamp": {"at": "far", "kind": "diode", "saturation": 1e-12}}
    source = {"at": "near", "kind": "voltage", "value": 3.3}
    with pytest.raises(InputError, match=r"loads\.clamp: no steady state: nothing limits the flow"):
        simulate(Scene(**given, sources={"s": source}))
    simulate(Scene(**given, sources={"s": source | {"resistance": 1e-3}}))


def test_linear_methods_refuse_a_valve_by_name():
    from tline.frequency.response import respond
    from tline.study.baseline import BASELINES
    from tline.study.reference.network import ReferenceNetwork

    sources = {"s": {"at": "end", "kind": "flow", "value": 1}}
    valve = scene(sources=sources)
    for method in (lambda: respond(valve, 1.0), lambda: ReferenceNetwork(valve)):
        with pytest.raises(InputError, match=r"loads\.v: is non-linear, expected a linear scene"):
            method()
    assert all(
        "loads.v: baseline methods know linear elements only" in baseline.incompatibility(valve)
        for baseline in BASELINES.values()
    )


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        (
            {"lines": {"friction": {"kind": "darcy", "fact": 0.02}}},
            "lines.p.friction.fact: unknown key, expected 'factor'",
        ),
        (
            {"lines": {"friction": {"kind": "darcy", "factor": 0.02, "foo": 1}}},
            "lines.p.friction.foo: unknown key, expected one of "
            "'kind', 'resistance', 'viscosity', 'minor_loss', 'length', 'unsteady', 'factor'",
        ),
        (
            {"loads": {"kind": "orifice", "kv": 3, "opening": {"shape": "step", "from": 0, "to": 1, "foo": 1}}},
            "loads.p.opening.step.foo: unknown key, expected one of 'shape', 'from', 'to', 'at'",
        ),
    ],
)
def test_an_unknown_key_lists_those_of_its_own_table(tables, said):
    line = {"nodes": ["a", "b"], "length": 100, "diameter": 0.1, "wave_speed": 1000, "density": 1000}
    loads = {"p": {"at": "b"} | tables.get("loads", {"kind": "closed"})}
    with pytest.raises(InputError) as caught:
        Scene(medium="hydraulic", t_end=1, lines={"p": line | tables.get("lines", {})}, loads=loads, probes={})
    assert str(caught.value).startswith(said)
