"""Mistakes with elements at and between nodes: one sentence each, that names the element and what to do."""

import re

import pytest

from tline import InputError, Scene, SceneError, simulate
from tline.scene.plausible import plausibility_notes

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


LINES = {"one": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}, "two": {"nodes": ["c", "d"], "z0": 50, "delay": 1e-9}}


def circuit_scene(**parts) -> Scene:
    return Scene(**{"medium": "electrical", "t_end": "9 ns", "lines": LINES, "probes": {"p": {"at": "d"}}} | parts)


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ({"kind": "resistor", "resistance": 0}, "links.x.resistance: resistance out of range, expected more than 0"),
        ({"kind": "resistor", "resistance": "inf"}, "links.x.resistance: not a finite number"),
        ({"kind": "inductor", "inductance": -1}, "links.x.inductance: inductance out of range"),
        ({"kind": "capacitor"}, "links.x.capacitance: is missing"),
        ({"kind": "capacitor", "capacitance": "1 nH"}, "links.x.capacitance: "),
        ({"kind": "capacitr", "capacitance": 1}, "links.x.kind: unknown, expected 'capacitor'"),
        ({"kind": "inductor", "inductance": 1, "at": "a"}, "links.x.at: unknown key"),
        ({"kind": "series"}, "links.x: no element given, expected at least one of resistance, inductance"),
        ({"kind": "impedance"}, "links.x: its Z(s) is not given once"),
        ({"kind": "impedance", "expression": "0*s"}, "links.x: its impedance is zero, expected one node in place"),
        ({"kind": "valve", "before": 0, "after": 1, "time": 0}, "links.x.kind: not a word of electrical scenes"),
        ({"kind": "resistor", "resistance": 1, "nodes": ["b", "b"]}, "links.x.nodes: both ends are at one node"),
        ({"kind": "resistor", "resistance": 1, "nodes": ["b", "y"]}, "links.x.nodes[1]: nothing else is at this node"),
        ({"kind": "transformer", "ratio": 2, "nodes": ["a", "b", "c"]}, "links.x.nodes: not the nodes of two ports"),
        ({"kind": "transformer", "ratio": 2, "nodes": ["a", "b", "c", "c"]}, "links.x.nodes: both ends of a port are"),
        ({"kind": "gyrator", "resistance": 2, "nodes": ["a", "b", "c", "y"]}, "links.x.nodes[3]: nothing else is at"),
    ],
)
def test_a_link_of_a_circuit(link, message):
    with pytest.raises(SceneError) as found:
        circuit_scene(links={"x": {"nodes": ["b", "c"]} | link})
    assert str(found.value).startswith(message)


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ({}, 'sources.x.at: is missing, expected a node, or two as nodes = ["plus", "minus"]'),
        ({"at": "a", "nodes": ["a", "b"]}, "sources.x: its place is not given once, expected either at or nodes"),
        ({"nodes": ["a", "a"]}, "sources.x.nodes: both ends are at one node"),
        ({"nodes": ["a"]}, "sources.x.nodes: not two nodes"),
        ({"nodes": ["a", "y"]}, "sources.x.nodes[1]: nothing else is at this node"),
        ({"node": ["a", "b"]}, "sources.x.node: unknown key, expected 'nodes'"),
    ],
)
def test_a_source(source, message):
    with pytest.raises(SceneError) as found:
        circuit_scene(sources={"x": {"kind": "voltage", "value": 1} | source})
    assert str(found.value).startswith(message)


@pytest.mark.parametrize(
    ("probe", "message"),
    [
        ({"at": "m", "line": "one"}, "probes.p.line: does not end at 'm', expected none, got 'one'"),
        ({"at": "m", "position": "50 %"}, "probes.p: its place is not given once"),
        ({"at": "n"}, "probes.p.at: no line or link ends at this node, expected one of 'a', 'b', 'c', 'd', 'm'"),
    ],
)
def test_a_probe(probe, message):
    link = {"kind": "resistor", "resistance": 1}
    with pytest.raises(SceneError) as found:
        circuit_scene(links={"x": link | {"nodes": ["b", "m"]}, "y": link | {"nodes": ["m", "c"]}}, probes={"p": probe})
    assert str(found.value).startswith(message)


V, SHORT, C = {"kind": "voltage", "value": 1}, {"kind": "short"}, {"kind": "capacitor", "capacitance": 1e-9}
CLOSES = {"kind": "switch", "before": "inf", "after": 0, "time": "1 ns"}


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (
            {"sources": {"v": V | {"nodes": ["b", "c"]}, "w": V | {"nodes": ["c", "b"]}}},
            "sources.w: what is between nodes 'c' and 'b' is already held by sources.v",
        ),
        (
            {"sources": {"v": V | {"nodes": ["b", "c"]}, "w": V | {"at": "b"}}, "loads": {"s": SHORT | {"at": "c"}}},
            "loads.s: node 'c' is already held by sources.v",
        ),
        (
            {"sources": {"v": V | {"nodes": ["b", "c"]}}, "links": {"x": C | {"nodes": ["b", "c"]}}},
            "links.x: its impedance vanishes at high frequency: a jump of sources.v drives an infinite flow",
        ),
        (
            {"sources": {"v": V | {"at": "b"}, "w": V | {"at": "c"}}, "links": {"x": C | {"nodes": ["b", "c"]}}},
            "links.x: its impedance vanishes at high frequency: a jump of sources.v drives",
        ),
        (
            {"sources": {"v": V | {"at": "b"}}, "loads": {"x": C | {"at": "b"}}},
            "loads.x: its impedance vanishes at high frequency: a jump of sources.v drives",
        ),
        (
            {"sources": {"v": V | {"nodes": ["b", "c"]}}, "links": {"x": CLOSES | {"nodes": ["c", "b"]}}},
            "links.x: shorts what is between nodes 'c' and 'b', which sources.v holds",
        ),
        (
            {"links": {"c": C | {"nodes": ["b", "c"]}, "x": CLOSES | {"nodes": ["b", "c"]}}},
            "links.x: shorts what is between nodes 'b' and 'c', which links.c holds",
        ),
        (
            {"sources": {"v": V | {"at": "b"}}, "links": {"c": C | {"nodes": ["b", "c"]}},
             "loads": {"x": CLOSES | {"at": "c"}}},
            "loads.x: shorts node 'c', which links.c holds",
        ),
    ],
)  # fmt: skip
def test_what_an_effort_cannot_have_across(parts, message):
    with pytest.raises(SceneError) as found:
        circuit_scene(**parts)
    assert str(found.value).startswith(message)


def test_what_is_only_near_a_held_node_is_fine():
    links = {"c": C | {"nodes": ["b", "c"]}, "x": CLOSES | {"nodes": ["c", "a"]}}
    assert len(circuit_scene(sources={"v": V | {"at": "b"}}, links=links).links) == 2


def test_any_elements_may_stand_beside_each_other():
    diode, coil = {"kind": "diode", "saturation": "1 fA"}, {"kind": "inductor", "inductance": 1}
    at_node = {"up": diode, "down": diode | {"reverse": True}, "c": C, "l": coil, "off": CLOSES | {"after": 9}}
    loads = {name: {"at": "b"} | load for name, load in at_node.items()}
    loads["stub"] = {"at": "inner", "kind": "resistor", "resistance": 1}
    coils = {"kind": "coupled inductors", "inductance": [1, 1], "coupling": 0.5, "nodes": ["b", "inner", "c", "inner"]}
    links = {"coils": coils, "up": {"kind": "resistor", "resistance": 1, "nodes": ["inner", "d"]}}
    assert len(circuit_scene(loads=loads, links=links).loads) == 6


def test_vessels_may_stand_beside_valves():
    vessel = {"kind": "air vessel", "gas_volume": 1, "gas_pressure": 0}
    valve = {"kind": "orifice", "kv": 3}
    tank = {"kind": "surge tank", "tank_area": 3}
    loads = {"valve": valve | {"at": "b"}, "vessel": vessel | {"at": "b"}, "tank": tank | {"at": "shaft"}}
    links = {"throttle": valve | {"nodes": ["b", "shaft"]}}
    assert len(circuit_scene(medium="hydraulic", loads=loads, links=links).laws) == 4


@pytest.mark.parametrize("kind", ["resistor", "inductor", "capacitor", "series", "impedance", "switch", "transformer"])
def test_a_steady_start_knows_links(kind):
    given = {
        "resistor": {"resistance": 1}, "inductor": {"inductance": 1}, "capacitor": {"capacitance": 1},
        "series": {"resistance": 1, "inductance": 1}, "impedance": {"expression": "s + 2"}, "transformer": {"ratio": 2},
        "switch": {"before": 1, "after": 0, "time": 0},
    }  # fmt: skip
    links = {"x": {"kind": kind, "nodes": ["b", "c"]} | given[kind]}
    assert circuit_scene(links=links, start="steady").links["x"].kind == kind


def test_a_switch_between_nodes_that_never_moves_is_told():
    late = {"x": {"kind": "switch", "nodes": ["b", "c"], "before": 1, "after": 2, "time": "1 s"}}
    assert plausibility_notes(circuit_scene(links=late)) == [
        "links.x (1 s): nothing changes there before the run ends at 9e-09 s"
    ]


def test_a_link_and_a_load_may_have_one_name():
    links, loads = {"x": C | {"nodes": ["b", "c"]}}, {"x": C | {"at": "b"}}
    assert circuit_scene(links=links, loads=loads).links["x"].kind == "capacitor"


def test_a_current_source_into_an_inductor_alone():
    scene = {
        "medium": "electrical", "t_end": "40 ns", "probes": {"e": {"at": "e"}},
        "lines": {"l": {"nodes": ["s", "e"], "z0": 50, "delay": "3 ns"}},
        "sources": {"i": {"at": "x", "kind": "current", "value": 1e-3}},
        "links": {"coil": {"kind": "inductor", "nodes": ["x", "s"], "inductance": "100 nH"}},
    }  # fmt: skip
    with pytest.raises(InputError, match=r"links\.coil: it alone takes the flow that a source drives into node 'x'"):
        simulate(Scene(**scene))
