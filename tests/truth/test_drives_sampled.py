"""Sampled controllers of drives, with delay and filters, against matrix exponentials from change to change."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from drives import (
    Belt,
    CoupledDrives,
    Design,
    InputError,
    Pulley,
    Spool,
    Torque,
    design,
    sampled_poles,
    simulate_control,
)

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
