"""Measured multiports against closed forms, and against the networks that their files were computed from."""

import numpy as np
import pytest
from scipy.signal import lti, step
from touchstone_files import (
    FILTER,
    FILTER_C,
    FILTER_ESR,
    FILTER_L,
    FILTER_R,
    frequencies,
    low_pass,
    stretch,
    write_filter,
    write_ports,
)

from tline import Scene, simulate

LINES = {
    "a": {"nodes": ["in", "p"], "z0": 50, "delay": "1 ns"},
    "b": {"nodes": ["q", "out"], "z0": 120, "delay": "1 ns"},
}
RAMP = {"shape": "ramp", "to": 1, "duration": "0.25 ns"}


def scene(link, folder, value=RAMP, resistance=25, load=300, slab="0.125 ns", **parts):
    """Two lines and what is between them."""
    whole = {
        "medium": "electrical", "t_end": "12 ns", "lines": LINES, "solver": {"order": 5, "slab": slab},
        "sources": {"s": {"at": "in", "kind": "voltage", "value": value, "resistance": resistance}},
        "loads": {"end": {"at": "out", "kind": "resistor", "resistance": load}},
        "links": {"x": {"nodes": ["p", "q"]} | link}, "probes": {k: {"at": k} for k in ("in", "p", "q", "out")},
    }  # fmt: skip
    return Scene(str(folder), **whole | parts)


def measured(file, **keys):
    return {"kind": "touchstone", "file": file, "tolerance": 1e-9} | keys


def apart(one, other):
    """Largest difference of two runs at any probe."""
    seen = [simulate(each).probes for each in (one, other)]
    return max(np.abs(seen[0][at].u - seen[1][at].u).max() for at in seen[0].keys() & seen[1].keys())


def test_a_file_of_windings_is_coupled_inductors(tmp_path):
    f, one = np.linspace(0, 5e9, 101), np.eye(2)
    L = np.array([[10e-9, -12e-9], [-12e-9, 40e-9]])
    Z = 2j * np.pi * f[:, None, None] * L / 50
    write_ports(tmp_path / "w.s2p", f, (Z - one) @ np.linalg.inv(Z + one))
    made = scene(measured("w.s2p", nearest=True), tmp_path)  # without losses: rounding decides what the fit is
    assert made.links["x"].model.cost < 1e-13
    known = {"kind": "coupled inductors", "inductance": ["10 nH", "40 nH"], "coupling": -0.6}
    assert apart(made, scene(known, tmp_path)) < 1e-13


@pytest.mark.parametrize("S", [[[0, -1.0], [1.0, 0]], [[0.1, 0.5], [0.3, -0.2]]])
def test_a_file_without_poles_is_a_junction(S, tmp_path):
    """A gyrator, and an attenuator that is not reciprocal; against another reference than the lines'."""
    write_ports(tmp_path / "s.s2p", frequencies(), np.tile(S, (250, 1, 1)), z0=75)
    made = scene(measured("s.s2p", nearest=True), tmp_path)
    assert made.links["x"].model.model.order == 0
    assert apart(made, scene({"kind": "junction", "z0": 75, "scattering": S}, tmp_path)) < 1e-13


def test_ports_are_in_the_order_of_the_nodes(tmp_path):
    """A circulator of three ports, whose middle one is shorted."""
    S = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    write_ports(tmp_path / "s.s3p", frequencies(), np.tile(S, (250, 1, 1)))
    three = {"nodes": ["p", "r", "q"]}
    loads = {"r": {"at": "r", "kind": "short"}, "end": {"at": "out", "kind": "resistor", "resistance": 300}}
    made = scene(measured("s.s3p", nearest=True) | three, tmp_path, loads=loads)
    known = scene({"kind": "junction", "z0": 50, "scattering": S} | three, tmp_path, loads=loads)
    assert apart(made, known) < 1e-13


def test_delays_become_lines(tmp_path):
    """0.4 ns and 0.6 ns in front of the ports of an amplifier that only passes one way, without its gain."""
    f = frequencies()
    turned = np.exp(-2j * np.pi * f[:, None] * [0.4e-9, 0.6e-9])
    write_ports(tmp_path / "s.s2p", f, turned[:, :, None] * [[0.2, 0], [0.7, -0.3]] * turned[:, None, :])
    made = scene(measured("s.s2p", delays=["0.4 ns", "0.6 ns"]), tmp_path, slab="0.1 ns")
    assert made.links["x"].model.model.order == 0
    assert list(made.lines) == ["a", "b", "links.x.1", "links.x.2"]
    more = {
        "c": {"nodes": ["p", "m"], "z0": 50, "delay": 0.4e-9},
        "d": {"nodes": ["q", "n"], "z0": 50, "delay": 0.6e-9},
    }
    known = {"kind": "junction", "z0": 50, "scattering": [[0.2, 0], [0.7, -0.3]], "nodes": ["m", "n"]}
    other = scene(known, tmp_path, slab="0.1 ns", lines=LINES | more, probes={k: {"at": k} for k in ("in", "out")})
    assert apart(made, other) < 1e-13


def test_a_step_through_a_filter_between_matched_cables(tmp_path):
    """S21 as a ratio of polynomials written by hand, its step response by scipy."""
    f = frequencies(6e9, 150)
    write_ports(tmp_path / "f.s2p", f, low_pass(f))
    matched = LINES | {"b": LINES["b"] | {"z0": 50}}
    once = {"shape": "step", "to": 2}
    made = scene(measured("f.s2p", nearest=True), tmp_path, once, 50, 50, "5 ps", lines=matched, t_end="7 ns")
    Y, D, Z = np.poly1d([FILTER_C, 0]), np.poly1d([FILTER_C * FILTER_ESR, 1]), np.poly1d([FILTER_L, FILTER_R])
    # S21 = 2/(2 (1 + Z y) + Z/50 + 50 y (2 + Z y)) with y = Y/D
    exact = lti((2 * D * D).c, (2 * (D + Z * Y) * D + Z * D * D / 50 + 50 * Y * (2 * D + Z * Y)).c)
    probe = simulate(made).probes["out"]
    late = probe.t > 2e-9 - 1e-15
    assert np.abs(probe.u[~late]).max() < 1e-12
    expected = step(exact, T=5e-12 * np.arange(late.sum()))[1]
    assert np.abs(probe.u[late] - expected).max() < 1e-9  # the tolerance of the fit


def test_a_short_line_passes_slow_pulses_as_the_line_does(tmp_path):
    """20 ps of 75 ohm by 6 poles up to 20 GHz; a Gauss pulse of corners 10 ps apart reaches beyond with 1e-4 of it."""
    f = np.linspace(0, 20e9, 100)
    write_ports(tmp_path / "line.s2p", f, stretch(f, 75, 20e-12))
    t = np.arange(0, 1601, 10)
    levels = np.exp(-(((t - 800) / 200) ** 2) / 2) * (np.abs(t - 800) < 800)
    pulse = {
        "shape": "piecewise linear",
        "points": [[x * 1e-12, y] for x, y in zip(t.tolist(), levels.tolist(), strict=True)],
    }
    some = {"in": {"at": "in"}, "out": {"at": "out"}}
    made = scene(
        measured("line.s2p", tolerance=1e-3, nearest=True), tmp_path, pulse, slab="2 ps", probes=some, t_end="6 ns"
    )
    found = made.links["x"].model
    assert found.model.order == 6
    assert found.cost <= found.error < 2e-5
    lines = LINES | {"c": {"nodes": ["p", "q"], "z0": 75, "delay": "20 ps"}}
    assert apart(made, made.with_changes(links={}, lines=lines)) < 1e-3


def test_the_shipped_filter_is_what_it_is_said_to_be(tmp_path):
    write_filter(tmp_path / "again.s2p")
    assert (tmp_path / "again.s2p").read_text() == FILTER.read_text()
    found = scene({"kind": "touchstone", "file": str(FILTER)}, tmp_path).links["x"].model
    f = frequencies(6e9, 77)
    assert np.abs(found.model.at(2 * np.pi * f) - low_pass(f)).max() < 2e-5  # five decimals
