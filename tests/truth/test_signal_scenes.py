"""Shipped scenes of signals against inverse Fourier transforms of their lines' constants, and against ngspice."""

import shutil

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.scene.file import read_scene
from tline.shipped import FOLDER
from tline.signal.crosstalk import crosstalk
from tline.signal.tdr import reflectometry
from tline.study.programs import ngspice

COUNT = 2**19


def shipped(name: str) -> Scene:
    return read_scene(FOLDER / f"{name}.toml")


def in_time(transform, end: float) -> tuple[np.ndarray, np.ndarray]:
    """A real function by the transform at the frequencies of a period twice as long, damped to 1e-6 at its end."""
    period = 2 * end
    s = np.log(1e6) / period + 2j * np.pi * np.arange(COUNT // 2 + 1) / period
    t = np.arange(COUNT) * period / COUNT
    u = np.fft.irfft(transform(s), COUNT) * COUNT / period * np.exp(t * s[0].real)
    return t[t <= end], u[t <= end]


def ramp(s, duration, begin=0.0):
    return np.exp(-begin * s) * -np.expm1(-duration * s) / (duration * s**2)


def constants(line):
    """Γ·length and zc of a line at complex frequencies."""
    law = line.losses.exact

    def at(s):
        return law.gamma(s) * line.length, law.zc(s)

    return at


def seen_from(load, gamma, zc):
    """Impedance of a line with that load, and the voltage at the load over that at its begin."""
    rho = (load - zc) / (load + zc)
    back = rho * np.exp(-2 * gamma)
    return zc * (1 + back) / (1 - back), np.exp(-gamma) * (1 + rho) / (1 + back)


def test_the_reflectometer_finds_the_wet_splice():
    scene = shipped("coax_fault")
    first, second = (constants(scene.lines[name]) for name in ("near_part", "far_part"))

    def near(s):
        behind, _ = seen_from(50.0, *second(s))
        impedance, _ = seen_from(1 / (1 / behind + 1 / 220), *first(s))
        return 2 * ramp(s, 5e-9) * impedance / (impedance + 50)

    t, u = in_time(near, 700e-9)
    seen = reflectometry(scene, "near", "5 ns", 50.0)
    exact = np.interp(seen.t, t, u) - seen.incident
    assert np.abs(seen.reflected - exact)[seen.t < 690e-9].max() < 1e-3
    delay = scene.lines["near_part"].parameters.delay
    falls = seen.t[np.argmax(seen.reflected)]
    assert falls == pytest.approx(2 * delay, abs=5e-9)


def test_crosstalk_of_the_pair_with_skin_effect():
    scene = shipped("skin_pair")
    even, odd = (constants(scene.single_lines[name]) for name in scene.single_lines)
    wave = {}
    for word, k in (("near", 0), ("far", 1)):

        def difference(s, k=k):
            found = []
            for mode in (even, odd):
                impedance, passed = seen_from(50.0, *mode(s))
                found.append(impedance / (impedance + 50) * (1, passed)[k] / 2)
            return (found[0] - found[1]) * ramp(s, 0.1e-9, 0.2e-9)

        wave[word] = in_time(difference, 8e-9)
    probes, notes = (result := simulate(scene)).probes, result.notes
    assert not notes
    for word, (t, u) in wave.items():
        inside = t < 7.9e-9
        assert np.abs(probes[word].at(t[inside][::64]).u - u[inside][::64]).max() < 5e-4
    told = crosstalk(scene)
    assert told.near["near"] == pytest.approx(np.abs(wave["near"][1][:-100]).max() / told.swing, rel=0.03)
    assert told.far["far"] == pytest.approx(np.abs(wave["far"][1][:-100]).max() / told.swing, rel=0.03)


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
def test_the_bus_with_ten_drops_in_ngspice():
    scene = shipped("ten_drop_bus")
    deck = ["* bus", "V1 s 0 PWL(0 0 0.5n 0 1n 3 1 3)", "R1 s start 50", "R2 end 0 50"]
    for name, line in scene.lines.items():
        deck.append(f"T{name} {line.nodes[0]} 0 {line.nodes[1]} 0 Z0=65 TD={float(line.parameters.delay)!r}")
    deck += [f"Cchip{k} chip{k} 0 5p" for k in range(1, 11)]
    deck += [".options acct reltol=1e-5", ".save v(chip1) v(chip5) v(chip10)", ".tran 1p 20n 0 1p uic", ".end", ""]
    waves, _, _ = ngspice.transient("\n".join(deck))
    t = waves["time"][1:-1]
    for name, probe in simulate(scene).probes.items():
        assert np.abs(probe.at(t).u - waves[f"v({name})"][1:-1]).max() < 3e-4 * 3


def test_crosstalk_counts_a_jump_at_the_start():
    """Even and odd mode are single lines: the quiet conductor gets half of what they differ by, at once."""
    ends = {at: {"at": at, "kind": "resistor", "resistance": 50} for at in ("a2", "b1", "b2")}
    driver = {"at": "a1", "kind": "voltage", "resistance": 50, "value": {"shape": "step", "to": 1}}
    modes = {"even": {"z0": 60, "delay": "1 ns"}, "odd": {"z0": 40, "delay": "1 ns"}}
    pair = {"nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"]} | modes
    parts = {
        "medium": "electrical",
        "t_end": "0.5 ns",
        "lines": {"p": pair},
        "loads": ends,
        "probes": {"a": {"at": "a1"}},
    }
    seen = crosstalk(Scene(**parts, sources={"s": driver}))
    even, odd = 60 / 110 / 2, 40 / 90 / 2
    assert seen.swing == pytest.approx(even + odd)
    assert seen.near["a2"] == pytest.approx((even - odd) / (even + odd))
    with pytest.raises(InputError, match="stays at 0 V"):
        crosstalk(Scene(**parts, sources={"s": driver | {"value": 0}}))
