"""Jumps and corners at any instant into lossy lines, against inverse Laplace; the clock of a scene changes no cost."""

import numpy as np
import pytest
from one_line import one_line

from tline import Scene, simulate
from tline.study.reference.lossy import LossySolution

RNG = np.random.default_rng(20)
INSTANTS = RNG.uniform(0.0, 3e-9, 10)
SEEN = RNG.uniform(0.1e-9, 20e-9, 25)
DIODE = {"d": {"at": "far", "kind": "diode", "saturation": "1 uA"}}


def cable(value, *, start="rest", loads=None, **losses) -> Scene:
    """0.2 m of 50 ohm, 1 ns, between 25 ohm and 100 ohm."""
    line = {"length": "0.2 m", "z0": 50, "delay": "1 ns"} | (losses or {"resistance": "20 ohm/m"})
    loads = {"r": {"at": "far", "kind": "resistor", "resistance": 100}, **(loads or {})}
    return one_line("20 ns", line, value, 25, start=start, loads=loads)


def step(at: float, **more):
    return {"shape": "step", "to": 1, "at": at} | more


def samples(result) -> int:
    return sum(attempt.samples for attempt in result.accuracy.attempts)


def check(scene: Scene, tol: float) -> None:
    """The run meets its tolerance, and its curve keeps it at instants of all kinds."""
    result = simulate(scene, tol=tol)
    assert result.accuracy.met
    for where, probe in result.probes.items():
        exact = LossySolution(scene, where).at([repr(float(t)) for t in SEEN], digits=14)
        assert np.abs(probe.at(SEEN).u - np.array(exact.u, float)).max() < 3 * tol
        assert 50 * np.abs(probe.at(SEEN).y - np.array(exact.y, float)).max() < 3 * tol


@pytest.mark.parametrize("at", INSTANTS[:4])
@pytest.mark.parametrize("losses", [{"resistance": "20 ohm/m"}, {"resistance": "50 ohm/m", "conductance": "5 mS/m"}])
def test_a_step_at_any_instant(at, losses):
    check(cable(step(at), **losses), 1e-8)


def test_a_step_at_any_instant_takes_as_many_samples_as_one_at_the_start():
    most = 2 * samples(simulate(cable(step(0.0)), tol=1e-8))
    assert all(samples(simulate(cable(step(float(at))), tol=1e-8)) <= most for at in INSTANTS)


@pytest.mark.parametrize(
    "value",
    [
        {"shape": "pulses", "high": 1, "at": "0.3337 ns", "width": "0.41 ns"},
        {
            "shape": "pulses",
            "low": 0.5,
            "high": 1,
            "at": "0.3337 ns",
            "width": "0.2 ns",
            "rise": "7 ps",
            "fall": "0.1 ns",
        },
        {"shape": "ramp", "to": 1, "at": "0.3337 ns", "duration": "0.1 ps"},
        {"shape": "pulses", "high": 1, "at": "0.1 ns", "width": "0.41 ns", "period": "3.37 ns"},
        step("0.77 ns", **{"from": 1}),  # the jump at t = 0, from rest, is in another family
    ],
)
def test_fronts_at_several_places_of_their_slabs_each_have_their_own(value):
    check(cable(value), 1e-8)


def test_a_family_of_fronts_takes_a_run():
    once, pulses = cable(step("0.3337 ns")), {"shape": "pulses", "high": 1, "at": "0.3337 ns", "width": "0.41 ns"}
    assert samples(simulate(cable(pulses), tol=1e-8)) <= 2 * samples(simulate(once, tol=1e-8))


@pytest.mark.parametrize("start", ["rest", "steady"])
@pytest.mark.parametrize("loads", [{}, DIODE])
def test_a_scene_does_the_same_later(start, loads):
    """Also one that is not linear, if its fronts are whole slabs apart: it has slabs that begin earlier."""
    late = 0.3337e-9
    scenes = [cable(step(at, **{"from": 0.0}), start=start, loads=loads) for at in (0.0, late)]
    one, other = (simulate(scene, tol=1e-7, envelope=True) for scene in scenes)
    assert one.accuracy.met
    assert other.accuracy.met
    t = SEEN[SEEN < 19e-9]
    for where, probe in one.probes.items():
        # slabs that are held in pieces keep their own polynomials between their ends, others do not
        assert other.probes[where].at(t + late).u == pytest.approx(probe.at(t).u, abs=1e-8)
    assert other.envelope.highest == pytest.approx(one.envelope.highest, rel=1e-7)
    assert samples(other) <= 2 * samples(one)


def test_a_curved_source_is_late_as_a_whole():
    value = {"shape": "double exponential", "peak": 1, "rise": "0.3 ns", "decay": "3 ns"}
    early, late = (simulate(cable(value | {"at": at}), tol=1e-7) for at in ("0 ns", "0.3337 ns"))
    t = SEEN[SEEN < 19e-9]
    assert late.accuracy.met
    assert late.probes["far"].at(t + 0.3337e-9).u == pytest.approx(early.probes["far"].at(t).u, abs=2e-7)


def test_a_memory_is_as_far_at_any_instant():
    skin = {"skin": {"resistance": "10 ohm/m", "frequency": "100 MHz"}}
    one, other = (simulate(cable(step(at), **skin), tol=1e-3) for at in (0.0, 0.3337e-9))
    assert samples(other) <= 2 * samples(one)
    t = SEEN[SEEN < 19e-9]
    left_out = one.resolution.layers  # changes by narrower slabs, of the largest wave
    assert left_out < 3e-6
    assert other.probes["near"].at(t + 0.3337e-9).u == pytest.approx(one.probes["near"].at(t).u, abs=left_out)


def test_a_train_of_pulses_into_skin_effect():
    """Many corners that are whole numbers of 0.1 ns apart are all at edges of slabs while that is enough."""
    value = {"shape": "pulses", "high": 1, "at": "0.2 ns", "rise": "0.1 ns", "width": "0.3 ns", "fall": "0.2 ns"}
    scene = cable(value | {"period": "1.6 ns", "count": 10}, skin={"resistance": 60, "frequency": "10 GHz"})
    exact = {where: LossySolution(scene, where).at([repr(float(t)) for t in SEEN], digits=10) for where in scene.probes}
    for tol in (1e-4, 1e-6):
        result = simulate(scene, tol=tol)
        assert result.accuracy.met
        assert samples(result) < 1e6
        for where, probe in result.probes.items():
            off = np.abs(probe.at(SEEN).u - np.array(exact[where].u, float)).max()
            assert off < 3 * result.accuracy.worst, (tol, where)
