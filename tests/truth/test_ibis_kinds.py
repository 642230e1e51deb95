"""Kinds of IBIS models beside what they are said to be: terminators, ECL, packages by pin, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.frequency.response import respond
from tline.scene.ibis.buffer import read_buffer
from tline.scene.ibis.series import IbisSeries
from tline.shipped import FOLDER

HEAD = "[IBIS Ver] 5.0\n[Component] X\n[Package]\nR_pkg 0\nL_pkg 0\nC_pkg 0\n[Pin] signal model\n1 A M\n2 B M\n"
TERMINATOR = HEAD + "[Model] M\nModel_type Terminator\nC_comp 0 NA NA\n[Voltage Range] 1.2 1.1 1.3\n"
TEXT = (FOLDER / "memory.ibs").read_text(encoding="utf-8")


def seen(folder: Path, text: str, t: np.ndarray, tol: float = 1e-6, high: float = 1, **load) -> np.ndarray:
    """Voltage at the pad behind a matched line, into which a source steps from 0 to 1 V, or others, at 1 ns."""
    (folder / "a.ibs").write_text(text, encoding="utf-8")
    step = {"shape": "step", "from": 0, "to": high, "at": 1e-9}
    scene = Scene(
        str(folder), medium="electrical", t_end=float(t[-1]), start="steady",
        lines={"line": {"nodes": ["near", "pad"], "z0": 50, "delay": "0.5 ns"}}, probes={"pad": {"at": "pad"}},
        sources={"s": {"at": "near", "kind": "voltage", "value": step, "resistance": 50}},
        loads={"u": {"at": "pad", "kind": "ibis", "file": "a.ibs", "package": False} | load},
    )  # fmt: skip
    return simulate(scene, tol=tol).probes["pad"].at(t).u


def test_resistors_of_a_terminator_divide_the_supply(tmp_path):
    """100 and 100 ohm are 0.6 V behind 50 ohm: 0.3 V beside 50 ohm to earth, and half a volt more behind the step."""
    found = seen(tmp_path, TERMINATOR + "[Rgnd] 100 NA NA\n[Rpower] 100 90 110\n", np.array([1e-9, 2e-9, 6e-9]))
    assert found == pytest.approx([0.3, 0.8, 0.8], abs=1e-6)


def test_a_resistor_and_a_capacitor_to_earth_are_matched_at_first(tmp_path):
    """Half a volt, and the rest with 2 R C, whatever the die, which has none."""
    t = np.linspace(1.52e-9, 6e-9, 20)
    found = seen(tmp_path, TERMINATOR + "[Rac] 50\n[Cac] 10pF\n", t)
    assert found == pytest.approx(1 - 0.5 * np.exp(-(t - 1.5e-9) / 1e-9), abs=1e-3)


def test_the_capacitance_of_corners_stands_in_place_of_the_models_own(tmp_path):
    """1 - exp(-t/RC) of 50 ohm and 12 pF at the largest corner."""
    t = np.linspace(1.52e-9, 6e-9, 20)
    found = seen(tmp_path, TERMINATOR + "[C Comp Corner]\nC_comp 10pF 8pF 12pF\n", t, corner="max")
    assert found == pytest.approx(1 - np.exp(-(t - 1.5e-9) / 0.6e-9), abs=1e-3)


def test_tables_of_ecl_count_from_the_upper_supply(tmp_path):
    """The shipped driver, its pull-down written as ECL has it: 1.2 V less the pad's voltage."""
    head, _, rest = TEXT.partition("[Rising Waveform]")[0].partition("[Pulldown]\n")
    rows, _, tail = rest.partition("[Pullup]")
    turned = "\n".join(f"{1.2 - float(row.split()[0]):.3f} {row.split()[1]} NA NA" for row in rows.splitlines())
    ecl = f"{head}[Pulldown]\n{turned}\n[Pullup]{tail}".replace("Model_type I/O", "Model_type I/O_ECL")
    t, sends = np.linspace(0, 3e-9, 30), {"bits": "010", "bit": "1 ns", "model": "DQ", "tol": 1e-4}
    plain = seen(tmp_path, TEXT.partition("[Rising Waveform]")[0] + "[End]\n", t, **sends)
    assert seen(tmp_path, ecl + "[End]\n", t, **sends) == pytest.approx(plain, abs=1e-4)
    assert np.ptp(plain) > 0.2


def test_what_is_not_known_of_the_typical_part_lies_between_the_others(tmp_path):
    """1.3 pF is half way between 1.1 and 1.5 pF; a row of NA alone is no row."""
    (tmp_path / "a.ibs").write_text(
        TEXT.replace("C_comp 1.3e-12", "C_comp NA").replace("[Pullup]\n", "[Pullup]\n-9 NA NA NA\n"), encoding="utf-8"
    )
    found, known = (read_buffer(path, "DQ", None, None, "typ") for path in (tmp_path / "a.ibs", FOLDER / "memory.ibs"))
    assert found.capacitance == pytest.approx(known.capacitance)
    assert found.tables["pullup"].volts == pytest.approx(known.tables["pullup"].volts)


LEADS = "[Number Of Sections] 2\n[Pin Numbers]\n1 Len=0.5 L=8n C=2p R=0.1 / Len=0 L=1n C=0.5p /\n2 Len=1 L=9n /\n"
MATRICES = """[Model Data]
[Resistance Matrix] Banded_matrix
[Bandwidth] 0
[Row] 1
0.05
[Row] 2
0.2
[Inductance Matrix] Full_matrix
[Row] 1
5n 1n
[Row] 2
6n
[Capacitance Matrix] Sparse_matrix
[Row] 1
1 2.25p
2 -0.1p
[Row] 2
2 3p
[End Model Data]
"""


@pytest.mark.parametrize(("own", "package"), [(LEADS, (0.05, 5e-9, 1.5e-12)), (MATRICES, (0.05, 5e-9, 2.25e-12))])
def test_a_package_model_tells_r_l_and_c_of_a_pin(own, package, tmp_path):
    """By sections of 0.5 and none in length, where lumps are as they are; or on diagonals of matrices."""
    text = TERMINATOR.replace("[Package]", "[Package Model] P\n[Package]")
    (tmp_path / "a.ibs").write_text(f"{text}[Rgnd] 50\n[Define Package Model] P\n{own}[End]\n", encoding="utf-8")
    assert read_buffer(tmp_path / "a.ibs", None, "1", None, "typ").package == pytest.approx(package)


SERIES = """[IBIS Ver] 5.0
[Model] S
Model_type Series_switch
C_comp 0
[Voltage Range] 1
[On]
[R Series] 100 90 110
[L Series] 10n
[Rl Series] 25
[C Series] 1p
[Rc Series] 50
[Lc Series] 2n
[Off]
[Series Current]
-1 -10m
0 0
1 10m
[R Series] 100
"""


def through(folder: Path, text: str = SERIES, **link) -> Scene:
    """50 ohm behind a model between pins, after a step of 1 V from 50 ohm."""
    (folder / "s.ibs").write_text(text, encoding="utf-8")
    return Scene(
        str(folder), medium="electrical", t_end=20e-9, start="rest", probes={"out": {"at": "b"}},
        lines={"line": {"nodes": ["near", "a"], "z0": 50, "delay": "1 ns"}},
        sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
        loads={"r": {"at": "b", "kind": "resistor", "resistance": 50}},
        links={"x": {"kind": "ibis", "file": "s.ibs", "nodes": ["a", "b"]} | link},
    )  # fmt: skip


def test_a_switch_that_is_on_is_its_branches_side_by_side(tmp_path):
    """R beside R + sL beside R + sL + 1/(sC), between 50 ohm on both sides, over frequency."""
    s = 2j * np.pi * np.geomspace(1e7, 1e10, 30)
    Z = 1 / (1 / 100 + 1 / (25 + s * 10e-9) + 1 / (50 + s * 2e-9 + 1e12 / s))
    seen = respond(through(tmp_path, on=True), s, "s")["out"].u
    assert seen == pytest.approx(np.exp(-s * 1e-9) * 50 / (Z + 100), rel=1e-9)


def test_a_table_of_current_is_beside_the_rest(tmp_path):
    """100 ohm as a table beside 100 ohm are 50: a third of the volt, after 1 ns; the scene is written as it was."""
    made = through(tmp_path, on=False)
    assert simulate(made, tol=1e-8).probes["out"].at(np.array([0.9e-9, 1.1e-9, 19e-9])).u == pytest.approx(
        [0, 1 / 3, 1 / 3], abs=1e-8
    )
    assert made.table()["links"] == {"x": {"kind": "ibis", "file": "s.ibs", "nodes": ("a", "b"), "on": False}}


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ({}, "links.x.on: is missing, expected true or false"),
        ({"on": True, "model": "T"}, r"links.x.model: no such \[Model\] in the file, expected 'S', got 'T'"),
        ({"on": True, "corner": "fast"}, "links.x.corner: "),
    ],
)
def test_a_link_that_is_no_model_between_pins(link, said, tmp_path):
    with pytest.raises(InputError, match=said):
        through(tmp_path, **link)


BETWEEN = "[IBIS Ver] 5.0\n[Model] S\nModel_type Series\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", r"line 2: nothing is between the pins, expected R, L, C or \[Series Current\]"),
        ("[R Series] 0", r"line 4: \[r series\] is not above zero"),
        ("[L Series] 1n\n[Rl Series] -1", r"line 5: \[rl series\] is below zero"),
        ("[Rl Series] 5", r"line 4: \[Rl Series\] has nothing to be in series with, expected \[L Series\] beside it"),
        ("[R Series] 5\n[Rc Series] 5", r"line 5: \[Rc Series\] .* expected \[C Series\] beside it"),
        ("[R Series] 5\n[Lc Series] 0", r"line 5: \[Lc Series\] .* expected \[C Series\] beside it"),
        (2 * "[Series Current]\n-5 -1\n5 1\n", r"line 7: a second \[Series Current\], expected one"),
    ],
)
def test_elements_between_pins_that_are_refused(text, said, tmp_path):
    with pytest.raises(InputError, match=said):
        through(tmp_path, BETWEEN + text)


def test_no_resistance_in_series_may_be_given_as_0(tmp_path):
    s, text = (
        1j * np.geomspace(1e8, 1e10, 9),
        "[L Series] 10n\n[Rl Series] 0\n[C Series] 1p\n[Rc Series] 0\n[Lc Series] 0",
    )
    Z = 1 / (1 / (s * 10e-9) + s * 1e-12 + 1e-12)
    seen = respond(through(tmp_path, BETWEEN + text), s, "s")["out"].u
    assert seen == pytest.approx(np.exp(-s * 1e-9) * 50 / (Z + 100), rel=1e-9)


def test_a_state_that_is_not_in_the_file_is_open_and_told(tmp_path):
    made = through(tmp_path, SERIES[: SERIES.index("[Off]")], on=False)
    assert isinstance(link := made.composed["links", "x"], IbisSeries)
    assert link.summary.endswith("[Off] is not in the file; nothing is between the pins: open")
    assert abs(respond(made, np.array([1e9j]), "s")["out"].u[0]) < 1e-10


@pytest.mark.parametrize(("mode", "clamped"), [("Non-Driving", True), ("Driving", False), ("All", True)])
def test_a_clamp_of_a_submodel_is_there_in_its_mode(mode, clamped, tmp_path):
    """A receiver's clamp of 25 ohm below 0 V: a step of -1 V is divided by it, or doubled where it is of drivers."""
    clamp = "[Submodel] C\nSubmodel_type Dynamic_clamp\n[GND Clamp]\n-2 -80m\n0 0\n1 0\n"
    text = TERMINATOR.replace("Terminator", "Input") + f"[Add Submodel]\nC {mode}\n{clamp}[End]\n"
    found = seen(tmp_path, text, np.array([1e-9, 6e-9]), high=-1)
    assert found == pytest.approx([0, -1 / 3 if clamped else -1], abs=1e-5)


@pytest.mark.parametrize(
    ("own", "note"),
    [
        ("Submodel_type\n[GND Clamp]", "submodel C changes with the signal and is left out"),
        ("Submodel_type Dynamic_clamp\n[Pullup]", "[Pullup] of a submodel is left out"),
    ],
)
def test_what_is_no_clamp_of_a_submodel_is_left_out_and_told(own, note, tmp_path):
    text = f"{TERMINATOR}[Rgnd] 50\n[Add Submodel]\nC All\n[Submodel] C\n{own}\n-2 -80m\n0 0\n[End]\n"
    (tmp_path / "a.ibs").write_text(text, encoding="utf-8")
    found = read_buffer(tmp_path / "a.ibs", None, "1", None, "typ")
    assert (list(found.tables), found.notes[0]) == (["rgnd"], note)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[Rgnd] 0", r"line 14: \[rgnd\] is not above zero"),
        (
            "[Add Submodel]\nC Drives",
            "line 15: not a mode of a submodel, expected Driving, Non-Driving or All, got 'Drives'",
        ),
        ("[External Model]\nLanguage SPICE", r"line 14: the model is a program of its own, an \[External Model\]"),
        ("Series_switch", "model: of type 'series_switch', it joins two pins, expected a link of kind = 'ibis'"),
    ],
)
def test_what_is_refused(text, said, tmp_path):
    whole = TERMINATOR.replace("Terminator", text) if text.startswith("Series") else f"{TERMINATOR}{text}\n[End]\n"
    (tmp_path / "a.ibs").write_text(whole, encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_buffer(tmp_path / "a.ibs", None, "1", None, "typ")
