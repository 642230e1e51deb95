"""Measured loads against closed forms and the networks that the files were computed from."""

import numpy as np
import pytest
from touchstone_files import ANTENNA, SHIPPED, behind_cable, frequencies, write, write_antenna

from passivity import RationalFunction
from tline import Scene, simulate
from tline.frequency import DelaySystem, resonances, respond

R1, R2, C, T, TF = 20.0, 200.0, 4e-12, 1e-9, 0.31e-9


def scene(load, source=50, **tables):
    return Scene(
        str(tables.pop("folder", ".")),
        medium="electrical",
        t_end="12 ns",
        lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": T}, **tables},
        sources={"s": {"at": "near", "kind": "voltage", "value": {"shape": "step", "to": 1}, "resistance": source}},
        loads={"one": load},
        probes={"far": {"at": "far", "line": "cable"}},
    )


@pytest.mark.parametrize("feed", [0.0, TF])
def test_a_step_into_a_measured_rc(tmp_path, feed):
    """R1 + (R2 beside C) from a matched source: one exponential, in closed form, behind twice the feed's delay."""
    f = frequencies()
    write(tmp_path / "rc.s1p", f, behind_cable(f"{R1} + 1/(1/{R2} + s*{C!r})", f, feed))
    load = {"at": "far", "kind": "touchstone", "file": "rc.s1p", "tolerance": 1e-9}
    made = scene(load, folder=tmp_path)
    found = made.loads["one"].model
    assert found.order == 1
    assert found.delay == pytest.approx(feed, rel=1e-9)
    seen = simulate(made, tol=1e-10).probes["far"]
    t = seen.t  # slab ends, where a run is as exact as asked
    tau = C * R2 * (50 + R1) / (50 + R1 + R2)
    late = t - T - 2 * feed
    i = 1 / (50 + R1 + R2) + (1 / (50 + R1) - 1 / (50 + R1 + R2)) * np.exp(-np.maximum(late, 0) / tau)
    exact = np.where(late > 0, 1 - 50 * i, np.where(t > T, 0.5, 0.0))
    away = (np.abs(late) > 1e-15) & (np.abs(t - T) > 1e-15)
    # |ΔS| <= 1e-9, and a matched source sends nothing back
    assert np.abs(seen.u - exact)[away].max() < 1e-9


@pytest.mark.parametrize("feed", [0.0, TF])
def test_a_measured_network_does_what_the_network_does(tmp_path, feed):
    f = frequencies()
    write(tmp_path / "antenna.s1p", f, behind_cable(ANTENNA, f, feed))
    file = {"at": "far", "kind": "touchstone", "file": "antenna.s1p", "tolerance": 1e-9}
    measured = scene(file, source=10, folder=tmp_path)
    lines = {"feed": {"nodes": ["far", "end"], "z0": 50, "delay": feed}} if feed else {}
    known = scene({"at": "end" if feed else "far", "kind": "impedance", "expression": ANTENNA}, source=10, **lines)
    t = np.linspace(0, 11.9e-9, 997)
    ours, theirs = (simulate(each, tol=1e-10).probes["far"].at(t) for each in (measured, known))
    assert np.abs(ours.u - theirs.u).max() < 1e-8
    assert np.abs(ours.y - theirs.y).max() < 1e-10
    late = [DelaySystem(each, "far").step([9e-9])[0] for each in (measured, known)]
    assert late[0] == pytest.approx(late[1], abs=1e-7)
    ours, theirs = ([mode.s for mode in resonances(each, 2e9)] for each in (measured, known))
    assert ours == pytest.approx(theirs, rel=1e-8)
    s = 2j * np.pi * f
    assert np.abs(respond(measured, s)["far"].u - respond(known, s)["far"].u).max() < 1e-8


def test_over_frequency_a_measured_load_reflects_as_its_file_says(tmp_path):
    f = frequencies()
    S = behind_cable(ANTENNA, f, TF)
    write(tmp_path / "antenna.s1p", f, S)
    load = {"at": "far", "kind": "touchstone", "file": "antenna.s1p", "tolerance": 1e-9}
    seen = respond(scene(load, folder=tmp_path), 2j * np.pi * f)["far"]
    assert np.abs(seen.b / seen.a - S).max() < 1e-9


def test_the_shipped_antenna_is_what_it_is_said_to_be(tmp_path):
    write_antenna(tmp_path / "again.s1p")
    assert (tmp_path / "again.s1p").read_text() == SHIPPED.read_text()
    load = {"at": "far", "kind": "touchstone", "file": str(SHIPPED)}
    found = scene(load).loads["one"].model
    assert (found.order, round(found.delay * 1e9, 4)) == (4, 0.7)
    Z, f = RationalFunction.from_expression(ANTENNA), frequencies(4e9, 50)
    exact = np.array([(Z(2j * np.pi * x) - 50) / (Z(2j * np.pi * x) + 50) for x in f])
    assert np.abs(found.model.at(2 * np.pi * f) - exact).max() < 2e-5  # five decimals
