"""Belts that are wound: closed forms, and SciPy at 1e-12 on equations of angular momentum."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drives import Belt, CoupledDrives, InputError, Spool, Torque, Winding, design, simulate, simulate_control
from friction import Coulomb

DRIVES = CoupledDrives(Spool(5e-3, 0.02, 0.1), Spool(1e-3, 0.03, 0.05), Belt(80, 0.5), Belt(50, 0.3))
WOUND = Winding(5e-3, 0.1)
TORQUES = Torque.step(0.3), Torque.table([0.0, 0.5], [0.0, 1.5])


def by_scipy(times):
    """Angular momenta p = J w: the belt brings and takes J' w, so p' = torque + J' w."""
    (j1, b1, r1), (j2, b2, r2) = (
        (float(s.inertia), float(s.friction), float(s.radius)) for s in (DRIVES.left, DRIVES.right)
    )
    spring, (h, mu) = float(DRIVES.spring), (5e-3, 0.1)

    def spools(phi1, phi2):
        found = [r1 - h * phi1 / (2 * pi), r2 + h * phi2 / (2 * pi)]
        return found, [
            j + mu * pi / (2 * h) * (r**4 - r0**4) for j, r, r0 in zip((j1, j2), found, (r1, r2), strict=True)
        ]

    def rates(t, y):
        phi1, phi2, p1, p2, e_p, e1, e2 = y
        (ra, rb), (ja, jb) = spools(phi1, phi2)
        w1, w2, f = p1 / ja, p2 / jb, spring * e_p
        de1, de2 = (f - 80 * e1) / 0.5, (f - 50 * e2) / 0.3
        T2 = min(t / 0.5, 1.0) * 1.5
        return [w1, w2, ra * f - 0.3 - b1 * w1 - mu * ra**3 * w1**2, T2 - b2 * w2 - rb * f + mu * rb**3 * w2**2,
                rb * w2 - ra * w1 - de1 - de2, de1, de2]  # fmt: skip

    y, found = np.zeros(7), []
    for start, end in ((0.0, 0.5), (0.5, times[-1])):
        at = times[(times >= start) & (times < end)] if end < times[-1] else times[times >= start]
        run = solve_ivp(
            rates, (start, end), y, "DOP853", t_eval=[*at, end] if at[-1] < end else at, rtol=1e-12, atol=1e-14
        )
        y = run.y[:, -1]
        found.append(run.y[:, : at.size])
    y = np.hstack(found)
    (ra, rb), (ja, jb) = spools(y[0], y[1])
    return {
        "phi1": y[0],
        "phi2": y[1],
        "w1": y[2] / ja,
        "w2": y[3] / jb,
        "tension": spring * y[4],
        "r1": ra,
        "r2": rb,
        "J1": ja,
        "J2": jb,
    }


def test_a_belt_is_wound_as_scipy_winds_it():
    run = simulate(DRIVES, *TORQUES, t_end=2.0, step=0.1, slack=True, winding=WOUND)
    assert run.verdicts == ()
    assert run.outputs["J2"][-1] > 1.5 * run.outputs["J2"][0]
    for name, exact in by_scipy(run.t).items():
        np.testing.assert_allclose(run.outputs[name], exact, rtol=0, atol=1e-10 * np.abs(exact).max(), err_msg=name)
    assert np.abs(run.energy.imbalance).max() <= 1e-12 * run.energy.supplied.max()


def test_a_thin_belt_without_mass_changes_nothing():
    plain = simulate(DRIVES, *TORQUES, t_end=1.0, step=0.1)
    thin = simulate(DRIVES, *TORQUES, t_end=1.0, step=0.1, winding=Winding(1e-20, 0.0))
    for name, exact in plain.outputs.items():
        np.testing.assert_allclose(thin.outputs[name], exact, rtol=0, atol=1e-13 * np.abs(exact).max())


def test_under_control_and_with_friction_the_witness_is_silent():
    run = simulate_control(
        design(DRIVES, 20, 20), Torque.step(0.5), Torque.step(5.0), limit=3.0, period=0.01, t_end=1.0, step=0.01,
        winding=WOUND, friction=(None, Coulomb(F_c=0.05)),
    )  # fmt: skip
    assert run.verdicts == ()


def test_an_empty_spool_is_told():
    with pytest.raises(InputError, match="the left spool is empty"):
        simulate(DRIVES, *TORQUES, t_end=2.0, step=0.01, slack=True, winding=Winding(1e-2, 0.5))
