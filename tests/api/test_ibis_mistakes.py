"""Mistakes with IBIS files, and with tables from files: one sentence each, that names the key and what to do."""

import random

import numpy as np
import pytest

from tline import InputError, Scene, SceneError, simulate
from tline.scene.ibis.element import _kept
from tline.shipped import FOLDER

SENDS = {"bits": "01", "bit": "1 ns"}
TEXT = (FOLDER / "memory.ibs").read_text(encoding="utf-8")


def scene(folder=FOLDER, probe="a", **load) -> Scene:
    return Scene(
        folder, medium="electrical", t_end="3 ns", lines={"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}},
        loads={"u1": {"at": "a", "kind": "ibis", "file": "memory.ibs"} | load}, probes={"p": {"at": probe}},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ({}, "loads.u1.model: is missing, expected 'DQ' or 'CLOCK'"),
        ({"model": "DX"}, "loads.u1.model: no such [Model] in the file, expected one of 'DQ', 'CLOCK', got 'DX'"),
        ({"pin": "A3"}, "loads.u1.pin: no such pin in the file, expected one of 'A1', 'A2', 'B1', got 'A3'"),
        ({"component": "X", "pin": "A1"}, "loads.u1.component: no such [Component] in the file, expected 'MEMORY'"),
        ({"model": "DQ", "corner": "slow"}, "loads.u1.corner: "),
        ({"model": "DQ", "bit": "1 ns"}, "loads.u1.bit: is the time of bits, expected bits beside it"),
        ({"model": "DQ", "bits": "01"}, "loads.u1.bit: is missing, expected the time of a bit"),
        ({"model": "DQ", "bits": "02", "bit": 1}, "loads.u1.bits: not a bit pattern, expected zeros and ones"),
        ({"model": "CLOCK"} | SENDS, "loads.u1.bits: the model is of type 'input' and cannot drive"),
        ({"model": "DQ", "file": "none.ibs"}, "loads.u1.file: "),
        ({"model": "DQ", "file": "ddr_ibis.toml"}, "loads.u1.file: 'ddr_ibis.toml': is no IBIS file"),
        ({"model": "DQ", "probe": "u1, die", "package": False}, "probes.p.at: no package parts this die from its pin"),
    ],
)
def test_in_the_scene(load, message):
    with pytest.raises(SceneError) as found:
        scene(**load)
    assert str(found.value).startswith(message)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("I/O", "Magic", "loads.u1.model: a type that is not known here"),
        ("C_comp 1.3e-12", "C_comp x", "loads.u1.file: 'bad.ibs': line 20: not a number, expected such as 2.5pF"),
        ("C_comp 1.3e-12 1.1e-12 1.5e-12", "C_comp NA", "loads.u1.file: 'bad.ibs': line 20: there is no typical value"),
        ("[Voltage Range] 1.2", "[Nothing] 1.2", "loads.u1.file: 'bad.ibs': line 15: the model has no supply"),
        ("R_fixture = 50", "", "loads.u1.file: 'bad.ibs': line 154: a waveform without R_fixture"),
        ("L_pkg 0.9nH", "L_pkg -9nH", "loads.u1.file: 'bad.ibs': R, L or C of the package is negative"),
        ("1.2000e-10 ", "0.0000e-10 ", "loads.u1.file: 'bad.ibs': line 154: times of the waveform do not rise"),
        ("-0.300 -8.577608e-03", "--0.300 -8.577608e-03", "loads.u1.file: 'bad.ibs': line 32: not a number"),
        ("-6.862087e-03 -1.029313e-02\n-0.2", "--6.8e-03 -1.02e-02\n-0.2", "loads.u1.file: 'bad.ibs': line 32: not a"),
        (
            "-0.300 -8.577608e-03",
            "-0.300 6.9e16",
            "loads.u1.file: 'bad.ibs': line 32: not plausible, expected at most 10",
        ),
        (
            "1.2000e-10 ",
            "1.2000e-10 1.15e14 ",
            "loads.u1.file: 'bad.ibs': line 171: not plausible, expected at most 1000 V",
        ),
        (
            "1.2000e-10 ",
            "1.2000e-10 77 ",
            "loads.u1.file: 'bad.ibs': line 154: the waveform is not plausible, expected at",
        ),
        ("C_comp 1.3e-12", "C_comp 1.3", "loads.u1.file: 'bad.ibs': line 20: not plausible, expected at most 0.001 F"),
        ("dV/dt_r", "dU/dt_r", ""),
    ],
)
def test_in_the_file(old, new, message, tmp_path):
    assert old in TEXT
    (tmp_path / "bad.ibs").write_text(TEXT.replace(old, new), encoding="utf-8")
    if not message:
        scene(tmp_path, file="bad.ibs", model="DQ", **SENDS)
        return
    with pytest.raises(SceneError) as found:
        scene(tmp_path, file="bad.ibs", model="DQ", **SENDS)
    assert str(found.value).startswith(message)


@pytest.mark.parametrize("size", [1e14, 1.15e14, 6.9e16, 1e300])
def test_an_edge_of_any_size_is_thinned_out_in_finite_time(size):
    """Though rounding makes an end point the farthest from the line through it."""
    chance = np.random.default_rng(1)
    for _ in range(50):
        t, y = np.cumsum(chance.uniform(1e-11, 2e-11, 40)), chance.uniform(0.0, 1.0, 40)
        y[chance.integers(0, 40, 3)] *= size
        kept = _kept(t, y)
        assert kept[[0, -1]].tolist() == [0, 39]
        assert (np.diff(kept) > 0).all()


def test_torn_files_are_refused_or_read(tmp_path):
    """Words and lines left out, doubled, moved, and numbers beyond reason."""
    chance, read = random.Random(1), 0
    for _ in range(300):
        lines = TEXT.splitlines()
        for _ in range(chance.randint(1, 6)):
            k, j = chance.randrange(len(lines)), chance.randrange(len(lines))
            words = lines[k].split()
            match chance.randrange(5):
                case 0:
                    del lines[k]
                case 1:
                    lines[k], lines[j] = lines[j], lines[k]
                case 2:
                    lines.insert(j, lines[k])
                case 3 if words:
                    del words[chance.randrange(len(words))]
                    lines[k] = " ".join(words)
                case _ if words:
                    words[chance.randrange(len(words))] = chance.choice(["1e30", "-1e30", "1e999", "NA", "0", "[", "|"])
                    lines[k] = " ".join(words)
        (tmp_path / "torn.ibs").write_text("\n".join(lines), encoding="utf-8")
        try:
            scene(tmp_path, file="torn.ibs", model="DQ", **SENDS)
            read += 1
        except InputError:
            continue
    assert 20 < read < 300


def test_it_comes_back_from_its_text(tmp_path):
    first = scene(pin="A1", probe="u1, die", **SENDS)
    table = first.table()
    assert set(table["loads"]) == {"u1"}
    assert "links" not in table
    assert "sources" not in table
    assert table["loads"]["u1"]["at"] == "a"
    other = first.change({"loads.u1.corner": "min"})
    assert other.loads["u1"].summary.endswith("with waveforms")
    assert "min" in other.loads["u1"].summary
    assert "u1, pulldown" in other.loads
    assert "u1, pullup" in other.links


def test_a_curve_from_a_file(tmp_path):
    (tmp_path / "curve.csv").write_text("voltage,current\n-1,-0.02\n0,0\n2,0.04\n", encoding="utf-8")
    (tmp_path / "falls.csv").write_text("0,0\n1,-1\n", encoding="utf-8")
    source = {"s": {"at": "a", "kind": "voltage", "value": 1, "resistance": 50}}

    def end(**load):
        loads = {"l": {"at": "b", "kind": "table"} | load}
        lines = {"line": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"}}
        tables = {"lines": lines, "sources": source, "loads": loads, "probes": {"p": {"at": "b"}}}
        return simulate(Scene(tmp_path, medium="electrical", t_end="9 ns", **tables)).probes["p"].u[-1]

    for first in ("--1,-0.02", "1_0,2", "+-1,0", "-,-", "0x1,0"):
        (tmp_path / "loose.csv").write_text(f"{first}\n11,1\n12,2\n", encoding="utf-8")
        with pytest.raises(SceneError, match=r"line 1 of .*loose.csv' is not a point, expected two finite numbers"):
            end(file="loose.csv")
    assert end(file="curve.csv") == pytest.approx(end(points=[[0, 0], [1, 0.02]]), rel=1e-12)
    assert end(points=[[0, 0], [1, 0.02]], scale=0.5) == pytest.approx(end(points=[[0, 0], [1, 0.01]]), rel=1e-12)
    for load, message in (
        ({}, "loads.l: its curve is not given once, expected either points or file"),
        ({"file": "falls.csv"}, "loads.l.file: the curve falls or stands still"),
        ({"points": [[0, 0], [1, 1]], "scale": -1}, "loads.l.scale: out of range"),
    ):
        with pytest.raises(SceneError) as found:
            end(**load)
        assert str(found.value).startswith(message)
