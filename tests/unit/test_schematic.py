"""Schematics of LTspice and netlists as they are written: in any orientation, and each refusal."""

import pytest

from passivity import RationalFunction
from tline import InputError, Scene
from tline.interchange import read_spice
from tline.interchange.netlist_text import as_load, spice_text
from tline.scene.file import scene_text

TALL, SHORT, ROUND, ARROW = [(16, 16), (16, 96)], [(16, 0), (16, 64)], [(0, 16), (0, 96)], [(0, 0), (0, 80)]
ENDS = [(-48, -16), (-48, 16), (48, -16), (48, 16)]
PINS = {"res": TALL, "cap": SHORT, "ind": TALL, "diode": SHORT, "voltage": ROUND, "current": ARROW, "tline": ENDS}
PINS |= {"ltline": ENDS, "h": ROUND, "bv": ROUND, "e": [*ROUND, (-48, 32), (-48, 80)]}
TURNED = {  # a pin (x, y) of a symbol at the origin, as a page is rotated clockwise, then looked at in a mirror
    "R0": lambda x, y: (x, y), "R90": lambda x, y: (-y, x), "R180": lambda x, y: (-x, -y), "R270": lambda x, y: (y, -x),
    "M0": lambda x, y: (-x, y), "M90": lambda x, y: (y, x), "M180": lambda x, y: (x, -y), "M270": lambda x, y: (-y, -x),
}  # fmt: skip
CABLE = """Version 4
SHEET 1 880 680
WIRE 112 80 -32 80
WIRE 240 80 192 80
WIRE -32 112 -32 80
WIRE 400 80 336 80
WIRE 464 80 400 80
WIRE 240 112 240 160
WIRE 336 112 336 160
WIRE 464 96 464 80
WIRE 400 96 400 80
FLAG -32 192 0
FLAG 240 160 0
FLAG 336 160 0
FLAG 400 160 0
FLAG 464 176 0
FLAG 400 80 out
SYMBOL voltage -32 96 R0
WINDOW 123 24 44 Left 2
SYMATTR InstName V1
SYMATTR Value PULSE(0 1 0 1n 1n 50n 200n)
SYMBOL res 208 64 R90
WINDOW 0 0 56 VBottom 2
SYMATTR InstName R1
SYMATTR Value 25
SYMBOL tline 288 96 R0
SYMATTR InstName T1
SYMATTR Value Td=5n Z0=50
SYMBOL cap 384 96 R0
SYMATTR InstName C1
SYMATTR Value 10µ
SYMATTR SpiceLine Rser=1
SYMBOL res 480 192 R180
SYMATTR InstName Load
SYMATTR Value {load}
RECTANGLE Normal 500 300 -100 0
TEXT -80 240 Left 2 !.tran 0 100n 0\\n.param load=75
TEXT -80 260 Left 2 ;a cable, or 50 Ω of it
"""
BY_HAND = """cable
V1 N001 0 PULSE(0 1 0 1n 1n 50n 200n)
R1 N002 N001 25
T1 N002 0 out 0 Td=5n Z0=50
C1 out 0 10u Rser=1
R§Load 0 out {load}
.tran 0 100n 0
.param load=75
"""


@pytest.fixture
def read(folder):
    """Read a schematic or a netlist given as text."""

    def from_text(text: str, file: str = "cable.asc", encoding: str = "utf-8") -> tuple[Scene, tuple[str, ...]]:
        (folder / file).write_bytes(text.encode(encoding))
        return read_spice(file)

    return from_text


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16", "utf-16-le"])
def test_a_schematic_is_the_netlist_drawn_in_it(read, encoding):
    drawn, notes = read(CABLE.replace("Ω", "ohm").replace("\n", "\r\n"), encoding=encoding)
    by_hand, _ = read(BY_HAND, "cable.cir")
    assert scene_text(drawn) == scene_text(by_hand)
    assert notes == ()


@pytest.mark.parametrize("orientation", TURNED)
def test_symbols_are_rotated_and_mirrored(read, orientation):
    """Each pin of each symbol has a label of its own where the orientation puts it."""
    elements = {
        "V1": ("voltage", "a 0", "1"), "R1": ("res", "a b", "25"), "T1": ("tline", "b 0 c d", "Z0=50 Td=1n"),
        "O1": ("ltline", "c 0 e 0", "lossy"), "E1": ("e", "f 0 e 0", "2"), "R2": ("res", "f g", "10"),
        "C1": ("cap", "g 0", "1p"), "D1": ("diode", "e 0", "D"), "L1": ("ind", "d 0", "1n"),
        "I1": ("current", "0 e", "1m"), "H1": ("h", "h 0", "V1 5"), "R3": ("res", "h 0", "7"),
    }  # fmt: skip
    drawn, by_hand = ["Version 4"], ["cable"]
    for k, (name, (symbol, nodes, value)) in enumerate(elements.items()):
        at = 1000 * k
        drawn += [f"SYMBOL {symbol} {at} 0 {orientation}", f"SYMATTR InstName {name}", f"SYMATTR Value {value}"]
        for (x, y), node in zip(PINS[symbol], nodes.split(), strict=True):
            turned = TURNED[orientation](x, y)
            drawn.append(f"FLAG {at + turned[0]} {turned[1]} {node}")
        by_hand.append(f"{name} {nodes} {value}")
    commands = [".tran 10n", ".model lossy LTRA(L=250n C=100p R=1 LEN=1)"]
    scene, notes = read("\n".join([*drawn, *(f"TEXT 0 0 Left 2 !{each}" for each in commands)]))
    expected, same = read("\n".join([*by_hand, *commands, ".model D D"]), "cable.cir")
    assert scene_text(scene) == scene_text(expected)
    assert [note.partition(": ")[2] for note in notes] == [note.partition(": ")[2] for note in same]


def test_wires_join_where_an_end_lies_on_another_but_not_where_they_cross(read):
    lines = ["SYMBOL voltage 0 -16 R0", "SYMATTR InstName V1", "SYMATTR Value 1", "FLAG 0 80 0", "WIRE 0 0 400 0"]
    for k, column in enumerate((100, 200)):  # the first wire ends on the long one, the second crosses it
        lines += [f"SYMBOL res {column - 16} {84} R0", f"SYMATTR InstName R{k}", "SYMATTR Value 50"]
        lines += [f"WIRE {column} 100 {column} {-50 * k}", f"FLAG {column} 180 0"]
    lines += ["WIRE 300 100 350 0", "FLAG 300 100 slanted", "SYMBOL res 384 -16 R0", "SYMATTR InstName R2"]
    lines += ["SYMATTR Value 70", "FLAG 400 80 0", "FLAG 400 0 second"]
    lines += ["TEXT 0 0 Left 2 !.tran 1n\\nT1 second 0 far 0 Z0=50 Td=1n"]
    scene, notes = read("\n".join(["Version 4", *lines]))
    assert {name: load.at for name, load in scene.loads.items()} == {"R0": "slanted", "R2": "slanted"}
    assert (scene.sources["V1"].at, scene.lines["T1"].nodes) == ("slanted", ("slanted", "far"))
    assert any("line 12, R1: its pin 1 is joined to nothing" in note for note in notes)


def test_without_a_value_a_symbol_has_that_of_its_library(read):
    line = "Version 4\nSYMBOL tline 48 16 R0\nSYMATTR InstName T1\nFLAG 0 0 a\nFLAG 0 32 0\nFLAG 96 0 b\nFLAG 96 32 0"
    scene, _ = read(line + "\nTEXT 0 0 Left 2 !.tran 1u\\nV1 a 0 1\\nR1 b 0 50")
    assert (scene.lines["T1"].parameters.z0, scene.lines["T1"].delay) == (50.0, 50e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Version 4", "", "cable.asc: not a schematic of LTspice, expected Version 4 in its first line"),
        ("SYMBOL cap", "SYMBOL npn", "cable.asc, line 29: a symbol that is not known here"),
        ("SYMBOL cap 384 96 R0", "SYMBOL cap 384 96 R45", "line 29: 'cap' is not turned so, expected R0, R90"),
        ("SYMBOL cap 384 96 R0", "SYMBOL cap", "line 29: 'cap' is not turned so"),
        ("WIRE 464 96 464 80", "WIRE 464 96 464", "line 10: not coordinates, expected 4 whole numbers"),
        ("WIRE 464 96 464 80", "BUSTAP 464 96 464 80", "line 10: not known here, expected WIRE, FLAG"),
        ("FLAG 400 80 out", "FLAG 400 80 out of", "line 17: its label is not a word of a netlist"),
        ("SYMATTR InstName C1", "", "line 29: its InstName is not a word of a netlist"),
        ("{load}", "{lode}", "line 33, R§Load"),
        (".param load=75", "Q1 out 0 0 npn", "line 37, Q1: a transistor"),
        ("WIRE 464 96 464 80", "WIRE 464 96 464 80\n" * 10_000, "too many wires, labels and symbols"),
    ],
)
def test_refusals_name_the_line_of_the_schematic(read, old, new, message):
    with pytest.raises(InputError) as raised:
        read(CABLE.replace(old, new, 1))
    assert message in str(raised.value)


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
