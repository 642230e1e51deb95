"""Netlists in the dialects of several programs: what is skipped with a note, and what is honoured."""

import numpy as np
import pytest

from tline import Scene, SceneError
from tline.interchange.spice import read_spice

CABLE = ["a cable", "V1 s 0 1", "R1 s a 25", "T1 a 0 b 0 Z0=50 TD=1n", "R2 b 0 100"]
RUN = ".tran 1p 9n uic"


@pytest.fixture
def read(folder):
    """Read a netlist given as its lines, beside other files."""

    def from_lines(*lines: str, **files: str) -> tuple[Scene, tuple[str, ...]]:
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
        (folder / "c.cir").write_text("\n".join(lines), encoding="utf-8")
        return read_spice("c.cir")

    return from_lines


@pytest.mark.parametrize(
    ("card", "note"),
    [
        (".options reltol=1e-4 post", "c.cir, line 6, .options: skipped"),
        (".measure tran peak MAX i(R1)", "c.cir, line 6, .measure: skipped: not of voltages of nodes, got 'i(R1)'"),
        (".meas tran x PARAM='a+b'", "c.cir, line 6, .meas: skipped: not known here, got 'PARAM'"),
        (".meas ac x MAX vdb(b)", "c.cir, line 6, .meas: skipped: another analysis"),
        (".meas tran x MAX v(q)", "c.cir, line 6, .meas: skipped: no waves reach that node, got 'q'"),
        (".meas tran x TRIG AT=1n TARG v(b) VAL=1", "c.cir, line 6, .meas: skipped: an interval from an instant"),
        (".step param x 1 2 1", "c.cir, line 6, .step: skipped: make a run for each value"),
        (".backanno", "c.cir, line 6, .backanno: skipped"),
        (".ac dec 10 1 1g", "c.cir, line 6, .ac: skipped: another analysis: tline frequency"),
        (".print tran v(b) i(V1) {v(a)-1}", "c.cir, line 6, .print: voltages of nodes are recorded, and 'i(V1)' is"),
        ("V2 q 0 5", "c.cir, line 6, V2: skipped, for it is connected to no line"),
        ("R9 b b 5", "c.cir, line 6, R9: skipped, for both its ends are at one node"),
        ("C9 s 0 1p", "c.cir, line 6, C9: skipped, for it stands beside an ideal voltage"),
        ("I9 b 0 AC 1 0", "c.cir, line 6, I9: its AC part is skipped"),
        (".end\nfurther text", "c.cir, line 7, further: skipped with all that follows, for it stands behind .end"),
        (".alter\nR2 b 0 50", "c.cir, line 6, .alter: what follows belongs to another run, and is skipped"),
        (".tran 1n 2n", "c.cir, line 6, .tran: skipped, for the first run counts"),
        ("D9 b 0 dd\n.model dd D(bv=10)", "c.cir, line 7, .model: the breakdown at 10 V is left out"),
    ],
)
def test_what_does_no_harm_is_skipped_with_a_note(read, card, note):
    scene, notes = read(CABLE[0], RUN, *CABLE[1:4], card, "R2 b 0 100")
    assert any(each.startswith(note) for each in notes), notes
    assert scene.t_end == 9e-9


@pytest.mark.parametrize(
    ("step", "load", "advice"),
    [
        ("param x list 50 75", "{x}", "tline sweep c.toml --vary 'loads.R2.resistance=50.0, 75.0'"),
        ("param x 50 100 20", "{x}", "tline sweep c.toml --vary loads.R2.resistance=50.0:90.0:3"),
        ("lin R2 50 100 25", "80", "tline sweep c.toml --vary loads.R2.resistance=50.0:100.0:3"),
        ("oct param x 25 100 1", "{x}", "tline sweep c.toml --vary loads.R2.resistance=25.0:100.0:3:log"),
        ("param x 50 100 20", "{2*x}", "make a run for each value"),
        ("param x 50 100 0", "{x}", "make a run for each value"),
    ],
)
def test_a_step_of_one_value_is_told_as_a_sweep(read, step, load, advice):
    _, notes = read(*CABLE[:4], ".param x=100", f"R2 b 0 {load}", f".step {step}", RUN)
    assert notes == (f"c.cir, line 7, .step: skipped: {advice}",)


def test_several_steps_are_told_as_one_sweep_wherever_the_scene_has_their_values(read):
    """Of a line, of a source's resistance, of a waveform, inside a subcircuit; parameters that only .step defines."""
    cards = ["V1 s 0 PULSE(0 {v} 1n 1n 1n)", "R1 s a 25", "T1 a 0 b 0 Z0={z} TD=1n", "X1 b end", ".subckt end p"]
    steps = [".step param z list 50 60", ".step R1 20 30 5", ".step param v 1 2 1", ".step param q 1 2 1"]
    scene, notes = read(CABLE[0], *cards, "R2 p 0 {q}", ".ends", *steps, RUN)
    assert scene.lines["T1"].parameters.z0 == 50
    assert notes == (
        "c.cir, line 9, .step: skipped: tline sweep c.toml --vary 'lines.T1.z0=50.0, 60.0'"
        " --vary sources.V1.resistance=20.0:30.0:3 --vary sources.V1.value.high=1.0:2.0:2"
        " --vary 'loads.\"X1.R2\".resistance=1.0:2.0:2'",
    )


@pytest.mark.parametrize(
    ("card", "measure"),
    [
        ("MAX v(b) from=1n to=5n", {"kind": "maximum", "probe": "b", "start": 1e-9, "stop": 5e-9}),
        ("pp v(b,a)", {"kind": "peak to peak", "probe": "b", "minus": "a"}),
        ("WHEN v(b)=0.5 CROSS=2", {"kind": "crossing", "probe": "b", "level": 0.5, "edge": "any", "count": 2}),
        ("WHEN v(b)=V(a) TD=1n", {"kind": "crossing", "probe": "b", "minus": "a", "level": 0.0, "after": 1e-9}),
        ("FIND v(b) AT 3n", {"kind": "value", "probe": "b", "at": 3e-9}),
        ("FIND v(b) WHEN v(a)={x}", {"kind": "value", "probe": "b", "when": {"probe": "a", "level": 0.5}}),
        ("TRIG v(a) VAL=0.1 RISE=1 TARG v(b) VAL='2*x' FALL=LAST", {
            "kind": "delay", "start": {"probe": "a", "level": 0.1, "edge": "rise", "count": 1},
            "stop": {"probe": "b", "level": 1.0, "edge": "fall", "count": 0},
        }),
        ("TRIG AT=0 TARG v(b)=0.5", {"kind": "crossing", "probe": "b", "level": 0.5}),
    ],
)  # fmt: skip
def test_measures_become_those_of_the_scene(read, card, measure):
    scene, notes = read(*CABLE, ".param x=0.5", ".print v(s)", f".measure tran m {card}", RUN)
    assert notes == ()
    assert scene.table()["measures"]["m"] == measure
    assert {"s", "b"} <= {*scene.probes}


def test_a_measure_that_contradicts_itself_is_told_with_its_line(read):
    with pytest.raises(SceneError, match=r"line 6, .meas: stop: not after the start, expected more than 5e-09 s"):
        read(*CABLE, ".meas tran m AVG v(b) from=5n to=1n", RUN)


def test_all_obstacles_are_told_at_once_with_their_lines(read):
    with pytest.raises(SceneError) as caught:
        read(*CABLE, "Q1 b a 0 n", "M1 a b 0 0 n", "R3 b 0 x", ".wibble", "X1 a none", RUN)
    assert [str(mistake).partition(":")[0] for mistake in caught.value.mistakes] == [
        "c.cir, line 10, X1", "c.cir, line 9, .wibble", "c.cir, line 6, Q1", "c.cir, line 7, M1", "c.cir, line 8, R3",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("run", "end", "start"),
    [
        (".tran 0 100n 0", 1e-7, "steady"), (".tran 100n", 1e-7, "steady"), (".tran 1p 9n 1n 1p UIC", 9e-9, "rest"),
        (".tran 0 100n 5n trace all", 1e-7, "steady"), (".tran 1p 9n noop", 9e-9, "rest"),
    ],
)  # fmt: skip
def test_runs_of_all_dialects(read, run, end, start):
    scene, _ = read(*CABLE, run)
    assert (scene.t_end, scene.start) == (end, start)


def test_a_control_block_gives_the_run_and_the_probes(read):
    scene, notes = read(*CABLE, ".control", "option noinit", "TRAN 1p 9n 0 1p", "plot v(b) v(S)", ".endc", ".end")
    assert (scene.t_end, [*scene.probes]) == (9e-9, ["b", "s"])
    assert len(notes) == 1


def test_pulses_without_a_rise_jump_where_no_step_is_given(read):
    scene, _ = read(*CABLE[:1], "V1 s 0 PULSE(0 1 1n 0 0 3n)", *CABLE[2:], ".tran 0 9n 0")
    value = scene.sources["V1"].value
    assert value.value(np.array(1e-9), np.array(1.1e-9)) == 1.0


def test_values_with_what_changes_nothing(read):
    scene, _ = read(*CABLE[:4], "R2 b 0 R=100 TC=0 tol=5", "C2 b 0 C='2*p' m=1", "L2 b 0 1u Rser=0", ".param p=1p", RUN)
    assert scene.loads["R2"].resistance == 100
    assert scene.loads["C2"].capacitance == 2e-12
    _, notes = read(*CABLE[:4], "R2 b 0 100 TC=1m", RUN)
    assert notes == ("c.cir, line 5, R2: TC is skipped: it is at its nominal temperature",)
    with pytest.raises(SceneError, match=r"line 6, .temp: another temperature beside diodes, or coefficients of it"):
        read(*CABLE[:4], "R2 b 0 100 TC=1m", ".temp 60", RUN)


def test_begins_of_capacitors_and_inductors(read):
    """C in series with its voltage, L beside its current."""
    scene, _ = read(
        *CABLE, "C2 b 0 1p IC=2", "L2 b 0 1u IC=3m", "C3 x 0 1p", "R3 x b 5", "R4 x 0 9", ".ic v(x)=0.5", RUN
    )
    voltage, other = scene.sources["C2.ic"], scene.sources["C3.ic"]
    assert (voltage.nodes, voltage.value.level, scene.loads["C2"].at) == (("b", "C2.ic"), 2.0, "C2.ic")
    assert (other.nodes, other.value.level) == (("x", "C3.ic"), 0.5)
    current = scene.sources["L2.ic"]
    assert (current.terminals, current.value.level) == ((("0", "b")), 0.003)


def test_files_are_included_from_the_folder_alone(read):
    library = ".lib fast\n.param r=10\n.endl\n.lib slow\n.param r=99\n.endl"
    scene, _ = read(*CABLE[:4], "R2 b 0 r", ".lib 'models.txt' slow", '.include "more.txt"', RUN,
                    **{"models.txt": library, "more.txt": "C2 b 0 1p\n.end"})  # fmt: skip
    assert scene.loads["R2"].resistance == 99
    assert "C2" in scene.loads
    for name in ("/etc/passwd", "../x.txt", "c.cir"):
        with pytest.raises(SceneError, match=r"outside of the netlist's folder|files that include each other"):
            read(*CABLE, f".include {name}", RUN)


def test_nodes_across_which_nothing_falls_are_one(read):
    scene, _ = read(*CABLE[:2], "Vm s q 0", "R1 q a 25", "R8 a z 0", "T1 z 0 b 0 Z0=50 TD=1n", "R2 b 0 100", RUN)
    assert (scene.sources["V1"].at, scene.lines["T1"].nodes) == ("a", ("a", "b"))


def test_lines_between_two_nodes_each(read):
    scene, _ = read(*CABLE[:3], "T1 a m b n Z0=50 TD=1n", "R2 b n 100", "R3 m 0 1", "R4 n 0 1", RUN)
    assert scene.links["T1.1"].table() == {
        "kind": "transformer", "nodes": ("a", "m", "T1.1", "0"), "ratio": 1.0,
    }  # fmt: skip
    assert scene.loads["reference"].table() == {"at": "0", "kind": "short"}


def test_lengths_have_the_unit_that_makes_them_possible(read):
    """16 cm with R, L and C per cm: the same line, whatever its length is called."""
    model = ".model m LTRA(R=12.45 L=8.972n C=0.468p LEN=16)"
    scene, notes = read(*CABLE[:3], "O1 a 0 b 0 m", model, CABLE[4], RUN)
    line = scene.lines["O1"]
    assert line.length * line.resistance == pytest.approx(16 * 12.45, rel=1e-12)
    assert line.parameters.delay == pytest.approx(16 * np.sqrt(8.972e-9 * 0.468e-12), rel=1e-12)
    assert notes[0].startswith("c.cir, line 4, O1: its length of 16 is no metres; taken as 0.207 m")


def test_losses_may_mix_the_modes(read):
    model = [".model m CPL R=5 0 5 L=3e-7 1e-7 4e-7 C=1e-10 -2e-11 1e-10 G=0 0 0 length=0.2"]
    scene, _ = read(*CABLE[:3], "P1 a c 0 b d 0 m", *model, CABLE[4], RUN)
    assert scene.lines["P1"].mixing
    assert scene.lines["P1"].resistance == [[5, 0], [0, 5]]


def test_w_elements_by_a_file(read):
    text = "* conductors\n2\n* Lo\n3e-7\n1e-7 3e-7\n* Co\n1e-10\n-2e-11, 1e-10\n"
    scene, _ = read(*CABLE[:3], "W1 a c 0 b d 0 RLGCFILE=w.txt N=2 L=0.2", CABLE[4], RUN, **{"w.txt": text})
    assert scene.lines["W1"].inductance == [[3e-7, 1e-7], [1e-7, 3e-7]]


def test_older_encodings(tmp_path):
    for encoding in ("latin-1", "utf-16"):
        (tmp_path / "c.cir").write_bytes("\n".join([*CABLE[:4], "C2 b 0 1µ", RUN]).encode(encoding))
        assert read_spice(tmp_path / "c.cir")[0].loads["C2"].capacitance == pytest.approx(1e-6)


def test_sources_in_a_row_and_floating(read):
    scene, _ = read(CABLE[0], "VS s m PULSE(0 3 0 1n 1n 8n 20n)", "VD m 0 5V", *CABLE[2:], ".tran 1p 9n")
    assert scene.start == "steady"
    assert (scene.sources["VS"].nodes, scene.sources["VS"].resistance) == (("a", "m"), 25.0)
    assert scene.sources["VD"].at == "m"


def test_the_generator_of_gnucap_makes_pulses(read):
    """The command may stand behind the source, with words cut short; no width is one without an end."""
    deck = [CABLE[0], "V1 s 0 generator(2)", *CABLE[2:], ".gen delay=1n ma=3 rise=0.1n", ".tran 0 9n 0.1n"]
    scene, _ = read(*deck)
    t = np.array([0.5e-9, 1.05e-9, 2e-9, 9e-9])
    np.testing.assert_allclose(scene.sources["V1"].value.value(t, t), [0, 3, 6, 6])
    for wrong in ("freq=1g", "initial=1", "wibble=2"):
        with pytest.raises(SceneError, match=r"generator"):
            read(*deck[:2], f".gen {wrong}", *deck[2:])


def test_a_line_of_no_length_joins_its_ends(read):
    scene, notes = read(*CABLE[:4], "R2 c 0 100", "O1 b 0 c 0 m", ".model m LTRA R=1 L=1n C=1p LEN=0", RUN)
    assert scene.links["O1"].table() == {"nodes": ("b", "c"), "kind": "resistor", "resistance": 1e-9}
    assert notes == ("c.cir, line 6, O1: a line of no length is 1e-09 ohm between its ends",)
