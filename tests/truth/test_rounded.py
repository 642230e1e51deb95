"""Runs whose delays are rounded to whole slabs: extremes against closed forms, and against runs that round nothing."""

from math import pi

import numpy as np
import pytest

import tline as tl

PIPE = {"diameter": 0.3, "wave_speed": 1000, "density": 1000}
Z0 = 1000 * 1000 / (pi / 4 * 0.3**2)


def scene(lengths, *, takes: float = 0.3, friction: bool = False, **solver) -> tl.Scene:
    """A tee between two lakes: a tap at its third end shuts."""
    ends = {"a": "lake", "b": "tower", "c": "tap"}
    rough = {"friction": {"kind": "hazen-williams", "coefficient": 110}} if friction else {}
    lines = {
        name: {"nodes": [end, "tee"], "length": length, **PIPE, **rough}
        for (name, end), length in zip(ends.items(), lengths, strict=True)
    }
    shut = {"shape": "ramp", "from": 1, "to": 0, "at": 0.2, "duration": takes}
    tap = {"at": "tap", "kind": "orifice", "flow": 0.05, "pressure_drop": 6e5, "opening": shut}
    lakes = {end: {"at": end, "kind": "reservoir", "pressure": 6e5} for end in ("lake", "tower")}
    return tl.Scene(
        medium="hydraulic", t_end=4, start="steady", lines=lines, loads=lakes | {"tap": tap},
        probes={"tap": {"at": "tap"}}, solver={"rounded": True} | solver,
    )  # fmt: skip


def test_joukowskys_rise_on_whole_slabs():
    probe = tl.simulate(scene([200, 300, 400], takes=1e-6, tol=1e-2)).probes["tap"]
    assert probe.at(0.5).u == pytest.approx(probe.u[0] + Z0 * abs(probe.y[0]), rel=1e-9)


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_extremes_are_within_their_errors(seed, friction):
    """Of runs by polynomials in slabs, with delays as they are."""
    lengths = np.random.default_rng(seed).uniform(150, 700, 3).tolist()
    found = tl.simulate(scene(lengths, friction=friction, tol=3e-3), envelope=True)
    exact = tl.simulate(scene(lengths, friction=friction, rounded=False, tol=1e-5), envelope=True).envelope
    assert found.accuracy.met
    seen, weight = found.envelope, 3e-3 * found.envelope.highest.max()
    assert np.abs(seen.highest - exact.highest).max() < weight
    assert np.abs(seen.lowest - exact.lowest).max() < weight


def test_pipes_shorter_than_a_slab_are_one_slab_long():
    given = scene([200, 300, 1], slab=0.02)
    assert tl.simulate(given, record=["c"]).lines["c"].delay == pytest.approx(0.02)
    with pytest.raises(tl.SceneError, match=r"solver\.order: delays are rounded in the first order alone, expected 1"):
        scene([200, 300, 1], order=3)


def test_what_the_time_leaves_is_told():
    found = tl.simulate(scene([211, 307, 401], tol=1e-9), seconds=1e-3)
    assert not found.accuracy.met
    assert found.accuracy.limit == "a finer run would take the total beyond 0.001 s"
    assert 1e-9 < found.accuracy.worst < 0.1
