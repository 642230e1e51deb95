"""Cables by tables, against the laws that the tables were made of."""

import numpy as np
import pytest

from tline import Scene, SceneError
from tline.frequency import respond, scattering_parameters
from tline.loss import ConstantLoss, DielectricLoss, LossyLine, RoundWire
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study import lossy_response

SERIES = RoundWire(0.1e-3, 5.8e7) + ConstantLoss(0, 250e-9)
SHUNT = ConstantLoss(1e-3) + DielectricLoss(100e-12, 0.02, 1e8, (1e5, 1e11))
F = np.geomspace(1e4, 1e10, 61)
LENGTH, SOURCE, LOAD = 0.2, 25.0, 75.0


def columns(law) -> list[np.ndarray]:
    values = law.at(2j * np.pi * F)
    return [values.real, values.imag / (2 * np.pi * F)]


def scene(folder, table: list[np.ndarray], tolerance: float = 1e-3, **line) -> Scene:
    np.savetxt(folder / "cable.csv", np.column_stack(table), fmt="%.17g", delimiter=",", header="f, R, L", comments="")
    line = {
        "nodes": ["near", "far"],
        "length": LENGTH,
        "tabulated": {"file": "cable.csv", "tolerance": tolerance},
    } | line
    return Scene(
        str(folder), medium="electrical", t_end="10 ns", lines={"line": line},
        sources={"s": {"at": "near", "kind": "voltage", "value": {"shape": "step", "to": 1}, "resistance": SOURCE}},
        loads={"r": {"at": "far", "kind": "resistor", "resistance": LOAD}}, probes={"far": {"at": "far"}},
    )  # fmt: skip


def test_transfer_functions_between_the_rows(tmp_path):
    made = scene(tmp_path, [F, *columns(SERIES), *columns(SHUNT)])
    s, line = 2j * np.pi * np.array([2.3e4, 1.7e6, 0.9e8, 1.1e9, 7e9]), LossyLine(SERIES, SHUNT, LENGTH)
    A, B, C, D = np.moveaxis(line.chain(s).reshape(-1, 4), -1, 0)
    exact = 1 / (A + B / LOAD + SOURCE * (C + D / LOAD))
    assert respond(made, s)["far"].u == pytest.approx(exact, abs=3e-5)
    z0 = SOURCE
    a, b, c, d = A, B / z0, C * z0, D  # the S-parameters of a chain: Pozar (2012), table 4.2
    assert scattering_parameters(made, ["near"], s, z0).shape == (5, 1, 1)
    open_end = scattering_parameters(Scene(str(tmp_path), **made.table() | {"loads": {}}), ["near", "far"], s, z0)
    assert open_end[:, 1, 0] == pytest.approx(2 / (a + b + c + d), abs=3e-5)


def test_a_step_into_a_round_wire_by_its_table(tmp_path):
    """Circuits of 1e-4 in the band of the run."""
    made = scene(tmp_path, [F, *columns(SERIES)], capacitance="100 pF/m")
    result = run(describe(made), Resolution(4, made.lines["line"].shortest / 4, fit=1e-4))
    t = np.array([1.9, 2.7, 3.8, 5.8, 7.7, 9.6]) * 1e-9
    line = LossyLine(SERIES, ConstantLoss(0, 100e-12), LENGTH)
    exact = lossy_response(line, [repr(float(x)) for x in t], LENGTH, source=SOURCE, load=LOAD, digits=8).efforts
    assert result.probes["far"].at(t).u == pytest.approx(exact, abs=3e-4)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"resistance": 1}, "lines.line.resistance: is in the table, too, expected one of them"),
        ({"inductance": 1e-7}, "lines.line.inductance: is in the table, too"),
        ({"capacitance": None}, "lines.line: "),
        ({"tabulated": {"file": "none.csv"}}, "lines.line.tabulated.file: "),
        ({"tabulated": {"file": "cable.csv", "tolerance": 1e-9}},
         "lines.line.tabulated.file: R and L: no passive law comes closer than"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_sentence(tmp_path, change, sentence):
    line = {key: value for key, value in ({"capacitance": 1e-10} | change).items() if value is not None}
    with pytest.raises(SceneError) as found:
        scene(tmp_path, [F, *columns(SERIES)], **line)
    assert str(found.value).startswith(sentence)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "lines.line.tabulated.file: R and L: shape"),
        ("1,2\n", "lines.line.tabulated.file: line 1 of"),
        ("1,2,3e-7\n2,3,2e-7,0,1e-10\n", "lines.line.tabulated.file: line 2 of"),
        ("2,2,3e-7\n1,3,2e-7\n", "lines.line.tabulated.file: R and L: not ascending"),
        ("1,-2,3e-7\n2,3,2e-7\n", "lines.line.tabulated.file: R and L: bad row"),
    ],
)
def test_a_bad_file_is_one_sentence(tmp_path, text, sentence):
    (tmp_path / "bad.csv").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as found:
        scene(tmp_path, [F, *columns(SERIES)], capacitance=1e-10, tabulated={"file": "bad.csv"})
    assert str(found.value).startswith(sentence)
    assert "\n" not in str(found.value)
