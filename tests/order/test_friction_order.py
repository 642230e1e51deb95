"""The error falls at the order each method declares, where the motion is smooth."""

import numpy as np
import pytest

from friction import METHODS, Coulomb, Karnopp, LuGre, Ramp, Sine, Spring, Steps, Testbench, simulate

GLIDE = (Karnopp(F_v=0.4, v_s=1.0), Testbench(Ramp(0.5), v0=2.0), 2.0)
BRISTLES = (LuGre(sigma0=20.0, sigma1=1.0, v_s=1.0, sigma2=0.4), Testbench(Ramp(2.0), v0=2.0), 1.0)


@pytest.mark.parametrize(
    ("method", "case"),
    [("euler", GLIDE), ("rk4", GLIDE), ("moreau", GLIDE), ("exponential", BRISTLES), ("rk4", BRISTLES)],
)
def test_fixed_steps(method, case):
    exact = simulate(*case).v[-1]
    steps = np.array([200, 400, 800])
    errors = [abs(simulate(*case, method, h=case[2] / n).v[-1] - exact) for n in steps]
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(METHODS[method].order, abs=0.1)


def test_moreau_stays_first_order_through_stops_and_break_aways():
    case = (Coulomb(), Testbench(Sine(2.0, 1.0, phase=0.3)), 3.0)
    exact = simulate(*case).x[-1]
    for n in (503, 2003, 8011, 32003):  # each stop is late by another part of a step: no smooth slope
        assert abs(simulate(*case, "moreau", h=3.0 / n).x[-1] - exact) < 0.3 * 3.0 / n


def test_rosenbrock_steps_grow_with_the_fifth_root_of_the_tolerance():
    case = (LuGre(sigma0=500.0, sigma1=5.0), Testbench(Sine(1.5, 0.5)), 4.0)
    tols = np.array([1e-7, 1e-9, 1e-11])
    steps = [simulate(*case, "rosenbrock", tol=tol, times=[4.0]).steps for tol in tols]
    assert -np.polyfit(np.log(tols), np.log(steps), 1)[0] == pytest.approx(1.0 / METHODS["rosenbrock"].order, abs=0.03)


@pytest.mark.parametrize("model", [LuGre(), LuGre(sigma0=1e5, sigma1=100.0)])
def test_rosenbrock_errors_stay_near_the_tolerance(model):
    exact = simulate(model, Testbench(), method="rosenbrock", tol=1e-14, times=[10.0]).v[0]
    for tol in (1e-5, 1e-7, 1e-9, 1e-11):
        found = simulate(model, Testbench(), method="rosenbrock", tol=tol, times=[10.0]).v[0]
        assert abs(found / exact - 1.0) < 3.0 * tol


def test_events_has_no_step_to_choose():
    """Splitting the run into pieces, at corners that change nothing, changes nothing but rounding."""
    times = np.linspace(0.0, 10.0, 41)
    whole = simulate(Karnopp(), Testbench(Steps([0.0], [1.5])), times=[10.0])
    pieces = simulate(Karnopp(), Testbench(Steps(times, np.full(41, 1.5))), times=[10.0])
    assert pieces.v[0] == pytest.approx(whole.v[0], rel=1e-14)


def test_steps_grow_with_the_sixteenth_root_of_the_tolerance():
    bench, tols = Testbench(Ramp(0.0), spring=Spring(20.0, 0.05)), np.array([1e-4, 1e-7, 1e-10])
    steps = [simulate(LuGre(sigma0=20.0), bench, 10.0, "taylor", tol=tol, times=[10.0]).steps for tol in tols]
    assert -np.polyfit(np.log(tols), np.log(steps), 1)[0] == pytest.approx(1.0 / METHODS["taylor"].order, abs=0.015)
