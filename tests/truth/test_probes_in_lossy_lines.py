"""Probes inside lossy lines: against inverse Laplace at their places, and the textbook's grid with Darcy's friction."""

import math

import numpy as np
import pytest
from lossy_scenes import cable, pipe

from tline import Scene, simulate
from tline.study.reference.friction import FrictionSolution
from tline.study.reference.lossy import Drive, lossy_response

SKIN = {"resistance": 1, "skin": {"resistance": 40, "frequency": "1 GHz"}}
ZIELKE = {"kind": "zielke", "viscosity": "0.0347 Pa s"}
DIODE = {"d": {"at": "b", "kind": "diode", "saturation": "1e-12 A"}}
LATER = np.array([0.05, 0.31, 0.65, 1.4, 2.41, 4.9, 7.13])  # delays behind the first front, and not beside others


def probed(scene: Scene, position: str, **more) -> Scene:
    probes = {"inner": {"line": "line", "position": position}, "far": {"at": "b"}}
    return Scene(**scene.table() | {"probes": probes} | more)


def exact(scene: Scene, share: float, t, load: float, drive: Drive = Drive.STEP):
    line, source = scene.lines["line"].losses.exact, float(scene.sources["s"].resistance)
    at = [repr(float(x)) for x in t]
    found = lossy_response(line, at, share * line.length, source=source, load=load, digits=12, drive=drive)
    return np.array(found.u, float), np.array(found.y, float)


def off(probe, t, u, y) -> float:
    """Largest error, of effort and flow, each over its amplitude."""
    seen = probe.at(t)
    return max(np.abs(seen.u - u).max() / np.abs(probe.u).max(), np.abs(seen.y - y).max() / np.abs(probe.y).max())


@pytest.mark.parametrize("tol", [1e-3, 1e-6])
@pytest.mark.parametrize(
    ("losses", "share"),
    [
        ({"resistance": 20, "conductance": 0.02}, 0.37),  # segments
        ({"resistance": 20, "conductance": 0.02}, 0.6172),  # no slab divides both delays
        ({"resistance": 200}, 0.0123),
        (SKIN, 0.5),
        (SKIN, 0.123456),
    ],
)
def test_a_step_on_a_cable(losses, share, tol):
    scene = probed(cable(t_end="9 ns", **losses), f"{100 * share!r} %")
    result, t = simulate(scene, tol=tol), (share + LATER) * 1e-9
    probe, told = result.probes["inner"], result.accuracy.estimates["inner"]
    error = off(probe, t, *exact(scene, share, t, 100))
    assert result.accuracy.met
    assert error <= 3 * tol
    assert error <= 3 * max(told.u, told.y) + 1e-10  # rounding of transforms


@pytest.mark.parametrize("friction", [{"kind": "laminar", "viscosity": "0.0347 Pa s"}, ZIELKE])
def test_a_ramp_into_a_pipe(friction):
    """An endless ramp of pressure, 1 Pa a second, seen a third of the way from the closed end."""
    value = {"shape": "ramp", "to": 0.3, "duration": 0.3}
    scene, tol = probed(pipe(value, friction=friction), "24.06 m"), 1e-5
    result, t = simulate(scene, tol=tol), (2 / 3 + LATER) * 36.09 / 1324
    assert result.accuracy.met
    assert off(result.probes["inner"], t, *exact(scene, 2 / 3, t, math.inf, Drive.RAMP)) <= 3 * tol


def test_a_valve_that_shuts_behind_a_pipe_with_darcys_friction():
    """Beside two pipes in the reference, whose nodes are where it knows the pressure."""
    pipe = {"length": "400 m", "diameter": 0.5, "wave_speed": 1000, "density": 1000, "nodes": ["tank", "valve"]}
    pipe |= {"friction": {"kind": "darcy", "factor": 0.03}}
    halves = [pipe | {"length": 100, "nodes": ["tank", "m"]}, pipe | {"length": 300, "nodes": ["m", "valve"]}]
    shut = {"shape": "ramp", "from": -0.4, "to": 0, "duration": 0.8}
    given = {
        "medium": "hydraulic",
        "t_end": 3,
        "start": "steady",
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": 1e6}},
        "sources": {"valve": {"at": "valve", "kind": "flow", "value": shut}},
    }
    scene = Scene(**given, lines={"p": pipe}, probes={"m": {"line": "p", "position": "25 %"}})
    parts = Scene(**given, lines=dict(zip("pq", halves, strict=True)), probes={"m": {"at": "m", "line": "p"}})
    result, t = simulate(scene, tol=1e-4), np.linspace(0, 3, 997)
    reference = FrictionSolution(parts, 512)
    size = np.abs(result.probes["m"].u).max()
    assert result.accuracy.met
    assert reference.error < 1e-6 * size
    assert np.abs(result.probes["m"].at(t).u - reference.at("m", t)).max() < 3e-4 * size


def test_what_a_probe_sees_changes_nothing_else():
    """Beside a diode no solution is known; the far end is what it is without the probe, and the ledger adds up."""
    ramp = {"shape": "ramp", "to": 3, "at": "0.3337 ns", "duration": "0.4 ns"}
    scene = cable(ramp, t_end="6 ns", resistance=20)
    loads, tol, t = scene.table()["loads"] | DIODE, 1e-4, np.linspace(0, 6e-9, 701)
    whole = simulate(Scene(**scene.table() | {"loads": loads}), tol=tol).probes["far"].at(t)
    result = simulate(probed(scene, "37 %", loads=loads), tol=tol, ledger=True, record=["line"], envelope=True)
    seen = result.probes["far"].at(t)
    assert result.accuracy.met
    assert np.abs(seen.u - whole.u).max() < 3 * tol * np.abs(whole.u).max()
    assert not [entry.where for entry in result.ledger.entries if "stretch" in entry.where or "inner" in entry.where]
    assert list(result.lines) == ["line"]
    assert result.envelope.nodes == ("a", "b")
    a, b = result.lines["line"].waves(t, 0.37)
    assert (a + b) / 2 == pytest.approx(result.probes["inner"].at(t).u, abs=1e-12)
