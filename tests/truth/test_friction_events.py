"""Events against motions that are worked out exactly, and errors of smooth laws against an independent reference."""

from fractions import Fraction
from math import isqrt

import numpy as np
import pytest
from friction_by_scipy import COLUMNS, END, TOLS, largest_errors, random_case, reference

from friction import Coulomb, Dahl, Karnopp, Kind, LuGre, Ramp, Sine, Spring, Status, Table, Testbench, simulate


def first_zero(a, b, c, most):
    """First t in (0, most] where a + b·t + c·t² vanishes while it falls; rational, its root to 60 digits."""
    if c == 0:
        t = -a / b if b < 0 else None
        return t if t is not None and 0 < t <= most else None
    square = b * b - 4 * a * c
    if square <= 0:
        return None
    scale = 10**60
    root = Fraction(isqrt(square.numerator * square.denominator * scale**2), square.denominator * scale)
    t = (-b - root) / (2 * c)
    return t if 0 < t <= most else None


def coulomb_events(times, values, F_c, mass):
    """Kinds and times of the events of a mass at rest under straight pieces of force, in rational arithmetic."""
    t, v, mode, found = Fraction(times[0]), Fraction(0), 0, []
    for k in range(len(times) - 1):
        end = Fraction(times[k + 1])
        slope = (Fraction(values[k + 1]) - Fraction(values[k])) / (end - Fraction(times[k]))
        while True:
            force = Fraction(values[k]) + slope * (t - Fraction(times[k]))
            if mode == 0:
                way = 1 if slope > 0 else -1
                step = (way * F_c - force) / slope
                if not 0 <= step < end - t:  # at its end, the next piece decides
                    break
                t, mode = t + step, way
                found.append((Kind.BREAK_AWAY, t))
                continue
            rise, bend = mode * (force - mode * F_c) / mass, mode * slope / (2 * mass)
            speed = mode * v
            step = first_zero(speed, rise, bend, end - t) if speed > 0 or rise > 0 else None
            if speed == 0 and rise == 0:
                step = None if bend > 0 else Fraction(0)
            if step is None:
                v += mode * (rise * (end - t) + bend * (end - t) ** 2)
                break
            t, v, old = t + step, Fraction(0), mode
            force = Fraction(values[k]) + slope * (t - Fraction(times[k]))
            mode = 0 if abs(force) <= F_c else -old
            found.append((Kind.STOP if mode == 0 else Kind.REVERSAL, t))
            t, v = Fraction(int(t * 10**40), 10**40), Fraction(0)
        t, v = end, Fraction(int(v * 10**40), 10**40)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_events_under_noise_are_those_of_rational_arithmetic(seed):
    rng, n = np.random.default_rng(seed), 400
    times = np.arange(n) / 1024.0
    values = np.round(2.0 * rng.normal(size=n), 3)
    values[0] = 0.0
    exact = coulomb_events(times.tolist(), values.tolist(), Fraction(1), Fraction(3, 4))
    run = simulate(Coulomb(1.0), Testbench(Table(times.tolist(), values.tolist()), 0.75), float(times[-1]))
    assert [event.kind for event in run.events] == [kind for kind, _ in exact]
    np.testing.assert_allclose([event.t for event in run.events], [float(t) for _, t in exact], rtol=1e-12)


def test_a_sine_on_coulomb_has_the_events_of_each_half_period_for_ever():
    """After 2·10⁴ of them, they are still where they were in the first periods."""
    run = simulate(Coulomb(), Testbench(Sine(1.3, 50.0)), 100.0, times=[100.0])
    assert run.status is Status.DONE
    breaks = np.array([event.t for event in run.events if event.kind is Kind.BREAK_AWAY])
    assert breaks.size == 10_000
    first = np.arcsin(1.0 / 1.3) / (100.0 * np.pi)
    np.testing.assert_allclose(breaks, first + 0.01 * np.arange(10_000), atol=1e-13)


def test_a_stiff_rig_keeps_its_period_for_three_thousand_slips():
    run = simulate(Karnopp(F_v=0.0), Testbench(Ramp(0.0), spring=Spring(1000.0, 0.05)), 600.0, times=[600.0])
    assert run.status is Status.DONE
    for kind in (Kind.BREAK_AWAY, Kind.STOP):
        periods = np.diff([event.t for event in run.events if event.kind is kind])
        assert periods.size > 2_900
        np.testing.assert_allclose(periods, periods[0], rtol=1e-11)
    assert abs(run.ledger.residual) < 1e-12


@pytest.mark.parametrize("seed", [0, 9])
def test_errors_of_smooth_laws_are_within_the_tolerance_and_the_estimate(seed):
    model, bench = random_case(np.random.default_rng((5, seed)))
    times = np.linspace(0.0, END, 101)
    exact = reference(model, bench, times)
    for tol in TOLS:
        errors, estimate = largest_errors(model, bench, exact, times, tol)
        assert errors.max() <= min(tol, estimate)


@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_stiff_bristles_meet_their_tolerance_in_every_column(tol):
    """Where the motion was wrong by 21 and the force by 278 times the tolerance; the reference is a run at 1e-9,
    which the test above compares with another program.
    """
    model, bench = LuGre(sigma0=1e5), Testbench(Sine(2.0, 1.0))
    exact, run = simulate(model, bench, 5.0, tol=1e-9), simulate(model, bench, 5.0, tol=tol)
    assert exact.status is run.status is Status.DONE
    for name in COLUMNS:
        wanted = getattr(exact, name)
        assert np.abs(getattr(run, name) - wanted).max() <= tol * np.abs(wanted).max()
    assert run.worst[1] <= tol
    assert [event.kind for event in run.events] == [event.kind for event in exact.events]
    for one, other in zip(run.events, exact.events, strict=True):
        assert abs(one.t - other.t) <= tol * 5.0


def test_a_tolerance_that_cannot_be_met_is_not_said_to_be():
    run = simulate(LuGre(sigma0=1e5), Testbench(Sine(2.0, 5.0)), 5.0, tol=1e-14)
    assert run.status is Status.INACCURATE
    assert run.worst[1] > 1e-14


def test_runs_that_are_left_the_same_steps_do_not_agree_about_nothing():
    """Corners of the force cut both runs that are compared into the same steps: still no error is said to be 0."""
    model, bench = random_case(np.random.default_rng((5, 31)))
    times = np.linspace(0.0, END, 401)
    errors, estimate = largest_errors(model, bench, reference(model, bench, times), times, 1e-3)
    assert errors.max() <= 1e-3
    assert errors.max() <= 2.0 * estimate


CASES = {
    "soft": (LuGre(sigma0=50.0), Testbench(Sine(2.0, 1.0))),
    "fast": (LuGre(sigma1=3.0, v_s=0.01), Testbench(Ramp(3.0), v0=-1.0)),  # from 100 v_s through the Stribeck peak
    "stiff at times": (LuGre(sigma0=1e4, sigma1=10.0), Testbench(Ramp(0.0), spring=Spring(200.0, 0.1))),
    "corners": (Dahl(sigma0=2e3), Testbench(Table([0.0, 0.5, 0.9, 1.4], [0.0, 1.5, -1.2, 0.3]))),
    "peak between two looks": (
        LuGre(3.1, 4.9, 0.018, 15.0, 0.0, 1.5),
        Testbench(Sine(13.7, 2.3, -4.2, 6.94, -3.6), 0.72),
    ),
    "from a deflection": (LuGre(sigma1=5.0), Testbench(Ramp(0.0), 1.0, 0.2, Spring(20.0, 0.1), x0=0.05, z0=-0.001)),
}


@pytest.mark.parametrize("case", CASES)
def test_errors_are_within_the_tolerance_and_the_estimate(case):
    model, bench = CASES[case]
    times = np.linspace(0.0, END, 101)
    exact = reference(model, bench, times)
    for tol in TOLS:
        errors, estimate = largest_errors(model, bench, exact, times, tol, "taylor")
        assert errors.max() <= min(tol, estimate)
