"""Drives with dry friction, sampled controllers and other parameters, against SciPy and matrix exponentials."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from drives import (
    Belt,
    CoupledDrives,
    Design,
    Pulley,
    Spool,
    Torque,
    Winding,
    closed_loop,
    design,
    sampled_poles,
    sensitivities,
    simulate,
    simulate_control,
)
from friction import Coulomb, Karnopp, LuGre
from tline.errors import InputError

DRIVES = CoupledDrives(Spool(2e-3, 0.01, 0.1), Spool(1e-3, 0.02, 0.08), Belt(60, 0.4), Belt(50, 0.5), Pulley(200, 0.8))
DRY = Karnopp(F_c=0.04, F_s=0.06, F_v=0.0, v_s=2.0), Coulomb(F_c=0.03)
TORQUES = Torque.table([0.0, 0.6, 1.4, 3.0], [0.0, 0.5, -0.2, 0.1]), Torque.table([0.0, 1.0, 2.0], [0.0, 0.4, -0.3])


def by_scipy(drives, laws, torques, t_end, slack, at):
    """States, and events of each spool: each sticks or slides one way until SciPy finds that it does not."""
    spools = [tuple(map(float, (one.inertia, one.friction, one.radius))) for one in (drives.left, drives.right)]
    belts = [tuple(map(float, (one.stiffness, one.damping))) for one in (drives.left_belt, drives.right_belt)]
    stiffness = float(drives.pulley.stiffness) / (4.0 * np.cos(drives.pulley.angle) ** 2)
    modes, y, t = [0, 0], np.zeros(6), 0.0
    samples, events = [y], ([], [])

    def pulls(t, y):
        f = stiffness * (max(y[3], 0.0) if slack else y[3])
        (_, b1, r1), (_, b2, r2) = spools
        return (r1 * f - torques[0](t) - b1 * y[1], torques[1](t) - b2 * y[2] - r2 * f), f

    def dry(k, w):
        law = laws[k]
        steady = law.sliding + (law.stiction - law.sliding) * np.exp(-((w / getattr(law, "v_s", 1.0)) ** 2))
        return modes[k] * steady

    def rates(t, y):
        net, f = pulls(t, y)
        speeds = [(f - k * e) / b for (k, b), e in zip(belts, y[4:], strict=True)]
        turning = [(net[k] - dry(k, y[1 + k])) / spools[k][0] if modes[k] or laws[k] is None else 0.0 for k in range(2)]
        return [y[1], *turning, spools[1][2] * y[2] - spools[0][2] * y[1] - sum(speeds), *speeds]

    def guard(k):
        def left(t, y):
            return modes[k] * y[1 + k] if modes[k] else laws[k].stiction - abs(pulls(t, y)[0][k])

        left.terminal, left.direction = True, -1
        return left

    corners = sorted({time for one in torques for time in one.times if 0.0 < time < t_end} | {*at} - {0.0})
    for end in corners:
        while t < end:
            how = {"events": [guard(0), guard(1)], "rtol": 1e-12, "atol": 1e-14, "max_step": 0.01}
            run = solve_ivp(rates, (t, end), y, "DOP853", **how)
            t, y = run.t[-1], run.y[:, -1]
            for k in range(2):
                if run.t_events[k].size:
                    pull = pulls(t, y)[0][k]
                    old, stops = modes[k], modes[k] != 0
                    y[1 + k] = 0.0
                    modes[k] = 0 if stops and abs(pull) <= laws[k].stiction else int(np.sign(pull))
                    if modes[k] != old:
                        events[k].append(t)
        if end in at:
            samples.append(y)
    return np.array(samples), events


@pytest.mark.parametrize("slack", [False, True])
def test_spools_stick_and_slip_where_scipy_says(slack):
    """SciPy's own error, at 1e-12 a step, is some 1e-11."""
    run = simulate(DRIVES, *TORQUES, t_end=4.0, step=0.125, slack=slack, friction=DRY)
    states, events = by_scipy(DRIVES, DRY, TORQUES, 4.0, slack, run.t.tolist())
    assert run.verdicts == ()
    for k, side in enumerate(("left", "right")):
        found = [one.t for one in run.events[side]]
        assert len(found) == len(events[k]) > 2
        np.testing.assert_allclose(found, events[k], rtol=0.0, atol=1e-9)
    found = np.column_stack([run.states[name] for name in ("phi1", "w1", "w2", "e_p", "e1", "e2")])
    np.testing.assert_allclose(found, states, rtol=0.0, atol=1e-9 * np.abs(states).max())
    assert np.abs(run.energy.imbalance).max() < 1e-13 * run.energy.dissipated[-1]


def test_without_friction_and_slack_it_is_the_linear_run():
    """Which is exact to one ulp; a belt wound without thickness takes it through events."""
    how = {"t_end": 4.0, "step": 0.1}
    run, exact = simulate(DRIVES, *TORQUES, **how, winding=Winding(1e-20, 0.0)), simulate(DRIVES, *TORQUES, **how)
    for name, values in exact.states.items():
        np.testing.assert_allclose(run.states[name], values, rtol=0.0, atol=1e-13 * np.abs(values).max())
    for name in ("stored", "dissipated", "supplied"):
        exact_energy = getattr(exact.energy, name)
        np.testing.assert_allclose(getattr(run.energy, name), exact_energy, atol=1e-13 * exact_energy.max())


def test_a_spool_below_its_stiction_never_moves():
    run = simulate(DRIVES, T2=Torque.ramp(0.0599, 0.0, 1.0), t_end=3.0, step=0.1, slack=True, friction=(DRY[0], DRY[0]))
    assert run.events == {"left": [], "right": []}
    assert not run.states["w1"].any()
    assert not run.states["w2"].any()


def test_a_law_without_events_is_refused():
    with pytest.raises(InputError, match=r"^friction: lugre has no events, expected coulomb or karnopp"):
        simulate(DRIVES, t_end=1.0, step=0.1, slack=True, friction=(LuGre(), None))


ALIKE = CoupledDrives()
OTHER = CoupledDrives(Spool(2e-3, 0.1, 0.08), Spool(1e-3, 0.05, 0.1), Belt(80, 0.3), Belt(50, 0.5), Pulley(300, 1.0))


def by_exponentials(made: Design, v: float, f: float, d1: float, times, period: float, delay: float, lag: float):
    """(states, filters) and torques at times, from rest, for constant set points."""
    drives, model = made.drives, made.drives.state_space(("w1", "w2", "tension"))
    n, m = len(model.states), 3 if lag else 0
    a, b, y = np.zeros((n + m, n + m)), np.vstack([model.B, np.zeros((m, 2))]), np.zeros((3, n + m))
    a[:n, :n], y[:, :n] = model.A, model.C
    if lag:
        a[n:, :n], a[n:, n:] = model.C / lag, -np.eye(3) / lag
        y = np.eye(3, n + 3, n)
    (j1, b1, r1), (j2, b2, r2) = (
        (float(s.inertia), float(s.friction), float(s.radius)) for s in (drives.left, drives.right)
    )
    mean, mass, rub = (r1 + r2) / 2, (j1 / r1**2 + j2 / r2**2) / 2, (b1 / r1**2 + b2 / r2**2) / 2

    def torques(seen, q):
        w1, w2, tension = seen
        errors = np.array([v - (r1 * w1 + r2 * w2) / 2, f - tension])
        tau = [
            float(c.gain) * (e + x / float(c.integral_time))
            for c, e, x in zip((made.speed, made.tension), errors, q, strict=True)
        ]
        pull1, pull2 = (tau[1] - tau[0]) / (2 * mean), (tau[1] + tau[0]) / (2 * mean)
        T1 = j1 / r1 / mass * (pull1 + rub * r1 * w1 - tension) + r1 * (tension - b1 / r1**2 * r1 * w1)
        T2 = j2 / r2 / mass * (pull2 - rub * r2 * w2 - tension) + r2 * (tension + b2 / r2**2 * r2 * w2)
        return np.array([T1, T2]), errors

    looks = [k * period for k in range(int(times[-1] / period) + 1)]
    marks = sorted({*times, *looks, *(look + delay for look in looks)})
    x, q, held, queue, found, before = np.zeros(n + m), np.zeros(2), np.zeros(2), [], {}, 0.0
    for mark in marks:
        step = mark - before
        both = np.zeros((n + m + 2, n + m + 2))
        both[: n + m, : n + m], both[: n + m, n + m :] = a, b
        moved = expm(both * step)
        x, before = moved[: n + m] @ np.concatenate([x, held + np.array([d1, 0.0])]), mark
        if mark in looks:
            given, errors = torques(y @ x, q)
            q = q + period * errors
            queue.append((mark + delay, given))
        if queue and queue[0][0] <= mark:
            held = queue.pop(0)[1]
        if mark in times:
            found[mark] = np.r_[x, held]
    return np.array([found[t] for t in times])


@pytest.mark.parametrize("drives", [ALIKE, OTHER])
@pytest.mark.parametrize(("period", "delay", "lag"), [(0.01, 0.0, 0.0), (0.02, 0.007, 0.0), (0.01, 0.024, 0.003)])
def test_sampled_loops_are_those_of_matrix_exponentials(drives, period, delay, lag):
    made = design(drives, 20, 20)
    run = simulate_control(
        made, Torque.step(1.0), Torque.step(5.0), d1=Torque.step(0.1), t_end=0.3, step=0.015,
        period=period, delay=delay, filter_time=lag,
    )  # fmt: skip
    exact = by_exponentials(made, 1.0, 5.0, 0.1, run.t.tolist(), period, delay, lag)
    names = [name for name in run.states if not name.startswith("q_")]
    found = np.column_stack([*(run.states[name] for name in names), run.outputs["T1"], run.outputs["T2"]])
    assert run.verdicts == ()
    assert (np.abs(found - exact) <= 1e-12 * np.abs(exact).max(axis=0)).all()


@pytest.mark.parametrize(("period", "delay", "lag"), [(0.08, 0.0, 0.0), (0.02, 0.051, 0.0), (0.05, 0.03, 0.004)])
def test_an_unstable_sampled_loop_grows_as_its_largest_eigenvalue(period, delay, lag):
    """After 200 looks its mode alone is left, beside constants: as 0.94^200 at most."""
    made, looks = design(ALIKE, 20, 30), dict[str, Any](period=period, delay=delay, filter_time=lag)
    run = simulate_control(made, Torque.step(1.0), Torque.step(5.0), t_end=200 * period, step=period, **looks)
    pole = sampled_poles(made, **looks)[0]
    assert run.verdicts[0].endswith(f"grows by {abs(pole):.4g}")
    x = max((np.diff(run.outputs[name])[-12:] for name in ("belt_speed", "tension")), key=lambda x: np.abs(x).max())
    turned = x[2:] - 2.0 * pole.real * x[1:-1] + abs(pole) ** 2 * x[:-2]
    assert np.abs(turned).max() <= 1e-4 * np.abs(x).max()


def test_looks_that_no_controller_has_are_refused():
    wrong: Any
    for wrong in ({"delay": 0.1}, {"period": 0.0}, {"period": 0.01, "delay": 2.0}, {"filter_time": -1.0}):
        with pytest.raises(InputError, match=r"^(delay|period|filter_time): "):
            simulate_control(design(ALIKE, 20, 30), t_end=1.0, step=0.1, **wrong)


LOOP = CoupledDrives(Spool(2e-3, 0.1, 0.08), Spool(1e-3, 0.05, 0.1), Belt(80, 0.3), Belt(50, 0.5), Pulley(300, 1.0))
OTHERS = {
    "left.inertia": lambda x: replace(LOOP, left=Spool(2e-3 * x, 0.1, 0.08)),
    "right.radius": lambda x: replace(LOOP, right=Spool(1e-3, 0.05, 0.1 * x)),
    "right_belt.stiffness": lambda x: replace(LOOP, right_belt=Belt(50 * x, 0.5)),
    "pulley.angle": lambda x: replace(LOOP, pulley=Pulley(300, x)),
}


def overshoot(loop, k, name):
    """By a modal sum, with a parabola through the highest of 40,000 instants and its neighbours."""
    values, modes = np.linalg.eig(loop.A)
    share = np.linalg.solve(modes, loop.B[:, k]) * (loop.C[loop.outputs.index(name)] @ modes)
    used = np.abs(values) > 1e-9
    t = np.linspace(0.0, 3.0, 40_000)
    y = np.sum([(c / z * (np.exp(z * t) - 1.0)).real for c, z in zip(share[used], values[used], strict=True)], axis=0)
    k = int(np.clip(np.argmax(y), 1, y.size - 2))
    bend, slope = y[k + 1] - 2.0 * y[k] + y[k - 1], 0.5 * (y[k + 1] - y[k - 1])
    return (y[k] - 0.5 * slope**2 / bend) / y[-1] - 1.0


@pytest.mark.parametrize("name", OTHERS)
def test_poles_and_overshoots_move_as_those_of_other_drives(name):
    made = design(LOOP, 20, 30)
    found, small = sensitivities(made), 1e-4
    row = found.parameters.index(name)
    more, less = (closed_loop(made, plant=OTHERS[name](1 + sign * small)) for sign in (1, -1))
    moved = [(z - min(less.poles, key=lambda other: abs(other - z))) / (200 * small) for z in more.poles]
    for pole, move in zip(found.poles, found.of_poles[row], strict=True):
        k = int(np.argmin([abs(z - pole) for z in more.poles]))
        assert move == pytest.approx(moved[k], rel=1e-5, abs=1e-7 * abs(pole))
    for k, output in enumerate(("belt_speed", "tension")):
        slope = (overshoot(more, k, output) - overshoot(less, k, output)) / (200 * small)
        assert found.of_overshoots[row, k] == pytest.approx(slope, rel=1e-3, abs=1e-7)
