"""Runs of the smooth laws that are compared with rougher ones, and made finer until they agree as asked for."""

import numpy as np

from friction.kernel.bristles import rosenbrock
from friction.kernel.law import DONE, FA, FF, INACCURATE, OPTIONS, STALLED, WA, WF, Drive, Law, T, V, X, Z
from tline.compiled import njit

FINEST, ROUGHEST = 1e-14, 0.1  # tolerances of single steps
START = 0.2  # tolerance of single steps, of that of the run, to begin with
SPREAD = 30.0  # between the tolerances of two runs that are compared
SAFETY = 10.0  # on an error that falls with the tolerance
ROUNDING = 1e-12  # differences below do not fall any further


@njit(**OPTIONS)
def solve(law, drive, mass, v0, t_end, times, wanted, at_least, budget, records, errors):
    """A run to a tolerance `wanted`, 0 for none, then with steps as fine as `at_least`.

    records (2, n, 9) holds two runs; errors (9,) gets an estimate for each column, relative to its largest magnitude,
    and of the instants of events, relative to t_end, in that of time. Returns which run it is, its status, steps made
    and refused, and events.
    """
    peaks, k = np.zeros(9), 0
    tol = max(at_least if wanted <= 0.0 else START * wanted, FINEST)
    rough = min(tol * SPREAD, ROUGHEST)
    status, made, refused, before = rosenbrock(law, drive, mass, v0, t_end, times, rough, budget, records[0], peaks)
    alone = status == STALLED  # then a finer run has nothing to be compared with
    while status == DONE or alone:
        k = 1 - k
        status, made, refused, events = rosenbrock(law, drive, mass, v0, t_end, times, tol, budget, records[k], peaks)
        if status == STALLED and tol > FINEST:
            alone, tol = True, max(FINEST, tol / SPREAD)
            continue
        if status != DONE:
            return k, status, made, refused, events
        worst = compare(records, k, peaks, tol / rough, drive.stiffness != 0.0, errors)
        errors[T] = 1.0 if alone else compare_events(events, before, t_end, tol / rough)
        worst = max(worst, errors[T])
        if wanted <= 0.0 or worst <= wanted:
            return k, DONE, made, refused, events
        if tol <= FINEST:
            return k, INACCURATE, made, refused, events
        rough, before, alone = tol, events, False
        tol = max(FINEST, tol * min(0.5, max(1e-3, 0.5 * wanted / worst)))
    return k, status, made, refused, before


@njit(**OPTIONS)
def compare_events(events, before, t_end, ratio):
    """Estimate of the error of their instants; 1 if they are not the same events."""
    if events.shape[0] != before.shape[0]:
        return 1.0
    worst = 0.0
    for i in range(events.shape[0]):
        if events[i, 0] != before[i, 0] or events[i, 1] != before[i, 1]:
            return 1.0
        worst = max(worst, likely(abs(events[i, 2] - before[i, 2]) / t_end, ratio))
    return worst


@njit(**OPTIONS)
def compare(records, k, peaks, ratio, pulled, errors):
    """Estimates of the errors of run k from its difference to the other; the largest.

    No column is better than the largest error of a step: two runs may agree because corners of the force leave them
    the same steps. The applied force depends on the motion if a spring has `pulled` only.
    """
    errors[:], worst = 0.0, 0.0
    for column in (X, V, Z, FA, FF, WA, WF):
        size = difference = 0.0
        for i in range(records.shape[1]):
            difference = max(difference, abs(records[0, i, column] - records[1, i, column]))
            size = max(size, abs(records[k, i, column]))
        size = max(size, peaks[column])
        if size > 0.0 and (pulled or column != FA):
            errors[column] = max(likely(difference / size, ratio), peaks[T])
        worst = max(worst, errors[column])
    return worst


@njit(**OPTIONS)
def likely(difference, ratio):
    """Error of the finer of two runs that differ so much."""
    return max(SAFETY * ratio * difference, min(difference, ROUNDING))


@njit(**OPTIONS)
def sweep(laws, drive, masses, v0, factors, t_end, tol, budget, out):
    """Many runs: laws (n, 10) in the order of Law. Keeps x, v, z, F_f at the end, and the status."""
    times, records, errors = np.array([t_end]), np.empty((2, 1, 9)), np.empty(9)
    for n in range(masses.size):
        c = laws[n]
        law = Law(int(c[0]), c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9])
        a = factors[n]
        scaled = Drive(
            drive.start, a * drive.value, a * drive.slope, a * drive.amplitude, drive.omega, drive.phase,
            drive.stiffness, drive.speed,
        )  # fmt: skip
        k, status = solve(law, scaled, masses[n], v0[n], t_end, times, tol, 0.0, budget, records, errors)[:2]
        last = records[k, 0]
        out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4] = last[X], last[V], last[Z], last[FF], status
