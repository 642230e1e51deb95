"""Schematics of LTspice: the netlists drawn in them, in any orientation, and each refusal by line."""

import pytest

from tline import InputError, Scene
from tline.interchange import read_spice
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
