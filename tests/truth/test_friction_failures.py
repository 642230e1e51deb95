"""Where methods fail: formulas, derived on paper, against what the methods do."""

from math import inf, log, sqrt

import numpy as np
import pytest

import friction
from friction import Coulomb, Karnopp, Kind, LuGre, Ramp, Sine, Status, Tanh, Testbench, dead_zone, limits, simulate

NEAR = 0.02  # what a prediction may miss


@pytest.mark.parametrize(("slope", "h", "F_c", "mass"), [(0.5, 1e-3, 1.0, 1.0), (0.1, 1e-3, 0.7, 2.5)])
def test_euler_on_the_sign_law_is_a_modulator(slope, h, F_c, mass):
    run = simulate(Coulomb(F_c), Testbench(Ramp(slope), mass), F_c / slope, "euler", h=h)
    told = friction.euler_chatter(F_c, slope, h, mass)
    assert np.sum(run.v[1:] * run.v[:-1] < 0.0) == pytest.approx(told.sign_changes, rel=NEAR)
    assert run.x[-1] == pytest.approx(told.drift, rel=NEAR)
    assert run.W_f[-1] == pytest.approx(told.friction_work, rel=NEAR)
    assert run.kinetic.mean() == pytest.approx(told.kinetic_energy, rel=NEAR)
    low, high = h * (run.F_a - F_c) / mass, h * (run.F_a + F_c) / mass
    assert np.all((run.v >= low - h * slope * h) & (run.v <= high + h * slope * h))


def test_an_adaptive_solver_on_the_sign_law_takes_steps_like_one_over_its_tolerance():
    steps = [
        simulate(Coulomb(), Testbench(Ramp(0.5)), 0.1, "rk45", tol=tol, budget=50_000).steps
        for tol in (1e-2, 1e-3, 1e-4)
    ]
    rate = log(steps[2] / steps[0]) / log(100.0)
    assert 0.8 < rate < 1.2


def test_an_adaptive_solver_keeps_to_its_budget_and_says_so():
    run = simulate(Coulomb(), Testbench(Ramp(0.5)), 10.0, "rk45", tol=1e-8, budget=500)
    assert run.status is Status.BUDGET
    assert run.steps == 500


def test_an_implicit_solver_stalls_at_the_jump():
    assert simulate(Coulomb(), Testbench(Ramp(0.5)), 10.0, "bdf", tol=1e-6).t[-1] == 0.0
    thrown = simulate(Karnopp(), Testbench(Ramp(0.5), v0=-1.0), 10.0, "bdf", tol=1e-6)
    assert thrown.status is Status.STALLED
    assert thrown.t[-1] == pytest.approx(0.8, abs=0.02)


def test_loose_tolerances_step_over_the_break_away_and_report_success():
    from scipy.integrate import solve_ivp

    def rates(t, y):
        v, z = y
        rate = v - 1e5 * abs(v) * z / (1.0 + 0.2 * np.exp(-((v / 0.1) ** 2)))
        return [0.5 * t - 1e5 * z - 0.05 * v, rate]

    done = solve_ivp(rates, (0.0, 10.0), [0.0, 0.0], "LSODA", rtol=1e-3, atol=1e-3)
    assert done.success
    assert abs(done.y[0, -1]) < 0.1  # where 13.964 is right
    assert simulate(LuGre(sigma0=1e5), Testbench(), tol=1e-4).v[-1] == pytest.approx(13.96402792, rel=1e-4)


def test_an_event_can_come_and_go_within_a_step():
    run = simulate(Karnopp(), Testbench(Sine(1.5, 1.0)), 10.0, "rk45-events", tol=1e-9)
    assert (run.status, run.events) == (Status.DONE, [])
    assert len(simulate(Karnopp(), Testbench(Sine(1.5, 1.0)), 10.0).events) == 40


def test_the_dead_zone_catches_for_certain_when_it_is_wide_enough():
    for delta in (0.006, 0.02, 0.5):
        assert dead_zone(delta, 1.0, 0.01).certain
        for v0 in np.linspace(-1.0, -0.9, 7):
            run = simulate(Karnopp(1.0, 1.0, 0.0, 0.1, delta), Testbench(Ramp(0.0), v0=float(v0)), 3.0, "euler", h=0.01)
            told = dead_zone(delta, 1.0, 0.01)
            assert told.frozen_low <= run.v[-1] <= told.frozen_high
            assert run.x[-1] - run.x[-101] == pytest.approx(run.v[-1] * 1.0, rel=1e-9)  # it creeps for ever


def test_a_narrow_dead_zone_is_missed_as_often_as_predicted():
    delta, h = 0.001, 0.01
    starts = np.linspace(-1.0, -1.0 + h, 400, endpoint=False)
    rests = [
        abs(simulate(Karnopp(1.0, 1.0, 0.0, 0.1, delta), Testbench(Ramp(0.0), v0=float(v0)), 1.5, "euler", h=h).v[-1])
        <= delta
        for v0 in starts
    ]
    assert 1.0 - np.mean(rests) == pytest.approx(dead_zone(delta, 1.0, h).escapes, rel=NEAR)


def test_the_dead_zone_makes_energy():
    run = simulate(Karnopp(1.0, 1.0, 0.0, 0.1, 0.5), Testbench(Ramp(0.5), v0=-1.0), 2.0)
    stop = 2.0 * (sqrt(1.5) - 1.0)  # v(t) = -1 + t + t²/4 = -1/2
    assert run.events[0].t == pytest.approx(stop, rel=1e-13)
    assert run.v[-1] == -0.5
    held = run.t > stop
    gained = np.interp(2.0, run.t, run.W_f) - np.interp(stop, run.t[held], run.W_f[held])
    assert gained == pytest.approx(-0.5 * 0.5 * (4.0 - stop**2) / 2.0, rel=0.01)  # −∫ F_a·δ dt


def test_tanh_gives_way():
    run = simulate(Tanh(F_s=1.0, F_v=0.0, epsilon=0.01), Testbench(friction.Steps([0.0], [0.8])), 20.0)
    assert run.v[-1] == pytest.approx(friction.tanh_creep(0.01, 0.8, 1.0), rel=1e-9)


@pytest.mark.parametrize(("low", "high"), [(0.0, 0.6), (0.3, 0.9), (0.6, 1.1)])
def test_lugre_drifts_in_each_cycle_and_others_do_not(low, high):
    cycles, period = 6, 32.0
    times = np.arange(2 * cycles + 1) * period / 2.0
    force = friction.Table(times, [low if k % 2 == 0 else high for k in range(times.size)])
    at = np.arange(3, cycles + 1) * period
    lugre = simulate(
        LuGre(v_s=10.0, sigma0=1e4, sigma1=20.0, sigma2=0.0), Testbench(force), times[-1], tol=1e-9, times=at
    )
    drift = np.diff(lugre.x).mean()
    assert drift == pytest.approx(friction.lugre_drift(lugre.model, low, high), rel=NEAR)
    assert simulate(Karnopp(), Testbench(force), times[-1]).x[-1] == 0.0
    if high < 0.95:
        model = friction.ElastoPlastic(sigma0=1e4, sigma1=20.0, z_ba=0.95e-4, v_s=10.0)
        held = simulate(model, Testbench(force), times[-1], tol=1e-9, times=at)
        assert abs(np.diff(held.x)).max() < 1e-3 * drift


def largest_stable(simulated, low, high):
    """The step at which a disturbance stops dying out, by halving."""
    for _ in range(14):
        middle = sqrt(low * high)
        low, high = (middle, high) if simulated(middle) else (low, middle)
    return low


@pytest.mark.parametrize(("method", "v"), [("euler", 4.0), ("rk4", 4.0), ("euler", 0.5), ("rk4", 12.0)])
def test_explicit_slip_limit_of_lugre(method, v):
    """The box is so heavy that it keeps its velocity."""
    model = LuGre(sigma2=0.0)
    predicted = getattr(limits(model, v, mass=1e6), method)
    assert predicted == pytest.approx(
        {"euler": 2.0, "rk4": 2.785294}[method] * float(model.g(v)) / (500.0 * v), rel=1e-3
    )

    def stable(h):
        run = simulate(model, Testbench(Ramp(0.0), 1e6, v), 400 * h, method, h=h)
        return run.status is Status.DONE and abs(run.z[-1] * 500.0 - model.g(v)) < 0.5

    assert largest_stable(stable, 0.2 * predicted, 5.0 * predicted) == pytest.approx(predicted, rel=NEAR)


@pytest.mark.parametrize("method", ["euler", "rk4"])
@pytest.mark.parametrize(("sigma0", "sigma1"), [(500.0, 5.0), (500.0, 44.7), (500.0, 200.0), (1e5, 30.0)])
def test_explicit_stick_limit_of_lugre(method, sigma0, sigma1):
    model = LuGre(F_c=1e6, F_s=1e6, sigma0=sigma0, sigma1=sigma1, sigma2=0.0)
    predicted = getattr(limits(model, 0.0), method)

    def stable(h):
        run = simulate(model, Testbench(Ramp(0.0), v0=1e-6), 2000 * h, method, h=h)
        return run.status is Status.DONE and np.abs(run.v[-20:]).max() < np.abs(run.v[:200]).max()

    assert largest_stable(stable, 0.2 * predicted, 5.0 * predicted) == pytest.approx(predicted, rel=NEAR)


def test_bristle_damping_first_enlarges_the_stick_limit_then_shrinks_it():
    best = 2.0 * sqrt(500.0)
    small, top, large = (limits(LuGre(sigma1=s, sigma2=0.0), 0.0).euler for s in (0.3 * best, best, 3.0 * best))
    assert small < top > large
    assert top == pytest.approx(2.0 / sqrt(500.0), rel=1e-6)


def test_limits_of_the_static_laws():
    assert limits(Coulomb(), 0.0).euler == 0.0
    assert limits(Coulomb(), 1.0).euler == inf
    assert limits(Coulomb(F_v=0.5), 1.0, 2.0).euler == pytest.approx(8.0)
    assert limits(Karnopp(delta=0.1), 0.05).rk4 == inf
    assert limits(Tanh(F_s=1.0, F_v=0.0, epsilon=0.01), 0.0).euler == pytest.approx(0.02)
    assert limits(friction.Dahl(), 2.0).euler == pytest.approx(2.0 / 1000.0)


def test_explicit_steps_of_the_exercise_blow_up():
    for method in ("euler", "rk4"):
        run = simulate(LuGre(), Testbench(Ramp(0.5)), 10.0, method, h=0.01)
        assert run.status is Status.BLOWN_UP
        assert 3.5 < run.t[-1] < 4.5


def test_lugre_is_passive_only_below_its_damping_bound():
    """Friction work less stored energy over cycles of a given velocity: heat of both signs beyond the bound."""
    assert friction.passive_damping(LuGre()) == pytest.approx(0.25)

    def least_heat(sigma1):
        model, least = LuGre(sigma1=sigma1), 0.0
        for v0 in (0.02, 0.06, 0.1):
            run = simulate(model, Testbench(Sine(2.0, 0.5), v0=v0), 6.0, times=np.linspace(0.0, 6.0, 6001))
            heat = run.W_f - run.bristle
            least = min(least, float(np.diff(heat).min()))
        return least

    assert least_heat(0.2) >= -1e-12


def test_through_the_stribeck_peak_rk4_loses_its_order():
    """Break-away is seen at the next step only, and the falling curve makes the error grow."""
    exact = 13.963289889871819666
    errors = [
        abs(simulate(Karnopp(), Testbench(Ramp(0.5)), 10.0, "rk4", h=h).v[-1] - exact)
        for h in (10 / 157, 10 / 627, 10 / 2511)
    ]
    assert errors[-1] > 1e-9
    assert errors[0] / errors[2] < 16.0**2.5  # far from the 16^4 of the method's order


def test_stick_slip_is_lost_with_steps_longer_than_a_slip():
    k, speed = 400.0, 0.05
    bench, model = Testbench(Ramp(0.0), spring=friction.Spring(k, speed)), Karnopp(F_v=0.0, v_s=0.01)
    true = [event.t for event in simulate(model, bench, 4.0).events if event.kind is Kind.BREAK_AWAY]
    slip = np.pi / sqrt(k)

    def period(h):
        run = simulate(model, bench, 4.0, "moreau", h=h)
        begins = [event.t for event in run.events if event.kind is Kind.BREAK_AWAY]
        return np.diff(begins).mean() if len(begins) > 1 else inf

    assert period(slip / 100.0) == pytest.approx(np.diff(true).mean(), rel=NEAR)
    assert abs(period(slip / 1.5) / np.diff(true).mean() - 1.0) > 0.2
