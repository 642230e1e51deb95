"""Motions known in closed form, and references in 50 digits that share no code with the package."""

import json
from math import exp, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import friction
from friction import Coulomb, ElastoPlastic, Karnopp, Kind, LuGre, Ramp, Sine, Steps, Table, Tanh, Testbench, simulate

FILE = json.loads((Path(__file__).parent / "friction_cases.json").read_text(encoding="utf-8"))
NAMES = ["Stribeck", "LuGre 500", "LuGre 500, damped", "LuGre 1e5"]
EPS = np.finfo(float).eps


def static_or_bristles(parameters):
    numbers = {key: float(number) for key, number in parameters.items()}
    if "sigma0" not in numbers:
        return Karnopp(**numbers), 1e-10
    return LuGre(**{"sigma2" if key == "F_v" else key: number for key, number in numbers.items()}), 1e-9


@pytest.mark.parametrize("case", FILE["cases"], ids=NAMES)
def test_references(case):
    model, near = static_or_bristles(case["model"])
    run = simulate(model, Testbench(Ramp(0.5)), times=[float(t) for t in case["times"]])
    x, v, z = np.array(case["states"], float).T
    np.testing.assert_allclose(run.x, x, rtol=near, atol=1e-3 * near)
    np.testing.assert_allclose(run.v, v, rtol=near, atol=1e-2 * near)
    np.testing.assert_allclose(run.z, z, rtol=near, atol=1e-6 * near)
    g = 1.0 + 0.2 * np.exp(-((v / 0.1) ** 2))
    s0, s1 = float(case["model"].get("sigma0", 0)), float(case["model"].get("sigma1", 0))
    force = g + 0.05 * v if s0 == 0.0 else s0 * z + s1 * (v - s0 * v * z / g) + 0.05 * v
    np.testing.assert_allclose(run.F_f, force, rtol=near)
    assert abs(run.ledger.residual) <= 1e-12


@pytest.mark.parametrize(("slope", "end"), [(0.5, 16.0), (2.0, 90.25)])
def test_a_ramp_on_coulomb_breaks_away_and_ends_as_the_parabola_says(slope, end):
    run = simulate(Coulomb(), Testbench(Ramp(slope)))
    (event,) = run.events
    assert event.kind is Kind.BREAK_AWAY
    assert event.t == pytest.approx(1.0 / slope, rel=4 * EPS)
    assert run.v[-1] == pytest.approx(end, rel=1e-13)
    assert run.x[-1] == pytest.approx(slope / 6.0 * (10.0 - 1.0 / slope) ** 3, rel=1e-13)


def test_thrown_backwards_it_stops_sticks_and_breaks_away():
    run = simulate(Coulomb(), Testbench(Ramp(0.5), v0=-1.0))
    assert [event.kind for event in run.events] == [Kind.STOP, Kind.BREAK_AWAY]
    assert run.events[0].t == pytest.approx(2.0 * sqrt(2.0) - 2.0, rel=1e-14)
    assert run.events[1].t == pytest.approx(2.0, rel=1e-14)
    assert run.v[-1] == pytest.approx(16.0, rel=1e-13)


def test_under_a_steep_ramp_it_turns_without_sticking():
    run = simulate(Coulomb(), Testbench(Ramp(2.0), v0=-1.0))
    turn = (sqrt(5.0) - 1.0) / 2.0
    (event,) = run.events
    assert event.kind is Kind.REVERSAL
    assert event.t == pytest.approx(turn, rel=1e-14)
    assert run.v[-1] == pytest.approx(100.0 - 10.0 - (turn**2 - turn), rel=1e-13)


def test_viscous_friction_decays_as_the_exponential_says():
    run = simulate(Coulomb(F_c=0.3, F_v=0.7), Testbench(Steps([0.0], [0.0]), mass=2.0, v0=1.5), 20.0)
    rest = 0.3 / 0.7
    stop = 2.0 / 0.7 * np.log((1.5 + rest) / rest)
    assert run.events[0].t == pytest.approx(stop, rel=1e-13)
    at = run.t < stop
    np.testing.assert_allclose(run.v[at], (1.5 + rest) * np.exp(-0.35 * run.t[at]) - rest, atol=2e-14)


def test_stribeck_breaks_away_at_stiction():
    assert simulate(Karnopp(), Testbench(Ramp(0.5))).events[0].t == pytest.approx(2.4, rel=4 * EPS)


def test_coasting_down_the_stribeck_curve_takes_the_time_of_the_quadrature():
    """From far out on the bell, whose Taylor coefficients say nothing about it: t = ∫ m dv/F(v)."""
    model = Karnopp(F_v=0.0)
    run = simulate(model, Testbench(Steps([0.0], [0.0]), v0=3.0), 4.0)
    time = quad(lambda v: 1.0 / (1.0 + 0.2 * exp(-((v / 0.1) ** 2))), 0.0, 3.0, points=[0.1, 0.3, 0.6], epsabs=1e-13)[0]
    assert run.events[0].kind is Kind.STOP
    assert run.events[0].t == pytest.approx(time, abs=1e-12)


def test_a_sine_breaks_away_where_it_meets_friction():
    run = simulate(Coulomb(), Testbench(Sine(1.5, 1.0)), 2.0)
    first = np.arcsin(1.0 / 1.5) / (2.0 * np.pi)
    assert run.events[0].t == pytest.approx(first, rel=1e-13)

    def velocity(t):
        return 1.5 / (2.0 * np.pi) * (np.cos(2.0 * np.pi * first) - np.cos(2.0 * np.pi * t)) - (t - first)

    assert run.events[1].t == pytest.approx(brentq(velocity, 0.4, 0.6, xtol=1e-15), rel=1e-13)


def test_stick_slip_of_coulomb_with_stiction_has_its_closed_period():
    """v_s tiny: friction is F_s at rest and F_c in slip, an arc of a circle in the phase plane."""
    k, speed = 20.0, 0.05
    run = simulate(Karnopp(F_v=0.0, v_s=1e-12), Testbench(Ramp(0.0), spring=friction.Spring(k, speed)), 30.0)
    breaks = [event.t for event in run.events if event.kind is Kind.BREAK_AWAY]
    w, a = sqrt(k), 0.2 / k
    slip = 2.0 * (np.pi - np.arctan(a * w / speed)) / w
    stick = (2.0 * 0.2) / (k * speed)
    assert np.diff(breaks) == pytest.approx(slip + stick, rel=1e-5)


def test_tables_and_steps_are_taken_corner_by_corner():
    pushed = simulate(Coulomb(), Testbench(Steps([1.0, 2.0], [3.0, 0.0])), 10.0)
    assert [(event.kind, event.t) for event in pushed.events] == [
        (Kind.BREAK_AWAY, 1.0),
        (Kind.STOP, pytest.approx(4.0)),
    ]
    assert pushed.x[-1] == pytest.approx(1.0 + 2.0, rel=1e-14)
    table = simulate(Coulomb(), Testbench(Table([0.0, 1.0, 3.0], [0.0, 2.0, 2.0])), 3.0)
    assert table.v[-1] == pytest.approx(0.25 + 2.0, rel=1e-14)


@pytest.mark.parametrize(
    "model", [LuGre(), LuGre(sigma1=20.0), ElastoPlastic(), ElastoPlastic(sigma1=3.0), friction.Dahl(), Tanh()]
)
def test_smooth_models_agree_with_scipy(model):
    """An eighth-order method with tight tolerances, stopped at each change of v; the laws are written out here."""
    from scipy.integrate import solve_ivp

    law = model.law

    def rates(t, y):
        v, z = y[1], y[2]
        g = law.f_c + (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
        if isinstance(model, Tanh):
            force, rate = g * np.tanh(v / model.epsilon) + model.F_v * v, 0.0
        else:
            share = 1.0
            if isinstance(model, ElastoPlastic):
                low, high = model.z_ba, g / model.sigma0
                share = 0.5 + 0.5 * np.sin(np.pi * (min(max(abs(z), low), high) - 0.5 * (low + high)) / (high - low))
                share *= v * z > 0.0
            rate = v - share * law.sigma0 * abs(v) * z / g
            force = law.sigma0 * z + law.sigma1 * rate + law.f_v * v
        return [v, 1.3 * np.sin(2.0 * np.pi * t) - force, rate]

    def at_rest(t, y):
        return y[1]

    at_rest.terminal = True
    t, y = 0.0, np.zeros(3)
    while t < 1.2:
        done = (
            solve_ivp(
                rates, (t, 1.2), y, "DOP853", rtol=1e-11, atol=1e-14, events=at_rest if t > 0.0 else None, max_step=0.02
            )
            if t
            else (solve_ivp(rates, (0.0, 0.01), y, "DOP853", rtol=1e-11, atol=1e-14))
        )
        t, y = done.t[-1], done.y[:, -1]
        if t < 1.2 and done.status == 1:
            nudge = solve_ivp(rates, (t, t + 1e-9), y, "DOP853", rtol=1e-11, atol=1e-15)
            t, y = nudge.t[-1], nudge.y[:, -1]
    run = simulate(model, Testbench(Sine(1.3, 1.0)), 1.2, times=[1.2])
    assert run.status is friction.Status.DONE
    np.testing.assert_allclose([run.x[0], run.v[0], run.z[0]], y, rtol=1e-7, atol=1e-9)
