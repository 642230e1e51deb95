"""ngspice, where it is installed, runs exported netlists and agrees within its own error, which falls with its step."""

import shutil

import numpy as np
import pytest

from tline import Result, Scene, simulate
from tline.interchange.spice import read_spice
from tline.study.charts.measure import Judge
from tline.study.charts.scenes import chart_scene
from tline.study.charts.work_precision import simulated
from tline.study.programs import ngspice

DEFAULT = 20  # steps in the shortest delay, which an exported netlist asks for
REFINED = {"rc": 640, "rlc": 640, "lossy": 160}  # the lossy element's time goes with the square
ERRORS = {"rc": (0.03, 5e-5), "rlc": (0.04, 1e-3), "lossy": (7e-5, 5e-6)}  # twice what version 39.3 shows

pytestmark = pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")


@pytest.mark.parametrize("name", ERRORS)
def test_it_agrees_within_its_own_error(name):
    scene = chart_scene(name).scene
    if name == "lossy":  # whose inverse Laplace transforms take long
        scene = scene.change({"t_end": scene.t_end / 3})
    judge = Judge(scene, 40)
    ours = simulated(scene, 1e-8)
    assert max(judge.errors(ours)) < 3e-8
    for steps, bound in zip((DEFAULT, REFINED[name]), ERRORS[name], strict=True):
        theirs = ngspice.run(scene, steps)
        assert judge.errors(theirs)[1] < bound


NS, STEPS = 1e-9, (20, 80, 320)
SMOOTH = {"shape": "sine", "offset": 1, "amplitude": -1, "frequency": "0.3 GHz", "phase": "90 deg"}  # no corner at 0
BY_HAND = {"order": 6, "slab": "0.0125 ns"}  # our own error is below 1e-10
LINES = {"a": {"nodes": ["in", "p"], "z0": 50, "delay": NS}, "b": {"nodes": ["q", "out"], "z0": 120, "delay": NS}}
LINKS = {
    "transformer": {"kind": "transformer", "ratio": -2},
    "gyrator": {"kind": "gyrator", "resistance": 70},
    "amplifier": {"kind": "controlled source", "gain": 3, "resistance": 40},
    "ideal amplifier": {"kind": "controlled source", "gain": -3, "resistance": 0},
    "coupled inductors": {"kind": "coupled inductors", "inductance": ["10 nH", "40 nH"], "coupling": -0.6},
    "circulator": {
        "kind": "junction", "nodes": ["p", "q", "r"], "z0": 50, "scattering": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
    },
    "attenuator": {"kind": "junction", "z0": 50, "scattering": [[0.1, 0.4], [0.5, -0.2]]},
}  # fmt: skip
FRONT = ["V1 s 0 SIN(1 -1 0.3G 0 0 90)", "R1 s in 25", "T1 in 0 p 0 Z0=50 TD=1n"]
BACK = ["T2 q 0 out 0 Z0=120 TD=1n", "R2 out 0 300", "C2 out 0 1p"]
NETS = {
    "coupled inductors, one upside down": ["L1 p 0 10n", "L2 0 q 40n", "K1 L1 L2 0.6"],
    "an amplifier behind a resistor, upside down": ["E1 0 x p 0 3", "R3 x q 40"],
    "an amplifier that commands another": ["E1 x 0 p 0 3", "E2 q 0 0 x 2"],
    "a source that commands": ["E1 q 0 s 0 2"],
    "diodes": ["D1 p q DX", "D2 0 q DX", ".model DX D(IS=1n N=1.5)"],
    "three windings": [
        "L1 p 0 10n", "L2 0 q 40n", "L3 z 0 20n", "K1 L1 L2 0.6", "K2 L2 L3 0.7", "K3 L1 L3 0.5", "R9 z 0 30",
    ],
    "sums of voltages and currents": [
        "B1 x 0 V=0.5*v(p) - 2*v(s,p) + 7*i(V9)", "R8 x q 40", "V9 p z 0", "R9 z 0 60",
        "B2 0 q I=5m*v(z) + 1m*v(q,x)/2",
    ],
    "a polynomial of two voltages": ["G1 0 q POLY(2) p 0 s 0 0 5m 2m", "R9 p 0 60", "C9 q 0 1p"],
    "transconductances": ["G1 q 0 p 0 10m", "G2 0 p q 0 5m", "G3 p 0 p 0 4m", "L1 q 0 30n"],
}  # fmt: skip


def distances(scene: Scene, runs: list[dict]) -> np.ndarray:
    """Largest differences from our own run, relative to the amplitude."""
    ours: Result = simulate(scene.with_changes(solver=BY_HAND), active=True)
    amplitude = max(np.abs(probe.u).max() for probe in ours.probes.values())
    inside = [(f"v({name})", probe.t <= 11.9 * NS, probe) for name, probe in ours.probes.items()]
    return np.array([
        max(np.abs(np.interp(p.t[k], run["time"], run[v]) - p.u[k]).max() for v, k, p in inside) / amplitude
        for run in runs
    ])  # fmt: skip


def assert_theirs_is_the_error(found: np.ndarray, shown: float = 3.7e-6) -> None:
    """The trapezoidal rule's second order, down to twice what version 39.3 shows at the finest step."""
    order = -np.polyfit(np.log(STEPS), np.log(found), 1)[0]
    assert 1.8 < order < 2.4
    assert found[-1] < 2 * shown


@pytest.mark.parametrize("name", LINKS)
def test_multiports_written_do_the_same(name):
    link = {"nodes": ["p", "q"]} | LINKS[name]
    loads = {"out": {"at": "out", "kind": "parallel", "resistance": 300, "capacitance": "1 pF"}}
    scene = Scene(
        medium="electrical", t_end=12 * NS, links={name: link}, lines=LINES,
        probes={at: {"at": at} for at in ("in", "p", "q", "out")},
        sources={"s": {"at": "in", "kind": "voltage", "value": SMOOTH, "resistance": 25}},
        loads=loads | ({"r": {"at": "r", "kind": "resistor", "resistance": 20}} if "r" in link["nodes"] else {}),
    )  # fmt: skip
    runs = [ngspice.transient(ngspice.netlist(scene, NS / steps))[0] for steps in STEPS]
    assert_theirs_is_the_error(distances(scene, runs))


@pytest.mark.parametrize("name", NETS)
def test_multiports_read_do_the_same(name, tmp_path):
    cards = [name, *FRONT, *NETS[name], *BACK]
    (tmp_path / "net.cir").write_text("\n".join([*cards, ".tran 1p 12n uic"]), encoding="utf-8")
    texts = [
        "\n".join([*cards, ".options acct", f".tran {NS / steps} 12n 0 {NS / steps} uic", ".end"]) for steps in STEPS
    ]
    runs = [ngspice.transient(text)[0] for text in texts]
    theirs = distances(read_spice(tmp_path / "net.cir")[0], runs)
    assert_theirs_is_the_error(theirs, *([2.9e-5] if name == "diodes" else []))
