"""Reflectometry, eyes and load lines against reflection coefficients, closed forms and the run itself."""

from pathlib import Path

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.scene.file import read_scene
from tline.signal import bergeron, eye, prbs7, reflectometry

NS = 1e-9


def scene(lines: dict, **parts) -> Scene:
    whole = {"medium": "electrical", "t_end": 12 * NS, "lines": lines, "probes": {"far": {"at": "far"}}}
    return Scene(**whole | parts)


def line(first: str, second: str, z0: float, ns: float) -> dict:
    return {"nodes": [first, second], "z0": z0, "delay": ns * NS}


CASCADE = {"feed": line("near", "a", 50, 1), "stretch": line("a", "far", 75, 0.5)}
END = {"end": {"at": "far", "kind": "resistor", "resistance": 30}}
SOURCE = {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 10}}


def test_what_comes_back_from_a_cascade_is_the_sum_over_its_bounces():
    """Feed matched to the instrument: r = (75-50)/125, then t12 rL t21 (-r rL)^k per round trip in the stretch."""
    seen = reflectometry(scene(CASCADE, loads=END, sources=SOURCE), "near", 0.1 * NS)
    r, end = 25 / 125, (30 - 75) / 105
    exact = r * np.clip((seen.t - 2 * NS) / (0.1 * NS), 0, 1)
    for k in range(12):
        bounce = (1 - r**2) * end * (-r * end) ** k
        exact = exact + bounce * np.clip((seen.t - (3 + k) * NS) / (0.1 * NS), 0, 1)
    inside = np.all([np.abs(seen.t - corner * NS) > 0.03 * NS for k in range(2, 13) for corner in (k, k + 0.1)], axis=0)
    assert inside.sum() > 500
    assert np.abs(seen.reflected - exact)[inside].max() < 1e-8
    assert seen.impedance[(seen.t > 2.2 * NS) & (seen.t < 2.9 * NS)] == pytest.approx(75, rel=1e-5)


def test_an_instrument_of_another_impedance_sees_the_line_as_it_is():
    seen = reflectometry(scene(CASCADE, loads=END), "near", "0.1 ns", "75 ohm", "1.9 ns")
    assert seen.t[-1] >= 1.9 * NS
    assert seen.impedance[seen.t > 0.2 * NS] == pytest.approx(50, rel=1e-5)


def test_one_of_two_coupled_conductors_between_equal_modes_is_a_line():
    """Modes alike do not couple: a conductor is then a single line of their z0."""
    pair = {"nodes1": ["near", "x"], "nodes2": ["far", "y"]} | {m: {"z0": 75, "delay": NS} for m in ("even", "odd")}
    made = scene({"pair": pair}, loads={"e": {"at": "far", "kind": "resistor", "resistance": 75}})
    seen = reflectometry(made, "near", 0.1 * NS, 50)
    assert seen.impedance[seen.t > 0.2 * NS] == pytest.approx(75, rel=1e-8)
    with pytest.raises(InputError, match="z0: conductors that are coupled have none"):
        reflectometry(made, "near", 0.1 * NS)


def test_an_open_end_is_infinite_and_a_capacitor_begins_as_a_short():
    seen = reflectometry(scene({"l": line("near", "far", 50, 1)}), "near", 0.1 * NS, t_end=4 * NS)
    assert seen.reflected[seen.t > 2.2 * NS] == pytest.approx(1, abs=1e-6)
    capacitor = {"c": {"at": "far", "kind": "parallel", "capacitance": 2e-12}}
    seen = reflectometry(scene({"l": line("near", "far", 50, 1)}, loads=capacitor), "near", 0.1 * NS, t_end=4 * NS)
    tau, edge, t = 1e-10, 1e-10, seen.t - 2 * NS

    def ramp(x):  # response of (1 - s tau)/(1 + s tau) to a ramp of slope 1/edge
        return np.where(x > 0, x - 2 * tau * (1 - np.exp(-np.maximum(x, 0) / tau)), 0.0) / edge

    assert np.abs(seen.reflected - ramp(t) + ramp(t - edge)).max() < 1e-6  # inside slabs the order is lower


def test_a_matched_line_gives_the_eye_of_its_edges():
    made = scene({"l": line("near", "far", 50, 1.5)}, sources=SOURCE | {"s": SOURCE["s"] | {"resistance": 50}})
    seen = eye(made, "far", "1 ns", "0.4 ns", high="2 V", low="-1 V")
    assert seen.height == pytest.approx(3, rel=1e-5)
    assert seen.width == pytest.approx(1 * NS, rel=1e-5)
    assert seen.threshold == pytest.approx(0.5, abs=1e-5)
    assert seen.instant == pytest.approx((1.5 + 0.2 + 0.5) * NS, abs=NS / 128)


def test_a_capacitor_closes_the_eye_as_its_worst_pattern_does():
    """RC of 25 ohm and C behind a matched line: the lone one after zeros, and the lone zero after ones."""
    tau, T = 0.4 * NS, NS
    load = {"r": {"at": "far", "kind": "parallel", "resistance": 50, "capacitance": tau / 25}}
    made = scene({"l": line("near", "far", 50, 0.5)}, sources={"s": SOURCE["s"] | {"resistance": 50}}, loads=load)
    bits, edge = "0" * 12 + "1" + "0" + "1" * 12 + "0", 1e-4 * NS
    seen = eye(made, "far", T, edge, bits)
    begin = 0.5 * NS
    late = seen.instant - begin  # of the lone bit's begin
    assert 0 < late <= T * 1.01
    lone = 0.5 * (1 - np.exp(-late / tau))
    assert seen.height == pytest.approx(2 * lone - 0.5, abs=1e-3)  # the edge's and the instants' width


def test_the_pattern_is_that_of_the_shift_register():
    bits = prbs7()
    words = {tuple(np.roll(bits, -k)[:7].tolist()) for k in range(127)}
    assert len(words) == 127
    assert (False,) * 7 not in words


def test_load_lines_hop_as_the_run_does():
    made = read_scene(Path(__file__).parents[2] / "scenes" / "load_lines.toml")
    found, probes = bergeron(made), {}
    for at in made.lines["cable"].nodes:
        probes[at] = simulate(Scene(**made.table() | {"probes": {"p": {"at": at}}}), tol=1e-10).probes["p"]
    for k in range(1, 12):
        t = (k - 1 + 0.5) * NS  # half a delay behind the arrival
        seen = probes["near" if k % 2 else "far"].at(t)
        assert found.u[k] == pytest.approx(float(seen.u), rel=1e-9)
        assert found.y[k] == pytest.approx(float(seen.y), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("far", [{"kind": "short"}, {"kind": "open"}, {"kind": "resistor", "resistance": 50}])
@pytest.mark.parametrize("kind", ["voltage", "current"])
def test_load_lines_of_ideal_ends(far, kind):
    source = {"at": "near", "kind": kind, "value": 2, "resistance": 25} if kind == "voltage" else {
        "at": "near", "kind": kind, "value": 0.1}  # fmt: skip
    made = scene({"l": line("near", "far", 50, 1)}, sources={"s": source}, loads={"e": {"at": "far"} | far})
    found = bergeron(made, 6)
    probe = simulate(made).probes["far"]
    for k in (2, 4, 6):
        assert found.u[k] == pytest.approx(float(probe.at((k - 0.5) * NS).u), abs=1e-9)


def test_ends_with_memory_have_no_load_line():
    capacitor = {"c": {"at": "far", "kind": "parallel", "capacitance": 2e-12}}
    with pytest.raises(InputError, match=r"loads\.c: no load line"):
        bergeron(scene({"l": line("near", "far", 50, 1)}, loads=capacitor))
