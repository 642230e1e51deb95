"""Mistakes with what stands between nodes: one sentence each, that names the element and what to do."""

import pytest

from tline import Scene, SceneError
from tline.scene.plausible import plausibility_notes

LINES = {"one": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}, "two": {"nodes": ["c", "d"], "z0": 50, "delay": 1e-9}}


def scene(**parts) -> Scene:
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
def test_a_link(link, message):
    with pytest.raises(SceneError) as found:
        scene(links={"x": {"nodes": ["b", "c"]} | link})
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
        scene(sources={"x": {"kind": "voltage", "value": 1} | source})
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
        scene(links={"x": link | {"nodes": ["b", "m"]}, "y": link | {"nodes": ["m", "c"]}}, probes={"p": probe})
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
        scene(**parts)
    assert str(found.value).startswith(message)


def test_what_is_only_near_a_held_node_is_fine():
    links = {"c": C | {"nodes": ["b", "c"]}, "x": CLOSES | {"nodes": ["c", "a"]}}
    assert len(scene(sources={"v": V | {"at": "b"}}, links=links).links) == 2


def test_any_elements_may_stand_beside_each_other():
    diode, coil = {"kind": "diode", "saturation": "1 fA"}, {"kind": "inductor", "inductance": 1}
    at_node = {"up": diode, "down": diode | {"reverse": True}, "c": C, "l": coil, "off": CLOSES | {"after": 9}}
    loads = {name: {"at": "b"} | load for name, load in at_node.items()}
    loads["stub"] = {"at": "inner", "kind": "resistor", "resistance": 1}
    coils = {"kind": "coupled inductors", "inductance": [1, 1], "coupling": 0.5, "nodes": ["b", "inner", "c", "inner"]}
    links = {"coils": coils, "up": {"kind": "resistor", "resistance": 1, "nodes": ["inner", "d"]}}
    assert len(scene(loads=loads, links=links).loads) == 6


def test_vessels_may_stand_beside_valves():
    vessel = {"kind": "air vessel", "gas_volume": 1, "gas_pressure": 0}
    valve = {"kind": "orifice", "kv": 3}
    tank = {"kind": "surge tank", "tank_area": 3}
    loads = {"valve": valve | {"at": "b"}, "vessel": vessel | {"at": "b"}, "tank": tank | {"at": "shaft"}}
    links = {"throttle": valve | {"nodes": ["b", "shaft"]}}
    assert len(scene(medium="hydraulic", loads=loads, links=links).laws) == 4


@pytest.mark.parametrize("kind", ["resistor", "inductor", "capacitor", "series", "impedance", "switch", "transformer"])
def test_a_steady_start_knows_links(kind):
    given = {
        "resistor": {"resistance": 1}, "inductor": {"inductance": 1}, "capacitor": {"capacitance": 1},
        "series": {"resistance": 1, "inductance": 1}, "impedance": {"expression": "s + 2"}, "transformer": {"ratio": 2},
        "switch": {"before": 1, "after": 0, "time": 0},
    }  # fmt: skip
    links = {"x": {"kind": kind, "nodes": ["b", "c"]} | given[kind]}
    assert scene(links=links, start="steady").links["x"].kind == kind


def test_a_switch_between_nodes_that_never_moves_is_told():
    late = {"x": {"kind": "switch", "nodes": ["b", "c"], "before": 1, "after": 2, "time": "1 s"}}
    assert plausibility_notes(scene(links=late)) == [
        "links.x (1 s): nothing changes there before the run ends at 9e-09 s"
    ]


def test_a_link_and_a_load_may_have_one_name():
    links, loads = {"x": C | {"nodes": ["b", "c"]}}, {"x": C | {"at": "b"}}
    assert scene(links=links, loads=loads).links["x"].kind == "capacitor"
