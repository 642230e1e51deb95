"""Netlists as they are written, and scenes that have none."""

import pytest

from passivity import RationalFunction
from tline import InputError, Scene
from tline.interchange.netlist_text import as_load, spice_text


def test_loads_are_recognised():
    R, L, C = (RationalFunction.from_expression(text) for text in ("50", "2*s/10^9", "10^12/(3*s)"))
    assert as_load(R + L + C) == {"kind": "series", "resistance": 50.0, "inductance": 2e-9, "capacitance": 3e-12}
    assert as_load(L + C) == {"kind": "series", "inductance": 2e-9, "capacitance": 3e-12}
    assert as_load(C.parallel(L)) == {"kind": "parallel", "inductance": 2e-9, "capacitance": 3e-12}
    assert as_load(C) == {"kind": "series", "capacitance": 3e-12}
    assert as_load(R.parallel(R)) == {"kind": "resistor", "resistance": 25.0}
    assert as_load(R.parallel(C) + L)["kind"] == "impedance"


STEP = {"shape": "step", "to": 1, "at": "1 ns"}


TOGETHER = {"kind": "junction", "nodes": ["a b", "0"], "z0": 50, "scattering": [[0, 1], [1, 0]]}


BURST = {"shape": "sine", "amplitude": 1, "frequency": 1e9, "until": 1}


SOURCE = {"at": "a b", "kind": "voltage", "value": STEP, "resistance": 50}


SCENE = {
    "medium": "electrical", "t_end": "9 ns", "probes": {"p": {"at": "a b"}},
    "lines": {"main line": {"nodes": ["a b", "0"], "z0": 50, "delay": "1 ns"}},
    "sources": {"s": SOURCE},
}  # fmt: skip


def test_names_that_are_no_words_of_a_netlist_are_numbered():
    text = spice_text(Scene(**SCENE), rise=1e-12)
    assert "* node n1 is 'a b'\n* node n2 is '0'\nTmain_line n1 0 n2 0 Z0=50.0 TD=1e-09\n" in text


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({}, "sources.s.value: jumps at 1e-09 s, and SPICE has no jumps, expected a rise time below 8e-09 s, got none"),
        ({"probes": {"p": {"line": "main line", "position": "50 %"}}, "sources": {}}, "probes.p: stands within a line"),
        ({"loads": {"x": {"at": "0", "kind": "switch", "before": 1, "after": 2, "time": 1}}, "sources": {}},
         "loads.x: a switch has no counterpart in a netlist"),
        ({"loads": {"x": {"at": "0", "kind": "impedance", "expression": "-5"}}, "sources": {}},
         "loads.x: its impedance is not R, L and C"),
        ({"loads": {"x": {"at": "0", "kind": "impedance", "expression": "(s+1)/(s+2)"}}, "sources": {}},
         "loads.x: its impedance is not R, L and C"),
        ({"sources": {"s": SOURCE | {"value": BURST}}}, "sources.s.value: no source of SPICE does that"),
        ({"links": {"x": TOGETHER}, "sources": {}}, "links.x: has no admittance matrix, which a netlist needs"),
        ({"links": {"x": {"kind": "table", "nodes": ["a b", "0"], "points": [[0, 0], [1, 1]]}}, "sources": {}},
         "links.x: a table has no"),
    ],
)  # fmt: skip
def test_what_no_netlist_has_is_refused_by_name(parts, sentence):
    with pytest.raises(InputError) as found:
        spice_text(Scene(**SCENE | parts))
    assert str(found.value).startswith(sentence)


def test_what_stands_between_nodes_is_written():
    links = {
        "c": {"kind": "capacitor", "nodes": ["a", "m"], "capacitance": 1e-9},
        "rl": {"kind": "series", "nodes": ["m", "0x"], "resistance": 5, "inductance": 2e-9},
        "t": {"kind": "transformer", "nodes": ["a", "m", "b", "m"], "ratio": 2},
        "e": {"kind": "controlled source", "nodes": ["a", "m", "b", "m"], "gain": 3, "resistance": 7},
        "g": {"kind": "gyrator", "nodes": ["a", "m", "b", "m"], "resistance": 4},
        "k": {"kind": "coupled inductors", "nodes": ["a", "m", "b", "m"], "inductance": [1, 2], "coupling": 0.5},
    }
    sources = {
        "v": {"nodes": ["a", "m"], "kind": "voltage", "value": 1, "resistance": 25},
        "i": {"nodes": ["a", "m"], "kind": "current", "value": 2, "resistance": 30},
    }
    lines = {"l": {"nodes": ["a", "b"], "z0": 50, "delay": 1}}
    loads = {"end": {"at": "0x", "kind": "inductor", "inductance": 3e-9}}
    scene = Scene(
        medium="electrical", t_end=9, probes={"p": {"at": "a"}}, lines=lines, links=links, sources=sources, loads=loads
    )
    cards = spice_text(scene).splitlines()
    assert set(cards) > {
        "Vv Vv.s m DC 1.0", "Rv Vv.s a 25.0", "Ii m a DC 2.0", "Ri a m 30.0", "Lend n4 0 3e-09",
        "Cc a m 1e-09", "Rrl m Lrl.x 5.0", "Lrl Lrl.x n4 2e-09",
        "Et Vt.x m b m 2.0", "Vt a Vt.x DC 0", "Ft m b Vt 2.0",
        "Ee Ee.x m a m 3.0", "Re Ee.x b 7.0", "Gg a m b m 0.25", "Gg_2 b m a m -0.25",
        "Lk a m 1.0", "Lk_2 b m 2.0", "Kk Lk Lk_2 0.5",
    }  # fmt: skip


def test_pipes_have_no_netlist():
    pipe = {
        "medium": "hydraulic",
        "t_end": 1,
        "probes": {"p": {"at": "a"}},
        "lines": {"l": {"nodes": ["a", "b"], "z0": 1, "delay": 1}},
    }
    with pytest.raises(InputError, match="medium: a netlist is electrical"):
        spice_text(Scene(**pipe))
