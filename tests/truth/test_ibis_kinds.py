"""Kinds of IBIS models beside what they are said to be: terminators, ECL, packages by pin, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.scene.ibis.buffer import read_buffer
from tline.shipped import FOLDER

HEAD = "[IBIS Ver] 5.0\n[Component] X\n[Package]\nR_pkg 0\nL_pkg 0\nC_pkg 0\n[Pin] signal model\n1 A M\n2 B M\n"
TERMINATOR = HEAD + "[Model] M\nModel_type Terminator\nC_comp 0 NA NA\n[Voltage Range] 1.2 1.1 1.3\n"
TEXT = (FOLDER / "memory.ibs").read_text(encoding="utf-8")


def seen(folder: Path, text: str, t: np.ndarray, tol: float = 1e-6, **load) -> np.ndarray:
    """Voltage at the pad behind a matched line, into which a source steps from 0 to 1 V at 1 ns."""
    (folder / "a.ibs").write_text(text, encoding="utf-8")
    step = {"shape": "step", "from": 0, "to": 1, "at": 1e-9}
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


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[Rgnd] 0", r"line 14: \[rgnd\] is not above zero"),
        ("[External Model]\nLanguage SPICE", r"line 14: the model is a program of its own, an \[External Model\]"),
        ("Series_switch", "model: of type 'series_switch', it joins two pins, expected one of a single pin"),
    ],
)
def test_what_is_refused(text, said, tmp_path):
    whole = TERMINATOR.replace("Terminator", text) if text.startswith("Series") else f"{TERMINATOR}{text}\n[End]\n"
    (tmp_path / "a.ibs").write_text(whole, encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_buffer(tmp_path / "a.ibs", None, "1", None, "typ")
