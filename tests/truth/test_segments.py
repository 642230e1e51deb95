"""Lossy lines in segments against inverse Laplace in 9 to 20 digits, with one slab per transit or a few."""

import numpy as np
import pytest
from one_line import one_line

from tline import Scene, simulate
from tline.loss import LossyLine
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.reference.lossy import lossy_response

T, LENGTH, SOURCE, LOAD = 1e-9, 0.2, 25.0, 75.0
STEP = {"shape": "step", "to": 1}


def cable(**losses) -> Scene:
    return one_line("20 ns", {"length": LENGTH, "z0": 50, "delay": T, **losses}, STEP, SOURCE, LOAD)


def exact(scene: Scene, t: np.ndarray, probe: str, digits: int = 20):
    line = scene.lines["line"].losses
    assert line is not None
    assert isinstance(line.exact, LossyLine)
    x = 0.0 if probe == "near" else LENGTH
    found = lossy_response(line.exact, [repr(float(each)) for each in t], x, source=SOURCE, load=LOAD, digits=digits)
    return found.efforts, found.flows


@pytest.mark.parametrize(("order", "error"), [(2, 3e-5), (3, 3e-7), (4, 2e-9), (6, 1e-13), (8, 3e-13)])
def test_a_step_on_a_cable_with_resistance_needs_one_slab_per_transit(order, error):
    """Figures of the method itself, twice what was found; at s = 6 and 8 rounding is left."""
    scene = cable(resistance=20)
    result = run(describe(scene), Resolution(order, T))
    even = np.arange(2, 20, 2)  # fronts reach the far end at odd multiples, and the near end at even ones
    for probe, k in (("far", even), ("near", even + 1)):
        u, y = exact(scene, result.t[k], probe)
        assert np.abs(result.probes[probe].u[k] - u).max() < error
        assert 50 * np.abs(result.probes[probe].y[k] - y).max() < error


def test_leakage_and_resistance_together():
    scene = cable(resistance=30, conductance="5 mS/m")
    result = run(describe(scene), Resolution(6, T / 2))
    t = result.t[np.round(result.t / T * 2).astype(int) % 2 == 1][1:]
    for probe in ("near", "far"):
        u, y = exact(scene, t, probe)
        assert result.probes[probe].at(t).u == pytest.approx(u, abs=1e-12)
        assert 50 * result.probes[probe].at(t).y == pytest.approx(50 * y, abs=1e-12)


def test_the_error_falls_with_the_slab_at_the_order_at_least():
    scene, errors = cable(resistance=20), []
    for slabs in (1, 2, 4):
        result = run(describe(scene), Resolution(2, T / slabs))
        k = np.arange(2, 20, 2) * slabs
        errors.append(np.abs(result.probes["far"].u[k] - exact(scene, result.t[k], "far")[0]).max())
    assert np.log2(errors[0] / errors[2]) / 2 > 2 - 0.3


def test_skin_effect_a_slab_behind_the_front():
    """Circuits of 1e-6 over the band; from the third slab behind each front on, 1e-4 of the step at four slabs."""
    scene = cable(skin={"resistance": "10 ohm/m", "frequency": "100 MHz"})
    result = run(describe(scene), Resolution(4, T / 8, fit=1e-6))
    t = result.t[1:]
    k = np.round(t / T * 8).astype(int)
    t = t[(k > 8) & ((k - 8) % 16 >= 3)][::3]
    assert result.probes["far"].at(t).u == pytest.approx(exact(scene, t, "far", 9)[0], abs=3e-5)


@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_behind_a_step_into_skin_effect_a_tolerance_is_kept_but_near_the_front_where_errors_are_told(tol):
    result = simulate(cable(skin={"resistance": "10 ohm/m", "frequency": "100 MHz"}), tol=tol)
    behind, near = T * np.array([1.0101, 1.05, 1.7]), T * np.array([0.9999, 1.0003, 1.001, 1.004])
    off, told = (
        np.abs(result.probes["far"].at(t).u - exact(result.scene, t, "far", 9)[0]).max() for t in (behind, near)
    )
    assert result.accuracy.met
    assert off < tol
    assert told < 1.5 * result.accuracy.blurred["far"].u
    assert any("no tolerance is asked there" in note for note in result.remarks)
    k = np.round(result.t / result.resolution.h).astype(int)
    per_transit = round(T / result.resolution.h)
    chosen = (k > per_transit) & (k % per_transit > per_transit // 64) & (k % (per_transit // 16 + 1) == 0)
    for where in ("near", "far"):
        u = result.probes[where].u[chosen][::3]
        assert u == pytest.approx(exact(result.scene, result.t[chosen][::3], where, 9)[0], abs=tol)
