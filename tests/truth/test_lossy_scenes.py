"""Runs of lossy lines against responses by inverse Laplace, closed forms, and a method of its own for friction."""

import math

import numpy as np
import pytest
from lossy_scenes import cable, pipe

from tline import Scene, simulate
from tline.frequency.response import respond
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.reference.lossy import Drive, lossy_response

T = 36.09 / 1324
VISCOSITY = "0.0347 Pa s"


def exact(scene: Scene, t, where: str, load: float, digits: int = 13, drive: Drive = Drive.STEP) -> np.ndarray:
    line = scene.lines["line"].losses.exact
    source = float(scene.sources["s"].resistance)
    position = 0.0 if where == "near" else line.length
    found = lossy_response(
        line, [repr(float(x)) for x in t], position, source=source, load=load, digits=digits, drive=drive
    )
    return np.array([float(u) for u in found.u])


def at_ends(result, chosen: int = 12) -> np.ndarray:
    """Some slab ends over the whole run, among them those right behind fronts, but none that a front passes."""
    per_delay = round(float(result.scene.lines["line"].parameters.delay) / result.resolution.h)
    n = result.slabs.whole
    k = np.unique([1, 2, per_delay + 1, 2 * per_delay + 1, *np.linspace(3, n, chosen).astype(int)])
    return k[k % per_delay > 0]


@pytest.mark.parametrize("tol", [1e-5, 1e-8])
@pytest.mark.parametrize("losses", [{"resistance": 20}, {"resistance": 200, "conductance": 0.02}])
def test_a_step_on_a_cable_over_twenty_transits(losses, tol):
    scene = cable(**losses)
    result = simulate(scene, tol=tol)
    assert result.accuracy.met
    k = at_ends(result)
    for where in ("near", "far"):
        u = result.probes[where].u[k]
        assert np.abs(u - exact(scene, k * result.resolution.h, where, 100)).max() < tol  # of a step of 1 V


def test_a_ramp_on_a_cable_is_the_difference_of_two_endless_ones():
    scene, rise = cable({"shape": "ramp", "to": 1, "duration": "0.1 ns"}, resistance=20), 1e-10
    result = simulate(scene, tol=1e-8)
    k = at_ends(result)[2:]
    t = k * result.resolution.h
    u = (exact(scene, t, "far", 100, drive=Drive.RAMP) - ramped_later(scene, t, rise)) / rise
    assert result.accuracy.met
    assert np.abs(result.probes["far"].u[k] - u).max() < 1e-8


def ramped_later(scene, t, rise):
    later = t > rise + 1e-15
    values = np.zeros(len(t))
    values[later] = exact(scene, t[later] - rise, "far", 100, drive=Drive.RAMP)
    return values


@pytest.mark.parametrize(
    ("line", "tol"),
    [
        ({"friction": {"kind": "laminar", "viscosity": VISCOSITY}}, 1e-7),
        ({"friction": {"kind": "linear", "resistance": "5e8 Pa s/m^4"}}, 1e-7),
        (
            {
                "wall_thickness": "2 mm",
                "creep": [{"compliance": "1e-10 1/Pa", "time": "50 ms"}, {"compliance": "1e-11 1/Pa", "time": "5 ms"}],
            },
            1e-6,
        ),
    ],
)
def test_a_step_of_pressure_into_a_closed_pipe(line, tol):
    scene = pipe(**line)
    result = simulate(scene, tol=tol)
    k = at_ends(result)
    k = k[k * result.resolution.h > 1.001 * T]
    assert result.accuracy.met
    # estimates are relative to the amplitude, nearly 2
    assert np.abs(result.probes["far"].u[k] - exact(scene, k * result.resolution.h, "far", math.inf)).max() < 2 * tol


@pytest.mark.parametrize("tol", [1e-4, 1e-8])
def test_a_wall_that_creeps_keeps_its_tolerance_inside_slabs(tol):
    """The samples' slabs are a quarter of a transit; the curve between them is that of the run's own narrower slabs."""
    creep = [{"compliance": "2e-10 1/Pa", "time": "2 ms"}, {"compliance": "1e-11 1/Pa", "time": "5 ms"}]
    scene = pipe(wall_thickness="2 mm", creep=creep)
    result, delay = simulate(scene, tol=tol), float(scene.lines["line"].parameters.delay)
    t = delay * np.array([1.03, 1.2, 1.6, 2.1, 3.07, 3.4, 5.1])
    off = np.abs(result.probes["far"].at(t).u - exact(scene, t, "far", math.inf)).max()
    told = result.accuracy.inside["far"].u * np.abs(result.probes["far"].u).max()
    assert result.accuracy.met
    assert off < 1.5 * told


def test_laminar_friction_of_any_speed():
    """One run of 96 samples a transit and end, at all slab ends from the first front on.

    The largest errors are those of the slab behind a front, and depend on the circuit: with tolerances of 1e-6 to 1e-4
    in place of a run's 1e-7 they are 0.96e-3 to 4e-3; 2.5e-4 elsewhere.
    """
    scene = pipe(friction={"kind": "zielke", "viscosity": VISCOSITY})
    rough = run(describe(scene), Resolution(6, T / 16), slabs=11 * 16)
    k = np.arange(17, 176)
    assert np.abs(rough.probes["far"].u[k] - exact(scene, k * T / 16, "far", math.inf, 7)).max() < 2e-3  # 1.2e-3


def test_laminar_friction_of_any_speed_to_a_tolerance_behind_a_step():
    scene = pipe(friction={"kind": "zielke", "viscosity": VISCOSITY})
    result = simulate(scene, tol=1e-5)
    far = result.probes["far"]
    t = far.t[(far.t > T) & (np.abs(far.t / T % 2 - 1) > 0.01)][::50]
    assert result.accuracy.met  # but for a hundredth of the delay beside fronts
    assert np.abs(far.at(t).u - exact(scene, t, "far", math.inf, 9)).max() < 1e-5


def test_laminar_friction_of_any_speed_to_a_tolerance_behind_a_ramp():
    scene = pipe({"shape": "ramp", "to": 1, "duration": T / 2}, friction={"kind": "zielke", "viscosity": VISCOSITY})
    result = simulate(scene, tol=1e-6)
    k = at_ends(result, 6)
    t = k * result.resolution.h
    k, t = k[t > 1.6 * T], t[t > 1.6 * T]
    ramps = [exact(scene, t - begin, "far", math.inf, 11, Drive.RAMP) for begin in (0.0, T / 2)]
    assert result.accuracy.at_slab_ends <= 1e-6
    assert np.abs(result.probes["far"].u[k] - (ramps[0] - ramps[1]) / (T / 2)).max() < 1e-6


def test_a_line_without_distortion_only_delays_and_attenuates():
    scene = cable(load=50, resistance=20, conductance=8e-3)  # R/L = G/C
    result = run(describe(scene), Resolution(3, 1e-10))
    after = result.t > 1.05e-9
    loss = math.exp(-0.2 * math.sqrt(20 * 8e-3))
    assert result.probes["far"].u[after] == pytest.approx(50 / 75 * loss, rel=1e-14)
    assert result.probes["near"].u[5] == pytest.approx(50 / 75, rel=1e-14)


def textbook(scene: Scene, n: int) -> np.ndarray:
    """Effort at the closed end, on a grid of n reaches: flow and pressure, friction by the trapezoidal rule."""
    line = scene.lines["line"]
    z0, K = line.parameters.z0, line.losses.quadratic * line.losses.exact.length / n
    steps = round(float(scene.t_end) / float(line.parameters.delay) * n)
    u, y = np.zeros(n + 1), np.zeros(n + 1)
    seen = [0.0]
    for step in range(1, steps + 1):
        plus = u[:-1] + z0 * y[:-1] - K / 2 * np.abs(y[:-1]) * y[:-1]
        minus = u[1:] - z0 * y[1:] + K / 2 * np.abs(y[1:]) * y[1:]
        drive = np.float64(scene.sources["s"].value.value(np.array(step * T / n), np.array((step - 0.5) * T / n)))
        w = np.concatenate([[2 * (drive - minus[0])], plus[:-1] - minus[1:], [0.0]])
        # 2 z0 y + K |y| y = w inside and, doubled, at the source
        y = w / (z0 + np.sqrt(z0**2 + K * np.abs(w)))
        u = np.concatenate([[drive], (plus[:-1] + minus[1:]) / 2, [plus[-1]]])
        y[-1] = 0.0
        seen.append(u[-1])
    return np.array(seen)


def test_quadratic_friction_against_the_textbook_method_extrapolated():
    value = {"shape": "ramp", "to": "30 bar", "duration": f"{T} s"}
    scene = pipe(value, t_end=6 * T, friction={"kind": "darcy", "factor": 8.0})
    result = simulate(scene, tol=1e-7)
    coarse, fine, finest = (textbook(scene, n) for n in (128, 256, 512))
    once, twice = ((4 * fine[::2] - coarse) / 3)[::2], ((4 * finest[::2] - fine) / 3)[::4]  # at even points
    scale = np.abs(twice).max()
    assert np.abs(twice - once).max() < 1e-7 * scale  # so good is the reference
    grid = np.arange(len(twice)) * T / 64
    places = grid / result.resolution.h
    common = np.abs(places - places.round()) < 1e-9
    ours = result.probes["far"].at(grid).u
    assert common.sum() > 40
    assert np.abs(ours - twice)[common].max() < 1e-7 * scale
    lossless = 2 * 30e5
    assert np.abs(ours).max() < 0.9 * lossless  # friction shows


@pytest.mark.parametrize(
    "losses",
    [
        {"resistance": 20},
        {"resistance": 5, "skin": {"resistance": 60, "frequency": "10 GHz"}},
        {"loss_tangent": {"value": 0.02, "frequency": "1 GHz", "low": "10 MHz", "high": "100 GHz"}},
    ],
)
def test_a_sine_settles_to_the_exact_transfer_function(losses):
    f = 0.4e9
    value = {"shape": "sine", "amplitude": 1, "frequency": f}
    scene = cable(value, t_end="40 ns", **losses)
    result = simulate(scene, tol=1e-4)
    t = result.t[-round(2.5e-9 / result.resolution.h) :]  # a period
    basis = np.stack([np.sin(2 * np.pi * f * t), np.cos(2 * np.pi * f * t)], axis=1)
    for where in ("near", "far"):
        s, c = np.linalg.lstsq(basis, result.probes[where].at(t).u)[0]
        assert abs(s + 1j * c - respond(scene, 2j * np.pi * f)[where].u) < 1e-4


def test_inside_a_lossy_line_effort_and_flow_obey_its_equations():
    table = cable(resistance=20).table()
    places = {f"x{k}": {"line": "line", "position": f"{k} mm"} for k in ("99.9", "100", "100.1")}
    scene = Scene(**table | {"probes": places})
    s, line = 2j * np.pi * 0.3e9, scene.lines["line"].losses.exact
    u, y = ([getattr(respond(scene, s)[f"x{k}"], q) for k in ("99.9", "100", "100.1")] for q in "uy")
    assert (u[2] - u[0]) / 2e-4 == pytest.approx(-line.series.at(s) * y[1], rel=1e-6)
    assert (y[2] - y[0]) / 2e-4 == pytest.approx(-line.shunt.at(s) * u[1], rel=1e-6)
