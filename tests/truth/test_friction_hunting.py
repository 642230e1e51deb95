"""A mass with stiction under PID: stick in closed form, slip by SciPy, from event to event."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import friction
from friction import PID, Coulomb, Karnopp, Kind, Ramp, Status, Testbench, harmonic_damping, simulate, swings

LAW = Karnopp(F_c=1.0, F_s=1.5, F_v=0.3, v_s=0.02)


def recursion(law, pid, mass, slips):
    """Times and places of break-aways and stops of a mass that starts at rest at x = 0, towards a target at rest."""
    t, x, pull, events = 0.0, 0.0, pid.proportional * pid.target, []
    for _ in range(slips):
        error = pid.target - x
        s = np.sign(error)
        t += (s * law.F_s - pull) / (pid.integral * error)  # the integral grows until stiction is overcome
        events.append((t, x))

        def rates(_, y, s=s):
            x, v, pull = y
            held = law.F_c + (law.F_s - law.F_c) * np.exp(-((v / law.v_s) ** 2))
            force = pull - pid.derivative * v - s * held - law.F_v * v
            return [v, force / mass, -pid.proportional * v + pid.integral * (pid.target - x)]

        def stop(_, y):
            return y[1]

        stop.terminal, stop.direction = True, -s
        run = solve_ivp(rates, (0.0, 100.0), [x, 0.0, s * law.F_s], "DOP853", events=stop, rtol=1e-12, atol=1e-15)
        t, (x, _, pull) = t + run.t[-1], run.y[:, -1]
        assert abs(pull) < law.F_s  # the mass stays
        events.append((t, x))
    return np.array(events)


@pytest.mark.parametrize(
    ("pid", "mass", "slips"),
    [
        (PID(100.0, 200.0, 5.0, 0.01), 1.0, 8),
        (PID(400.0, 900.0, 0.0, -0.003), 0.5, 8),  # ever smaller slips
        (PID(50.0, 60.0, 20.0, 0.02), 2.0, 3),  # the last one after 17 minutes
    ],
)
def test_hunting_is_that_of_the_recursion(pid, mass, slips):
    """Of SciPy at 1e-12 events are known to some 1e-10 of the time; both start a slip at v = 0 and no net force."""
    run = simulate(LAW, Testbench(Ramp(0.0), mass, controller=pid), 2000.0)
    exact = recursion(LAW, pid, mass, slips)
    found = np.array([event[1:] for event in run.events[: len(exact)]])
    assert run.status is Status.DONE
    assert [event.kind for event in run.events[:2]] == [Kind.BREAK_AWAY, Kind.STOP]
    assert np.abs(found[:, 0] - exact[:, 0]).max() < 1e-8 * exact[-1, 0]
    assert np.abs(found[:, 1] - exact[:, 1]).max() < 1e-8 * np.abs(exact[:, 1]).max()


def test_the_cycle_that_it_settles_into():
    pid = PID(100.0, 200.0, 5.0, 0.01)
    exact = recursion(LAW, pid, 1.0, 32)
    cycle = simulate(LAW, Testbench(Ramp(0.0), controller=pid), 400.0).cycle
    assert cycle.slips == 2
    assert cycle.period == pytest.approx(exact[-2, 0] - exact[-6, 0], rel=1e-8)
    assert cycle.span == pytest.approx(np.ptp(exact[-4:, 1]), rel=1e-8)
    assert cycle.change < 1e-8


def test_a_moving_target_is_followed_by_slips_one_way():
    """Between slips the integral grows as the target leaves; over whole cycles mass and target go equally far."""
    run = simulate(LAW, Testbench(Ramp(0.0), controller=PID(50.0, 10.0, 1.0, speed=0.001)), 400.0)
    assert run.cycle.slips == 1
    assert run.cycle.span == pytest.approx(0.001 * run.cycle.period, rel=1e-6)
    first, stick = run.events[0], (-50.0 + np.sqrt(50.0**2 + 2.0 * 10.0 * (1.5 - 0.001) / 0.001)) / 10.0
    assert first.t == pytest.approx(stick, rel=1e-12)  # 0.001·(50·t + 10·t²/2 + 1) = 1.5


@pytest.mark.parametrize("v", [0.01, 0.1, 3.0])
def test_damping_is_the_first_harmonic_of_friction(v):
    law = Karnopp(F_c=1.0, F_s=1.7, F_v=0.3, v_s=0.1)
    first, _ = quad(lambda x: law.steady_force(v * np.sin(x)) * np.sin(x), 0.0, np.pi, epsabs=1e-13, limit=200)
    assert harmonic_damping(law, v) == pytest.approx(2.0 * first / (np.pi * v), rel=1e-10)


def test_a_continuous_controller_by_hand():
    """ω = √(P/m) and N(V) = I·m/P − D."""
    (found,) = swings(Coulomb(F_c=2.0, F_v=0.5), Testbench(Ramp(0.0), 2.0, controller=PID(50.0, 200.0, 3.0)))
    assert found == pytest.approx((4.0 * 2.0 / (np.pi * 4.5) / 5.0, 2.0 * np.pi / 5.0, False), rel=1e-12)
    assert swings(Coulomb(), Testbench(Ramp(0.0), controller=PID(50.0, 100.0, 3.0))) == []


@pytest.mark.parametrize(("law", "pid"), [
    (Karnopp(0.2, 0.3, 0.6, 0.05), PID(100.0, limit=10.0, period=0.02, delay=0.03, target=0.5)),
    (Karnopp(0.2, 0.3, 1.0, 0.05), PID(100.0, 20.0, 2.0, limit=5.0, period=0.01, delay=0.08, target=0.5)),
    (Coulomb(0.1, 0.3), PID(50.0, limit=2.0, period=0.01, delay=0.02, target=0.5)),
])  # fmt: skip
def test_a_late_and_limited_controller_hunts_as_foretold(law, pid):
    """A balance of first harmonics alone: its period is within 10 %, its amplitude within 15 % here."""
    bench = Testbench(Ramp(0.0), controller=pid)
    small, large = swings(law, bench)
    assert (small.attracts, large.attracts) == (False, True)
    cycle = simulate(law, bench, 60.0).cycle
    assert cycle is not None
    assert cycle.slips == 2
    assert cycle.period == pytest.approx(large.period, rel=0.1)
    assert cycle.span == pytest.approx(2.0 * large.amplitude, rel=0.15)


def test_a_controller_whose_swings_none_holds_comes_to_rest():
    law, bench = Karnopp(1.0, 1.5, 0.3, 0.05), Testbench(Ramp(0.0), controller=PID(400.0, 0.0, 5.0, 0.5, limit=6.0))
    assert swings(law, bench) == []
    run = simulate(law, bench, 20.0)
    assert run.cycle is None
    assert run.mode[-1] == 0
    with pytest.raises(friction.InputError, match="no harmonic balance"):
        swings(friction.Dahl(), bench)  # type: ignore[arg-type]
