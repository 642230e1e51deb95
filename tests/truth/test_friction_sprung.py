"""Maxwell slip and Armstrong's law on the testbench and in mechanisms, against SciPy from event to event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import friction as fr
from friction import Armstrong, MaxwellSlip, Ramp, Sine, Spring, Status, Testbench, simulate
from friction.mechanism import Mechanism

END = 3.0
BENCHES = {
    "ramp": Testbench(Ramp(1.0)),
    "sine": Testbench(Sine(2.5, 1.0, offset=0.2), mass=0.7),
    "rig": Testbench(Ramp(0.0), spring=Spring(40.0, 0.1)),
    "thrown": Testbench(Ramp(0.0, 0.3), v0=0.8),
}
LAWS = {
    "elements": MaxwellSlip([300.0, 150.0, 60.0], [0.4, 0.6, 0.3]),
    "falling limits": MaxwellSlip([300.0, 150.0], [0.6, 0.5], peak=1.4, v_s=0.05, F_v=0.1),
    "dwell": Armstrong(F_c=1.0, F_s=1.5, F_v=0.2, v_s=0.05, sigma0=400.0, dwell=0.2),
    "dwell and lag": Armstrong(F_c=1.0, F_s=1.5, F_v=0.2, v_s=0.05, sigma0=400.0, lag=0.02, dwell=0.2),
}


def by_scipy(law, bench, times):
    """x, v and F_f at times, and instants at which slip begins or ends, of each spring."""
    maxwell, drive = isinstance(law, MaxwellSlip), bench.drive
    parts = list(zip(law.limits, law.stiffness, strict=True)) if maxwell else [(law.F_c, law.sigma0)]
    n, past, changes = len(parts), [], []
    rested = [(-np.inf, 0.0)] * n  # since when, and P_a
    peak, mode = [0.0] * n, [0] * n

    def late(t, v):
        if law.lag == 0.0:
            return v
        return next((float(s(t - law.lag)[1]) for a, s in reversed(past) if a <= t - law.lag), 0.0)

    def lorentz(t, v):
        return 1.0 / (1.0 + (late(t, v) / law.v_s) ** 2)

    def limit(k, t, v):
        if maxwell:
            return parts[k][0] * (1.0 + (law.peak - 1.0) * np.exp(-((v / law.v_s) ** 2)))
        since, left = rested[k]
        if mode[k]:
            return law.F_c + peak[k] * lorentz(t, v)
        gain = law.F_s - law.F_c - left
        return law.F_c + left + (gain if since == -np.inf else gain * (t - since) / (t - since + law.dwell))

    def forces(t, y):
        f = [mode[k] * limit(k, t, y[1]) if mode[k] else y[2 + k] for k in range(n)]
        viscous = law.F_v * y[1] if maxwell or mode[0] else 0.0
        push = drive.value[0] + drive.slope[0] * t + drive.amplitude * np.sin(drive.omega * t + drive.phase)
        return f, sum(f) + viscous, push + drive.stiffness * (drive.speed * t - y[0])

    def rates(t, y):
        _, friction, push = forces(t, y)
        return [y[1], (push - friction) / bench.mass, *(0.0 if mode[k] else parts[k][1] * y[1] for k in range(n))]

    def guard(function, direction):
        function.terminal, function.direction = True, direction
        return function

    t, y, found = 0.0, np.array([0.0, bench.v0, *np.zeros(n)]), []
    step = 0.9 * law.lag if not maxwell and law.lag else 2e-2
    while t < times[-1]:
        way = np.sign(y[1]) or np.sign(rates(t, y)[1]) or 1.0
        stuck = [k for k in range(n) if not mode[k]]
        watched = [guard(lambda _, y: y[1], -way)]
        watched += [guard(lambda t, y, k=k, s=way: limit(k, t, y[1]) - s * y[2 + k], -1) for k in stuck]
        until = min(times[-1], t + step)
        run = solve_ivp(rates, (t, until), y, "DOP853", rtol=1e-11, atol=1e-13, events=watched, dense_output=True)
        for at in times[(times >= t) & (times < run.t[-1])]:
            state = run.sol(at)
            found.append([state[0], state[1], forces(at, state)[1]])
        past.append((t, run.sol))
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        (index,) = [index for index, when in enumerate(run.t_events) if when.size] or [None]
        if index is None:
            continue
        if index == 0:
            for k in range(n):
                if mode[k]:
                    y[2 + k], rested[k] = mode[k] * limit(k, t, 0.0), (t, 0.0 if maxwell else peak[k] * lorentz(t, 0.0))
                    mode[k] = 0
                    changes.append((k, t))
            y[1] = 0.0
        else:
            k = stuck[index - 1]
            peak[k] = 0.0 if maxwell else limit(k, t, y[1]) - law.F_c
            mode[k] = int(way)
            changes.append((k, t))
    found.append([y[0], y[1], forces(t, y)[1]])
    return np.array(found).T, changes


@pytest.mark.parametrize("kind", BENCHES)
@pytest.mark.parametrize("name", LAWS)
def test_runs_on_the_testbench(name, kind):
    law, bench, times = LAWS[name], BENCHES[kind], np.linspace(0.0, END, 152)
    run, (exact, changes) = simulate(law, bench, END, times=times), by_scipy(law, bench, times)
    assert run.status is Status.DONE
    for found, wanted in zip((run.x, run.v, run.F_f), exact, strict=True):
        np.testing.assert_allclose(found, wanted, atol=3e-8 * np.abs(wanted).max(), rtol=0)
    if name.startswith("dwell"):
        np.testing.assert_allclose([event.t for event in run.events], [t for _, t in changes], atol=1e-7)
    assert abs(run.ledger.residual) < 1e-12
    assert run.ledger.heat > 0.0


@pytest.mark.parametrize("name", LAWS)
def test_two_masses_rub_on_each_other(name):
    """Their relative motion is that of the reduced mass alone, and their momentum stays."""
    law, (left, right), times = LAWS[name], (2.0, 0.5), np.linspace(0.0, 2.0, 41)
    m = Mechanism()
    v, w = m.state(0.3), m.state(-0.6)
    friction, _ = m.contact(law, m.add({v: 1.0, w: -1.0}))
    m.integrate(v, m.add({friction: -1.0 / left}))
    m.integrate(w, m.add({friction: 1.0 / right}))
    status, run, changes = m.run(times, {"v": v, "w": w}, places=[v], events=100)
    alone = simulate(law, Testbench(Ramp(0.0), mass=left * right / (left + right), v0=0.9), 2.0, times=times)
    assert status == 0
    np.testing.assert_allclose(run["v"] - run["w"], alone.v, atol=1e-11)
    np.testing.assert_allclose(left * run["v"] + right * run["w"], left * 0.3 - right * 0.6, atol=1e-13)
    first = [event.t for event in alone.events[:2]]
    np.testing.assert_allclose(changes[:2, 2], first, rtol=1e-10)


@pytest.mark.parametrize("seed", range(8))
def test_elements_are_play_operators_of_the_place(seed):
    """Random elements and forces: friction is what the place, followed finely, makes of elements that are clipped."""
    rng = np.random.default_rng((77, seed))
    n = int(rng.integers(1, 6))
    law = MaxwellSlip(10.0 ** rng.uniform(1.5, 4.0, n), rng.uniform(0.1, 1.0, n), F_v=0.1)
    force = Sine(law.sliding * rng.uniform(0.5, 3.0), rng.uniform(0.3, 3.0), phase=rng.uniform(0.0, 6.0))
    run = simulate(law, Testbench(force, v0=rng.normal()), 2.0, times=np.linspace(0.0, 2.0, 20_001))
    held, exact = np.zeros(n), [0.0]
    for step in np.diff(run.x):
        held = np.clip(held + np.array(law.stiffness) * step, -np.array(law.limits), law.limits)
        exact.append(held.sum())
    assert run.status is Status.DONE
    np.testing.assert_allclose(run.F_f, exact + 0.1 * run.v, atol=1e-4)  # turns lie between samples
    assert np.diff(run.W_f - run.stored).min() > -1e-12


def test_velocity_a_lag_earlier_is_found_behind_thousands_of_legs():
    """A table of 7000 pieces: it sticks in the first 6000, and slides steadily at last."""
    law, v = Armstrong(F_c=1.0, F_s=1.5, F_v=0.2, v_s=0.05, sigma0=1e3, lag=0.01), 0.02
    t = np.linspace(0.0, 7.0, 7001)
    shaken = fr.Table(t, np.where(t < 6.0, 1e-6 * np.sin(40.0 * t), v * np.minimum(10.0 * (t - 6.0), 1.0)))
    run = fr.prescribe(law, velocity=shaken, t_end=7.0, times=[7.0])
    np.testing.assert_allclose(run.F_f, 1.0 + 0.2 * v + 0.5 / (1.0 + (v / 0.05) ** 2), rtol=1e-12)


def test_a_dry_contact_beside_springs_begins_as_it_moves():
    """It stops at v0 m/F_c, as alone, which is told."""
    m = Mechanism()
    v, w = m.state(1.0), m.state(0.0)
    for law, of in ((fr.Coulomb(F_c=1.0), v), (LAWS["elements"], w)):
        m.integrate(of, m.contact(law, of, m.input())[1])
    _, _, changes = m.run(np.linspace(0.0, 2.0, 5), {"v": v}, places=[v, w], events=20)
    np.testing.assert_allclose(changes, [[1.0, 0.0, 1.0, 0.0, 0.0]], atol=1e-12)
