"""Dry friction in the spools, slack belts and limited torques against SciPy from event to event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drives import Belt, CoupledDrives, Pulley, Spool, Torque, Winding, simulate
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
