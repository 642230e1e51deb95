"""Measures of runs whose waveforms are known, and against those of ngspice."""

import re
import shutil
import subprocess

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.interchange.spice import read_spice

SINE = {"shape": "sine", "amplitude": 2, "frequency": "100 MHz"}  # 1 V behind a matched line of 1.5 ns
RAMP = {"shape": "ramp", "from": 0, "to": 2, "at": 0, "duration": "4 ns"}


def measured(value, **measures) -> dict[str, float]:
    scene = Scene(
        medium="electrical", t_end="11.5 ns", lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1.5 ns"}},
        sources={"s": {"at": "near", "kind": "voltage", "value": value, "resistance": 50}},
        loads={"end": {"at": "far", "kind": "matched"}}, measures=measures, solver={"tol": 1e-10},
        probes={"near": {"at": "near"}, "far": {"at": "far"}},
    )  # fmt: skip
    return {name: value for name, (value, _) in simulate(scene).measures.items()}


@pytest.mark.parametrize(
    ("measure", "known"),
    [
        ({"kind": "maximum"}, 1.0), ({"kind": "minimum"}, -1.0), ({"kind": "peak to peak"}, 2.0),
        ({"kind": "maximum", "stop": "2 ns"}, np.sin(np.pi / 10)),
        ({"kind": "mean", "start": "1.5 ns", "stop": "6.5 ns"}, 2 / np.pi),
        ({"kind": "integral", "start": "1.5 ns", "stop": "6.5 ns"}, 1e-8 / np.pi),
        ({"kind": "rms", "start": "1.5 ns", "stop": "11.5 ns"}, np.sqrt(0.5)),
        ({"kind": "crossing", "level": 0.5, "edge": "fall"}, 1.5e-9 + 5 / 6 * 5e-9),
        ({"kind": "crossing", "level": 0.5, "count": 0}, 1.5e-9 + 5 / 6 * 5e-9),
        ({"kind": "crossing", "level": -0.5, "count": 2}, 1.5e-9 + 11 / 12 * 1e-8),
        ({"kind": "crossing", "level": 0.5, "after": "9 ns"}, np.nan), ({"kind": "crossing", "level": 2}, np.nan),
        ({"kind": "value", "at": "4 ns"}, 1.0), ({"kind": "value", "at": "1 us"}, np.nan),
        ({"kind": "value", "when": {"probe": "near", "level": 1e-9, "edge": "fall"}}, np.sin(0.7 * np.pi)),
        ({"kind": "maximum", "minus": "near", "start": "1.5 ns"}, 2 * np.sin(0.15 * np.pi)),
    ],
)  # fmt: skip
def test_measures_of_a_sine(measure, known):
    assert measured(SINE, m={"probe": "far"} | measure)["m"] == pytest.approx(known, abs=2e-9, nan_ok=True)


def test_the_delay_of_a_line_also_from_a_file():
    ends = {"start": {"probe": "near", "level": "0.5 V"}, "stop": {"probe": "far", "level": "500 mV", "edge": "rise"}}
    assert measured(RAMP, delay={"kind": "delay"} | ends)["delay"] == pytest.approx(1.5e-9, rel=1e-9)


def test_a_jump_is_crossed_when_it_happens():
    found = measured(
        {"shape": "step", "from": 0, "to": 2, "at": "1 ns"}, at={"kind": "crossing", "probe": "far", "level": 1 / 3}
    )
    assert found["at"] == pytest.approx(2.5e-9, rel=1e-7)


@pytest.mark.parametrize(
    ("measure", "sentence"),
    [
        ({"kind": "maximum", "probe": "fra"}, "measures.m.probe: no such probe, expected 'far', got 'fra'"),
        ({"kind": "highest", "probe": "far"}, "measures.m.kind: unknown, expected one of 'maximum', 'minimum'"),
        ({"kind": "value", "probe": "far"}, "measures.m.at: the instant is not given once, expected at or when"),
        ({"kind": "crossing", "probe": "far"}, "measures.m.level: is missing"),
        ({"kind": "crossing", "probe": "far", "level": "1 A"}, "measures.m.level: "),
        (
            {"kind": "delay", "start": {"probe": "far", "levl": 1}},
            "measures.m.start.levl: unknown key, expected 'level'",
        ),
    ],
)
def test_a_mistake_is_one_sentence(measure, sentence):
    with pytest.raises(InputError) as found:
        measured(1, m=measure)
    assert sentence in str(found.value)


DECK = """measured
V1 s 0 PULSE(0 1 1n 1n 1n 5n 12n)
R1 s a 25
T1 a 0 b 0 Z0=50 TD=1n
R2 b 0 100
C2 b 0 4p
.tran 1p 20n 0 2p
.options reltol=1e-6
.measure tran peak MAX v(b)
.measure tran swing PP v(b)
.measure tran mean AVG v(b) from=1n to=9n
.measure tran rms RMS v(b)
.measure tran whole INTEG v(b) from=0 to=10n
.measure tran later TRIG v(a) VAL=0.4 RISE=1 TARG v(b) VAL=0.4 RISE=1
.measure tran last TRIG AT=0 TARG v(b) VAL=0.5 FALL=LAST
.measure tran second WHEN v(b)=0.5 CROSS=2
.measure tran at3 FIND v(b) AT=3n
.measure tran other FIND v(a) WHEN v(b)=0.5 TD=5n
.end
"""


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
def test_ngspice_measures_the_same(tmp_path):
    deck = tmp_path / "measured.cir"
    deck.write_text(DECK, encoding="utf-8")
    told = subprocess.run(["ngspice", "-b", str(deck)], capture_output=True, text=True, check=False).stdout
    theirs = {name: float(value) for name, value in re.findall(r"(?m)^(\w+) += +(\S+)", told)}
    scene, notes = read_spice(deck)
    ours = simulate(scene.with_changes(solver={"tol": 1e-8})).measures
    assert len(notes) == 1  # .options
    assert len(ours) == 10
    for name, (value, _) in ours.items():
        assert value == pytest.approx(theirs[name], rel=1e-4), name  # its steps of 2 ps
