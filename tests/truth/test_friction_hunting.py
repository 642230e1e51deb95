"""A mass with stiction under PID: stick in closed form, slip by SciPy, from event to event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from friction import PID, Karnopp, Kind, Ramp, Status, Testbench, simulate

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
