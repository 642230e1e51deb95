"""SPICE netlists: numbers, cards, subcircuits, what becomes of each element, and each refusal by line and name."""

import numpy as np
import pytest

from tline import InputError, Scene
from tline.interchange import read_spice, spice_text
from tline.interchange.spice_expression import number, parse_value

CABLE = ["a cable", "V1 s 0 1", "R1 s a 25", "T1 a 0 b 0 Z0=50 TD=1n", "R2 b 0 100", ".tran 1p 9n uic", ".end"]


@pytest.fixture
def read(folder):
    """Read a netlist given as its lines."""

    def from_lines(*lines: str) -> Scene:
        (folder / "c.cir").write_text("\n".join(lines), encoding="utf-8")
        return read_spice("c.cir")[0]

    return from_lines


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.1n", 1.1e-9), ("3MEG", 3e6), ("3M", 3e-3), ("10pF", 1e-11), ("1F", 1e-15), ("-2.5kOhm", -2500.0),
        ("1e3", 1e3), ("1e3k", 1e6), (".5u", 5e-7), ("4µs", 4e-6), ("2.", 2.0), ("10mil", 2.54e-4), ("7T", 7e12),
        ("5V", 5.0), ("abc", None), ("1 n", None), ("", None), ("1e99999", None), ("0x10", None),
    ],
)  # fmt: skip
def test_numbers(text, value):
    assert number(text) == (pytest.approx(value, rel=1e-15) if value is not None else None)


def test_values_know_parameters_and_expressions():
    known = {"z": 50.0, "s": 3.0}
    assert parse_value("Z", known, "") == 50.0
    assert parse_value("{(z + 1k)/2 - s^2}", known, "") == 516.0
    assert parse_value("'-z*1e-3'", known, "") == -0.05
    assert parse_value("'2*max(z, 3) + sqrt(4)**3 - pow(2, 3)'", known, "") == 100.0
    for text in (
        "{y}",
        "{1/0}",
        "{sqrt(-4)}",
        "{open(1)}",
        "{z +}",
        "z0",
        "1e400",
        "{}",
        "{" + 99 * "(" + "1}",
        "{1 2}",
    ):
        with pytest.raises(InputError, match=r"^here: "):
            parse_value(text, known, "here")


def test_subcircuits_open_with_their_parameters(read):
    scene = read(
        "nested", ".param z=60", "T1 a 0 b 0 Z0={z/2} TD=1n", "X1 b load r={2*z}", "X2 a load",
        ".subckt load in params: r=5 c=1p", ".param l={r*1n}", "R1 in m {r}", "X1 m tail c={3*c}", "L1 m 0 {l}",
        ".ends",
        ".subckt tail p c=7p", "C1 p GND {c}", ".ends tail", ".tran 1p 9n",
    )  # fmt: skip
    assert {name: link.table() for name, link in scene.links.items()} == {
        "X1.R1": {"kind": "resistor", "nodes": ("b", "X1.m"), "resistance": 120.0},
        "X2.R1": {"kind": "resistor", "nodes": ("a", "X2.m"), "resistance": 5.0},
    }  # fmt: skip
    assert {name: load.table() for name, load in scene.loads.items()} == {
        "X1.X1.C1": {"kind": "capacitor", "at": "X1.m", "capacitance": pytest.approx(3e-12, rel=1e-15)},
        "X2.X1.C1": {"kind": "capacitor", "at": "X2.m", "capacitance": pytest.approx(3e-12, rel=1e-15)},
        "X1.L1": {"kind": "inductor", "at": "X1.m", "inductance": pytest.approx(120e-9, rel=1e-15)},
        "X2.L1": {"kind": "inductor", "at": "X2.m", "inductance": pytest.approx(5e-9, rel=1e-15)},
    }  # fmt: skip
    assert scene.lines["T1"].parameters.z0 == 30.0
    assert scene.start == "rest"  # which is the steady state without sources


def test_continuation_comments_and_case(read):
    scene = read(
        "* T", "v1 S 0 pulse (0 1", "* between", "+ 1n, 0.1n ; rise", "+ 0.2n 3n 9n)", "r1 s A 25 $ generator",
        "", "t1 a 0 B 0 z0 = 50 f=1g nl=0.5", "C1 b 0 4P", ".TRAN 10p 40n 0 1p UIC", ".Print TRAN V(b)", ".END",
    )  # fmt: skip
    assert scene.title == "T"
    assert scene.lines["t1"].parameters.delay == 0.5e-9
    assert scene.lines["t1"].nodes == ("A", "B")
    value = scene.sources["v1"].table()["value"]
    assert value == {
        "shape": "pulses", "low": 0.0, "high": 1.0, "at": 1e-9, "rise": 1e-10, "fall": 2e-10, "width": 3e-9,
        "period": 9e-9,
    }  # fmt: skip
    assert {name: probe.at for name, probe in scene.probes.items()} == {"B": "B"}


def test_probes_are_all_ends_if_none_is_asked_for(read):
    scene = read(*CABLE[:4], "T2 b 0 c 0 Z0=75 TD=2n", *CABLE[4:])
    assert {name: probe.line for name, probe in scene.probes.items()} == {"a": "T1", "b": "T1", "c": "T2"}


def after(begin, tau):
    return lambda t: 1 - np.exp(-np.maximum(t - begin, 0) / tau)


SPICE = {  # shape: its value by the formulas of the manual, TSTEP = 1e-10, TSTOP = 2e-8
    "PULSE(1 3 2n 1n 2n 4n 10n)": lambda t: np.interp(
        t, [2e-9, 3e-9, 7e-9, 9e-9, 12e-9, 13e-9, 17e-9, 19e-9], [1, 3, 3, 1, 1, 3, 3, 1]
    ),
    "PULSE(0 1 1n 0 0 4n)": lambda t: np.interp(t, [1e-9, 1.1e-9, 5.1e-9, 5.2e-9], [0, 1, 1, 0]),
    "PULSE(0 1)": lambda t: np.interp(t, [0, 1e-10], [0, 1]),
    "PWL(0 0 1n 2 3n -1)": lambda t: np.interp(t, [0, 1e-9, 3e-9], [0, 2, -1]),
    "SIN(1 2 0.2G 3n 0 30)": lambda t: 1 + 2 * np.sin(4e8 * np.pi * np.maximum(t - 3e-9, 0) + np.pi / 6),
    "SIN(0 1)": lambda t: np.sin(2 * np.pi * t / 2e-8),
    "EXP(1 4 2n 3n 50n 1n)": lambda t: 1 + 3 * after(2e-9, 3e-9)(t),
    "EXP(1 4 2n 3n 5n 1n)": lambda t: 1 + 3 * after(2e-9, 3e-9)(t) - 3 * after(5e-9, 1e-9)(t),
    "EXP(0 4 2n 1n 2n 3n)": lambda t: 4 * after(2e-9, 1e-9)(t) - 4 * after(2e-9, 3e-9)(t),
    "PWL(0 0 1n 0 +1n 2 +.5n 0)": lambda t: np.interp(t, [0, 1e-9, 2e-9, 2.5e-9], [0, 0, 2, 0]),
    "DC 5 PWL(0 1 1n 2)": lambda t: np.interp(t, [0, 1e-9], [1, 2]),
    "DC 5": lambda t: 5 + 0 * t,
    "SINE(1 2 0.2G 3n 50Meg 30)": lambda t: (
        1 + 2 * np.exp(-5e7 * np.maximum(t - 3e-9, 0)) * np.sin(4e8 * np.pi * np.maximum(t - 3e-9, 0) + np.pi / 6)
    ),
    "SIN(1 2 0.2G 3n 0 0 2)": lambda t: 1 + 2 * np.sin(4e8 * np.pi * np.clip(t - 3e-9, 0, 1e-8)),
    "SFFM(1 2 0.3G 1.5 50Meg)": lambda t: 1 + 2 * np.sin(6e8 * np.pi * t + 1.5 * np.sin(1e8 * np.pi * t)),
    "AM(2 0.5 50Meg 0.3G 1n)": lambda t: (
        2 * (0.5 + np.sin(1e8 * np.pi * (t - 1e-9))) * np.sin(6e8 * np.pi * (t - 1e-9)) * (t > 1e-9)
    ),
    "PWL(0 0 1n 2 3n 0) R TD=1n": lambda t: np.interp((t - 1e-9) % 3e-9, [0, 1e-9, 3e-9], [0, 2, 0]) * (t > 1e-9),
    "PULSE(0 1 1n 1n 1n 1n 4n 2)": lambda t: np.interp(t, np.r_[1:5, 5:9] * 1e-9, [0, 1, 1, 0] * 2),
    "pulse iv=1 pv=3 delay=2n rise=1n fall=2n width=4n": lambda t: np.interp(t, [2e-9, 3e-9, 7e-9, 9e-9], [1, 3, 3, 1]),
    "-3m": lambda t: -3e-3 + 0 * t,
}


@pytest.mark.parametrize("text", SPICE)
@pytest.mark.parametrize(
    ("letter", "nodes", "sign"), [("V", "s 0", 1), ("V", "0 s", -1), ("I", "b 0", -1), ("I", "0 b", 1)]
)
def test_waveforms_are_those_of_the_manual(read, text, letter, nodes, sign):
    scene = read(
        "x", "T1 a 0 b 0 Z0=50 TD=1n", f"{letter}9 {nodes} {text}", *["R1 s a 25"] * (letter == "V"), ".tran 0.1n 20n"
    )
    t = np.linspace(1e-12, 2e-8, 777)  # no corner among them
    seen = sum(source.value.value(t, t) for source in scene.sources.values())
    assert np.abs(seen - sign * SPICE[text](t)).max() < 1e-9
    if letter == "V":
        assert [source.resistance for source in scene.sources.values()].count(25.0) == 1
        assert {node for source in scene.sources.values() for node in source.terminals} >= {"a", None}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ((4, "J1 a b c fet"), "c.cir, line 5, J1: a transistor, and there are none here, expected in its place"),
        ((4, "B1 b 0 V={v(a)^2}"), "c.cir, line 5, B1: not a sum of voltages and currents with constant factors"),
        ((4, "B1 b 0 R=5"), "c.cir, line 5, B1: a behavioural source without a law, expected V=… or I=…"),
        ((4, "E1 b 0 a 0 LAPLACE {1/s}"), "c.cir, line 5, E1: is not a gain alone"),
        ((4, "E1 b 0 LAPLACE {v(a)} {1/s}"), "c.cir, line 5, E1: LAPLACE is not known here"),
        ((4, "R9 b 0 rho\n.model rho c(c=1p)"), "c.cir, line 6, .model: not known here, expected R or RES"),
        ((4, "R9 b 0 rho\n.model rho r(rsh=1)"), "c.cir, line 5, R9: has no value, nor a length"),
        ((4, "C9 b 0 1p M=0"), "c.cir, line 5, C9: M and SCALE are not above zero"),
        ((4, "L9 b 0 1n Rpar=-1"), "c.cir, line 5, L9: a parasitic value below zero"),
        ((4, "O1 a 0 b 0 lossy"), "c.cir, line 5, O1: its model is not there"),
        ((4, "W1 a 0 b 0 lossy"), "c.cir, line 5, W1: a switch that a current commands"),
        ((4, "Q1 b 0 d"), "c.cir, line 5, Q1: a transistor, and there are none here"),
        ((4, ".include x.lib"), "c.cir, line 5, .include: 'x.lib' cannot be read"),
        ((4, ".ic v(a)=1"), "c.cir, line 5, .ic: a voltage on a line at t = 0, expected v(a)=0, or no .ic"),
        ((4, "r1 b 0 1"), "c.cir, line 5, r1: named twice"),
        ((4, "R2 b 0"), "c.cir, line 5, R2: is not whole"),
        ((4, "R2 b 0 rx"), "c.cir, line 5, R2: not a value, expected a number as 4.7n"),
        ((4, "V2 s 0 1"), "c.cir, line 5, V2: node 's' is already held by sources.V1"),
        ((4, "V2 b 0 PAT(0 1)"), "c.cir, line 5, V2: not a value"),
        ((4, "V2 b 0 SIN(0 1 1G 0 -5)"), "c.cir, line 5, V2: a sine that grows"),
        ((4, "V2 b 0 AM(1 0 2G 1G)"), "c.cir, line 5, V2: a signal not below its carrier"),
        ((4, "V2 b 0 PWL(0 0 1n 1) R=0.5n"), "c.cir, line 5, V2: points that are not repeated from one of them on"),
        ((4, "YTRANSLINE l1 b c m LEN=1 LUMPS=9"), "c.cir, line 5, YTRANSLINE: its model is not there"),
        ((4, "YTRANSLINE l1 b c m LUMPS=0\n.model m X"), "c.cir, line 5, YTRANSLINE: too few sections"),
        ((4, "T2 b 0 c 0 m\n.model m R"), "c.cir, line 6, .model: not known here, expected TRN"),
        ((4, "V2 b 0 portnum 1 z0 50 power 3"), "c.cir, line 5, V2: not a port"),
        ((4, "U1 b 0 c 0 m L=1"), "c.cir, line 5, U1: not a uniform RC line, expected two nodes, base and a URC model"),
        ((4, "V2 b 0 PWL(0 1 2n)"), "c.cir, line 5, V2: PWL with 3 numbers"),
        ((4, "V2 b 0 PULSE(1)"), "c.cir, line 5, V2: PULSE with 1 numbers"),
        ((4, "V2 b 0 DC"), "c.cir, line 5, V2: DC without a level"),
        ((3, "T1 a 0 b 0 Z0=50"), "c.cir, line 4, T1: its z0 and delay are not given once"),
        ((3, "T1 a 0 b 0 Z0=50 TD=1n IC=0 1"), "c.cir, line 4, T1: a begin that is not zero"),
        ((3, "T1 a 0 b 0 Z0=50 TD=1n LEN=0"), "c.cir, line 4, T1: not a list of what a lossless line has"),
        ((3, "T1 a 0 b 0 Z0=50 F=0"), "c.cir, line 4, T1: its frequency is not above zero"),
        ((3, "T1 a 0 b 0 Z0=-50 TD=1n"), "c.cir, line 4, T1: z0: z0 out of range"),
        ((4, "X1 b 0 load"), "c.cir, line 5, X1: no such subcircuit"),
        ((5, ".tran 1p 9n uic\n.subckt load a"), "c.cir, line 7, .subckt: never ends"),
        ((4, ".ends"), "c.cir, line 5, .ends: ends no subcircuit"),
        ((4, ".save v(x)"), "c.cir, line 5, .save: no such node, expected one of 'a', 'b', 's', got 'x'"),
        ((5, "* no end time"), "c.cir: the end time is not given, expected .tran STEP END"),
        ((5, ".tran"), "c.cir, line 6, .tran: not a time step and an end"),
        ((5, ".tran 1p -9n"), "c.cir, line 6, .tran: a time that is not above zero"),
        ((1, "+ 5"), "c.cir, line 2: continues nothing"),
    ],
)  # fmt: skip
def test_what_no_scene_has_is_refused_by_line_and_name(read, change, sentence):
    lines = list(CABLE)
    lines[change[0]] = change[1]
    with pytest.raises(InputError) as found:
        read(*lines)
    assert str(found.value).startswith(sentence)
    assert "\n" not in str(found.value)


FOUR = [*CABLE[:4], "L1 b 0 10n", "L2 0 c 40n", "T2 c 0 d 0 Z0=75 TD=1n"]
TRACE = ".model trace W MODELTYPE=RLGC N=1 Lo=300n Co=120p"


@pytest.mark.parametrize(
    ("card", "name", "link"),
    [
        ("K1 l1 L2 0.5", "K1", {"kind": "coupled inductors", "inductance": (1e-8, 4e-8), "coupling": -0.5}),
        ("E1 c 0 b 0 3", "E1", {"kind": "controlled source", "gain": 3.0, "resistance": 0.0}),
        ("E1 c 0 0 b 3", "E1", {"kind": "controlled source", "gain": -3.0, "resistance": 0.0}),
        ("G1 c 0 b 0 20m", "G1", {"kind": "controlled source", "transconductance": 0.02}),
        ("X1 b c two\n.subckt two p q\nG1 0 q p 0 20m\n.ends", "X1.G1",
         {"kind": "controlled source", "transconductance": -0.02}),
        ("X1 b c two\n.subckt two p q\nL1 p 0 1n\nL2 q 0 4n\nK1 L2 L1 -0.3\n.ends", "X1.K1",
         {"kind": "coupled inductors", "nodes": ("c", "b"), "inductance": (4e-9, 1e-9), "coupling": -0.3}),
    ],
)  # fmt: skip
def test_multiports_become_links(read, card, name, link):
    scene = read(*FOUR, card, ".tran 1p 9n uic")
    assert scene.links[name].table() == {"nodes": ("b", "c")} | link
    assert ("L1" in scene.loads) == (name != "K1")


def test_a_conductance_that_commands_itself_is_a_resistor(read):
    assert read(*CABLE[:4], "G1 0 b 0 b 10m", CABLE[5]).loads["G1"].resistance == 100


def test_a_source_that_commands_stands_beside_its_own_resistor(read):
    scene = read(*FOUR, "E1 c 0 s 0 3", ".tran 1p 9n uic")
    assert {name: (source.at, source.resistance) for name, source in scene.sources.items()} == {
        "V1": ("s", None),
    }  # fmt: skip
    assert (scene.links["R1"].nodes, scene.links["R1"].resistance) == (("s", "a"), 25.0)
    scene = read("x", "V1 a 0 1", "T1 c 0 a 0 Z0=50 TD=1n", "R1 a b 25", "T2 b 0 d 0 Z0=50 TD=1n", CABLE[5])
    assert {name: (source.at, source.resistance) for name, source in scene.sources.items()} == {
        "V1": ("a", None),
    }  # fmt: skip
    assert scene.links["R1"].nodes == ("a", "b")


def test_models_of_subcircuits_are_their_own(read):
    inside = [".subckt trace p q len=0.1", ".model m W MODELTYPE=RLGC N=1 L0=300n C0={c}", "+ Rs=1m"]
    inside += ["W1 p 0 q 0 N=1 L={len} RLGCMODEL=m DELAYOPT=3 FGD=1g", "O1 p 0 q 0 lossy", ".ends"]
    scene = read(*CABLE[:4], ".param c=120p", "X1 b c trace len=0.2", LTRA, *inside, CABLE[5])
    assert scene.lines["X1.W1"].table() == {
        "nodes": ("b", "c"), "inductance": 3e-7, "capacitance": 1.2e-10, "length": 0.2,
        "skin": {"resistance": pytest.approx(1e-3 * 1e9**0.5, rel=1e-15), "frequency": 1e9, "added": True},
    }  # fmt: skip
    assert scene.lines["X1.O1"].nodes == ("b", "c")


def test_conductors_of_a_w_element_are_coupled(read):
    """The even mode of two conductors alike has R11 + R12 and Rs11 + Rs12, the odd one the differences."""
    model = ".model m W MODELTYPE=RLGC N=2 Lo=3e-7 1e-7 3e-7 Co=100p -20p 100p Ro=8 1 8 Go=0 0 0 Rs=4m 1m 4m"
    line = read(*CABLE[:4], "W1 N=2 b c 0 d e 0 L=0.2 RLGCMODEL=m", model, CABLE[5]).lines["W1"]
    assert (line.nodes1, line.nodes2) == (("b", "c"), ("d", "e"))
    assert (line.inductance, line.capacitance) == ([[3e-7, 1e-7], [1e-7, 3e-7]], [[1e-10, -2e-11], [-2e-11, 1e-10]])
    modes = sorted(line.lines, key=lambda mode: mode["z0"])
    assert [mode["resistance"] for mode in modes] == pytest.approx([7, 9], rel=1e-12)
    high = [mode["skin"]["resistance"] for mode in modes]
    assert high == pytest.approx([3e-3 * 1e9**0.5, 5e-3 * 1e9**0.5], rel=1e-12)
    assert all(mode["skin"]["added"] for mode in modes)


@pytest.mark.parametrize(
    ("cards", "sentence"),
    [
        ("K1 L1 L3 0.5", "K1: no such inductor, expected the names of L, got 'l3'"),
        ("K1 L1 R1 0.5", "K1: no such inductor"),
        ("K1 L1 0.5", "K1: couples other than inductors"),
        ("K1 L1 L2 0.5\nK2 L1 L2 0.5", "K2: couples what is coupled already"),
        ("L5 d 0 1n\nK1 L1 L2 0.9\nK2 L2 L5 0.9\nK3 L1 L5 -0.9", "K1: couplings that no windings have together"),
        ("E1 d 0 b 0 POLY(1) 3", "E1: is not a gain alone, expected two nodes, what commands it, and a number"),
        ("E1 d 0 d 0 3", "E1: its own voltage commands it"),
        ("G1 d 0 d 0 -3", "G1: its own voltage commands it"),
        ("G1 d 0 b 0 0", "G1: its gain is zero"),
        ("G1 d 0 d 0 5e-324", "G1: its gain is zero"),
        ("W1 d 0 e 0 N=1 L=1 RLGCMODEL=none", "W1: its model is not there"),
        ("W1 d 0 e 0 N=1 L=1 RLGCFILE=x", "W1: 'x' cannot be read"),
        ("W1 d 0 e 0 N=1 L=1 TABLEMODEL=x", "W1: a table over frequency, expected tabulated"),
        ("K1 L1 L2 1.1", "K1: a coupling that no windings have"),
        ("F1 d 0 V7 3", "F1: no such source, expected the name of a V"),
        ("W1 d 0 e 0 N=1 L=0 RLGCMODEL=trace\n" + TRACE, "W1: its length is not above zero"),
        ("W1 d 0 e 0 N=2 L=1 RLGCMODEL=trace\n" + TRACE, "W1: another number of conductors, expected N=1, got N=2"),
        ("W1 d 0 e 0", "W1: a switch that a current commands"),
        ("W1 N=", "W1: is not whole"),
        (TRACE.replace("Lo=300n", "") + "\nW1 d 0 e 0 N=1 L=1 RLGCMODEL=trace", "W1: its L is not above zero"),
        *((f"{model}\nW1 d 0 e 0 N=1 L=1 RLGCMODEL=trace", f".model: {sentence}") for model, sentence in [
            (TRACE + " Rs=1 2", "its Rs is not a lower triangle, expected 1 values, got 2"),
            (TRACE + " Xo=1", "not a list of what a line has, expected Lo, Co, Ro, Go, Rs and Gd, each once, got 'xo'"),
            (TRACE + " Ro=x", "not a value"),
            (TRACE.replace("N=1", "N=2"), "another number of conductors, expected N=1"),
            (TRACE.replace("=RLGC", "=TABLE"), "not known here, expected .model NAME W MODELTYPE=RLGC"),
        ]),
    ],
)  # fmt: skip
def test_multiports_and_conductors_that_no_scene_has(read, cards, sentence):
    with pytest.raises(InputError) as found:
        read(*FOUR, *cards.splitlines(), ".tran 1p 9n uic")
    assert str(found.value).startswith((f"c.cir, line 8, {sentence}", f"c.cir, line 9, {sentence}"))
    assert "\n" not in str(found.value)


def test_multiports_begin_at_rest_where_that_is_steady(read):
    assert read(*FOUR, "E1 d 0 b 0 3", ".tran 1p 9n").start == "steady"
    quiet = [FOUR[0], "V1 s 0 PULSE(0 1 0 1n 1n 5n)", *FOUR[2:], "E1 d 0 b 0 3", ".tran 1p 9n"]
    assert read(*quiet).start == "rest"  # which is the steady state


def test_subcircuits_that_contain_themselves_end(read, monkeypatch):
    monkeypatch.setattr("tline.interchange.subcircuits.MOST_CARDS", 10_000)
    for inside in ("X1 a me", "X1 a me\nX2 a me"):
        with pytest.raises(InputError, match=r"line \d, X1: subcircuits in subcircuits"):
            read(*CABLE[:4], ".subckt me a", inside, ".ends", "X1 b me", *CABLE[4:])
    doubling = [f".subckt s{k} a\nX1 a s{k + 1}\nX2 a s{k + 1}\n.ends" for k in range(19)]
    with pytest.raises(InputError, match="its subcircuits make the netlist too long"):
        read(*CABLE[:4], *doubling, ".subckt s19 a\nR1 a 0 1\n.ends", "X1 b s0", *CABLE[4:])


LTRA = ".model lossy LTRA(R=20 L=250n C=100p LEN=0.2 rel=1.2 nocontrol)"


def lossy(model: str = LTRA) -> list[str]:
    """The cable with resistance."""
    return [*CABLE[:3], "O1 a 0 b 0 LOSSY", model, *CABLE[4:]]


def test_circuits_too_large_between_lines_are_refused(read, monkeypatch):
    """What hangs together without lines counts, and no other circuit, though all share the reference."""
    monkeypatch.setattr("tline.interchange.netlist.MOST_NODES", 5)
    ladders = [f"{kind}{end}{k} {at} 1" for end in "ab" for k in range(4) for kind, at in (
        ("R", f"{end}{k or ''} {end}{k + 1}"), ("C", f"{end}{k + 1} 0"))]  # fmt: skip
    assert len(read(*CABLE[:-2], *ladders, *CABLE[-2:]).links) == 8
    with pytest.raises(InputError, match=r"^c\.cir: a circuit of too many nodes between lines, .* 5, got 6$"):
        read(*CABLE[:-2], *ladders, "R9 a4 a5 1", "C9 a5 0 1", *CABLE[-2:])


def test_a_line_with_resistance_is_read_and_written(read):
    line = read(*lossy()).lines["O1"]
    assert (line.parameters.z0, line.parameters.delay) == pytest.approx((50, 1e-9), rel=1e-12)
    assert line.losses.constant == (20, 0)
    assert line.losses.exact.length == 0.2
    again = read(*spice_text(read(*lossy())).splitlines()).lines["OO1"]
    assert again.losses == line.losses
    assert read(*lossy(LTRA.replace("R=20", ""))).lines["O1"].losses is None


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (".model d d(is=1n)", "c.cir, line 4, O1: its model is not there"),
        (".model lossy d(is=1n)", "c.cir, line 5, .model: not known here, expected LTRA, got 'd'"),
        (".model lossy", "c.cir, line 5, .model: not known here, expected LTRA"),
        (LTRA.replace("R=20", "TC=1"), "c.cir, line 5, .model: not a list of what a lossy line has"),
        (LTRA.replace("LEN=0.2", ""), "c.cir, line 5, .model: its LEN is not above zero"),
        (LTRA.replace("R=20", "R=-2"), "c.cir, line 5, .model: its R is below zero"),
        (LTRA.replace("R=20", "R"), "c.cir, line 5, .model: not a list of what a lossy line has"),
    ],
)
def test_a_model_that_is_none_of_a_line(read, model, sentence):
    with pytest.raises(InputError) as caught:
        read(*lossy(model))
    assert str(caught.value).startswith(sentence)


@pytest.mark.parametrize(
    ("losses", "sentence"),
    [
        ({"skin": {"resistance": 1, "frequency": 1e9}}, "no element of a netlist has losses that change"),
        ({"resistance": 1, "conductance": 1e-3}, "no element of a netlist has a conductance"),
    ],
)
def test_losses_that_no_netlist_has(losses, sentence):
    line = {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns", "length": 0.2} | losses
    scene = Scene(medium="electrical", t_end=1e-8, lines={"l": line}, probes={"p": {"at": "a"}})
    with pytest.raises(InputError, match=f"lines.l: {sentence}"):
        spice_text(scene)


def test_diodes_are_loads_and_links(tmp_path):
    path = tmp_path / "clamp.cir"
    lines = ["clamp", "V1 a 0 1", "T1 a 0 b 0 Z0=50 TD=1n", "T2 c 0 d 0 Z0=50 TD=1n", "D1 b c DX", "D2 0 b DX"]
    path.write_text("\n".join([*lines, ".model DX D(IS=1p N=1.5 RS=0)", ".tran 1p 9n uic"]), encoding="utf-8")
    scene, _ = read_spice(path)
    assert (scene.loads["D2"].at, scene.loads["D2"].reverse, scene.links["D1"].nodes) == ("b", True, ("b", "c"))
    assert scene.links["D1"].law().constants == scene.loads["D2"].law().constants
    assert scene.links["D1"].saturation == 1e-12
    path.write_text("\n".join([*lines, ".model DX D(IS=1p CJO=5p)", ".tran 1p 9n uic"]), encoding="utf-8")
    with pytest.raises(InputError, match=r"line 7, \.model: more than an exponential"):
        read_spice(path)
