"""Controllers with a limit, such that look now and then, and springs with play, against SciPy from event to event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from friction import PID, Karnopp, Ramp, Sine, Spring, Status, Testbench, simulate

LAW = Karnopp(F_c=1.0, F_s=1.5, F_v=0.3, v_s=0.05)


def slid(y, t, end, mass, force, way):
    """A slip from t until it stops or the end comes; y is x, v and what the force needs beside."""

    def rates(t, y):
        held = LAW.F_c + (LAW.F_s - LAW.F_c) * np.exp(-((y[1] / LAW.v_s) ** 2))
        f, more = force(t, y)
        return [y[1], (f - way * held - LAW.F_v * y[1]) / mass, *more]

    def stop(_, y):
        return y[1]

    stop.terminal, stop.direction = True, -way
    run = solve_ivp(rates, (t, end), y, "DOP853", events=stop, rtol=1e-12, atol=1e-14, max_step=0.005)
    return run.t[-1], run.y[:, -1], bool(run.t_events[0].size)


def limited(pid, mass, t_end):
    """Events until t_end, and the place then: a continuous controller, the mass at rest at first."""
    t, y, way, found = 0.0, np.zeros(3), 0, []

    def wanted(t, y):
        return pid.proportional * (pid.target - y[0]) + pid.integral * y[2] - pid.derivative * y[1]

    def force(t, y):
        return np.clip(wanted(t, y), -pid.limit, pid.limit), [pid.target - y[0]]

    while t < t_end:
        if way == 0:
            error, f = pid.target - y[0], wanted(t, y)
            way = int(np.sign(error if abs(f) <= LAW.F_s else f))
            wait = (way * LAW.F_s - f) / (pid.integral * error) if abs(f) <= LAW.F_s else 0.0
            t, y = t + wait, y + np.array([0.0, 0.0, wait * error])
            if 0.0 < t < t_end:
                found.append((t, y[0]))
        if t < t_end:
            t, y, stopped = slid(y, t, t_end, mass, force, way)
            if stopped:
                y[1], turned = 0.0, -way
                f = np.clip(wanted(t, y), -pid.limit, pid.limit)
                found.append((t, y[0]))
                way = turned if -way * f > LAW.F_s else 0
    return np.array(found), y[0]


@pytest.mark.parametrize(
    ("pid", "mass", "t_end"),
    [
        (PID(100.0, 200.0, 5.0, 0.1, limit=3.0), 1.0, 4.0),  # winds up, overshoots
        (PID(100.0, 200.0, 5.0, 0.1, limit=1.6), 1.0, 5.0),
        (PID(50.0, 20.0, 1.0, -0.3, limit=2.0), 2.0, 12.0),
        (PID(300.0, 400.0, 0.0, 0.02, limit=4.0), 0.5, 3.0),
    ],
)
def test_a_limit_is_met_and_left_where_scipy_says(pid, mass, t_end):
    """Of SciPy at 1e-12 events are known to some 1e-9, while slips are not yet rounding."""
    run = simulate(LAW, Testbench(Ramp(0.0), mass, controller=pid), t_end)
    exact, x = limited(pid, mass, t_end)
    assert run.status is Status.DONE
    assert np.abs(run.F_a).max() == pid.limit
    found = np.array([event[1:] for event in run.events])
    assert len(found) == len(exact) > 2
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-8)
    assert run.x[-1] == pytest.approx(x, abs=1e-9)


def test_below_stiction_a_limit_holds_for_ever():
    run = simulate(LAW, Testbench(Ramp(0.0), controller=PID(100.0, 200.0, 5.0, 0.1, limit=1.4)), 30.0)
    assert run.events == []
    assert run.F_a[-1] == 1.4
    assert run.status is Status.DONE


def sampled(pid, mass, t_end):
    """Places at all looks of the controller, by its recursion."""
    period, limit, places = pid.period, np.inf if pid.limit is None else pid.limit, []
    t, y, way, sum_of_errors, before, u, queue, n = 0.0, np.zeros(2), 0, 0.0, pid.target, 0.0, [], 0
    while t < t_end - 1e-9:
        next_given = queue[0][0] if queue else np.inf
        if t >= n * period - 1e-12:
            error = pid.target + pid.speed * n * period - y[0]
            sum_of_errors += period * error
            wanted = pid.proportional * error + pid.integral * sum_of_errors
            wanted += pid.derivative * (error - before) / period
            queue.append((n * period + pid.delay, np.clip(wanted, -limit, limit)))
            before, n = error, n + 1
            places.append(y[0])
            next_given = queue[0][0]
        if t >= next_given - 1e-12:
            u = queue.pop(0)[1]
            next_given = queue[0][0] if queue else np.inf
        until = min(n * period, next_given, t_end)
        if way == 0 and abs(u) > LAW.F_s:
            way = int(np.sign(u))
        if way == 0:
            t = until
            continue
        stopped = True
        while stopped and t < until and way:
            t, y, stopped = slid(y, t, until, mass, lambda t, y, u=u: (u, []), way)
            if stopped:
                y[1] = 0.0
                way = int(np.sign(u)) if abs(u) > LAW.F_s else 0
        t = until
    return np.array(places)


@pytest.mark.parametrize(
    ("pid", "mass"),
    [
        (PID(100.0, 200.0, 5.0, 0.05, period=0.01), 1.0),
        (PID(100.0, 200.0, 5.0, 0.05, period=0.01, delay=0.004), 1.0),
        (PID(60.0, 80.0, 8.0, 0.05, period=0.02, delay=0.05, limit=3.0), 1.5),  # longer than a period
        (PID(80.0, 30.0, 3.0, 0.0, speed=0.02, period=0.03, delay=0.03), 2.0),
    ],
)
def test_looks_of_a_sampled_controller_are_those_of_its_recursion(pid, mass):
    t_end = 4.0
    exact = sampled(pid, mass, t_end)
    looks = pid.period * np.arange(len(exact))
    run = simulate(LAW, Testbench(Ramp(0.0), mass, controller=pid), t_end, times=looks)
    assert run.status is Status.DONE
    assert run.event_count > 0
    np.testing.assert_allclose(run.x, exact, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("v0", [0.0, 0.4])
def test_a_spring_with_play_is_slack_where_scipy_says(v0):
    """A sine beside it takes the mass to and fro through the play."""
    spring, mass, t, y, way, found = Spring(200.0, 0.01, 0.02), 1.0, 0.0, np.array([0.0, v0]), int(v0 > 0.0), []

    def force(t, y):
        away = spring.speed * t - y[0]
        return 1.8 * np.sin(2.0 * np.pi * 0.7 * t) + 200.0 * (away - np.clip(away, -0.02, 0.02)), []

    while t < 10.0:
        if way == 0:  # the force of the sine and the spring at rest, found by halving
            grid = np.linspace(t, 10.0, 200_001)
            away = spring.speed * grid - y[0]
            pull = 1.8 * np.sin(2.0 * np.pi * 0.7 * grid) + 200.0 * (away - np.clip(away, -0.02, 0.02))
            over = np.flatnonzero(np.abs(pull) > LAW.F_s)
            if not over.size:
                break
            low, high = grid[max(over[0] - 1, 0)], grid[over[0]]
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if abs(force(middle, y)[0]) > LAW.F_s else (middle, high)
            t, way = high, int(np.sign(force(high, y)[0]))
            found.append((t, y[0]))
        t, y, stopped = slid(y, t, 10.0, mass, force, way)
        if stopped:
            y[1] = 0.0
            f = force(t, y)[0]
            way = int(np.sign(f)) if abs(f) > LAW.F_s else 0
            found.append((t, y[0]))
    run = simulate(LAW, Testbench(Sine(1.8, 0.7), mass, v0, spring), 10.0)
    assert run.status is Status.DONE
    assert len(found) == len(run.events) > 10
    np.testing.assert_allclose([event[1:] for event in run.events], found, rtol=0.0, atol=1e-8)


def test_a_mass_that_hardly_moves_beside_a_slack_spring_stops_in_time():
    """In m·v/(F_a + F_c), which is 1e-10 of the step that the slack spring leaves."""
    run = simulate(Karnopp(F_c=1.0, F_s=1.0), Testbench(Ramp(0.0, 0.5), 2.0, -3e-10, Spring(155.1, 0.63, 0.328)), 1e-3)
    assert run.status is Status.DONE
    assert run.events[0].t == pytest.approx(4e-10, rel=1e-8)
