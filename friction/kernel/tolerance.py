"""Runs of the smooth laws that are compared with rougher ones, and made finer until they agree as asked for."""

from friction.kernel.bristles import rosenbrock
from friction.kernel.law import DONE, FA, FF, INACCURATE, STALLED, WA, WF, Drive, Law, T, V, X, Z
from friction.kernel.structures import EVENTS, RUN, Bench, SmoothRun, Sweep
from tline.unit import function, unit

FINEST, ROUGHEST = 1e-14, 0.1  # tolerances of single steps
START = 0.2  # tolerance of single steps, of that of the run, to begin with
SPREAD = 30.0  # between the tolerances of two runs that are compared
SAFETY = 10.0  # on an error that falls with the tolerance
ROUNDING = 1e-12  # differences below do not fall any further


@unit
def solve(run: SmoothRun, budget: int) -> int:
    """One run, whose steps count up to the budget; returns the status."""
    return refine(run.law, run.bench, run.wanted, run.at_least, budget, run.compared)


@function
def refine(law, bench, wanted, at_least, budget, compared):
    """A run to a tolerance `wanted`, 0 for none, then with steps as fine as `at_least`; returns its status.

    Errors are estimated for each column, relative to its largest magnitude, and of the instants of events, relative to
    t_end, in that of time.
    """
    errors, counts, k = compared.errors, compared.counts, 0
    tol = max(at_least if wanted <= 0.0 else START * wanted, FINEST)
    rough = min(tol * SPREAD, ROUGHEST)
    status = rosenbrock(law, bench, rough, budget, compared, k)
    before, alone = counts[EVENTS], status == STALLED  # then a finer run has nothing to be compared with
    while status == DONE or alone:
        k = 1 - k
        status = rosenbrock(law, bench, tol, budget, compared, k)
        if status == STALLED and tol > FINEST:
            alone, tol = True, max(FINEST, tol / SPREAD)
            continue
        if status != DONE:
            return status
        worst = compare(compared.records, k, compared.peaks, tol / rough, bench.drive.stiffness != 0.0, errors)
        errors[T] = 1.0 if alone else compare_events(compared, before, bench.t_end, tol / rough)
        worst = max(worst, errors[T])
        if wanted <= 0.0 or worst <= wanted:
            return DONE
        if tol <= FINEST:
            return INACCURATE
        rough, before, alone = tol, counts[EVENTS], False
        tol = max(FINEST, tol * min(0.5, max(1e-3, 0.5 * wanted / worst)))
    return status


@function
def compare_events(compared, before, t_end, ratio):
    """Estimate of the error of their instants, of `before` in the other run; 1 if they are not the same events."""
    met = compared.counts[EVENTS]
    if met != before:
        return 1.0
    k, worst = compared.counts[RUN], 0.0
    events, others = compared.events[k], compared.events[1 - k]
    for i in range(min(met, events.shape[0])):
        if events[i, 0] != others[i, 0] or events[i, 1] != others[i, 1]:
            return 1.0
        worst = max(worst, likely(abs(events[i, 2] - others[i, 2]) / t_end, ratio))
    return worst


@function
def compare(records, k, peaks, ratio, pulled, errors):
    """Estimates of the errors of run k from its difference to the other; the largest.

    No column is better than the largest error of a step: two runs may agree because corners of the force leave them
    the same steps. The applied force depends on the motion if a spring has `pulled` only.
    """
    worst = 0.0
    for column in range(errors.size):
        errors[column] = 0.0
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


@function
def likely(difference, ratio):
    """Error of the finer of two runs that differ so much."""
    return max(SAFETY * ratio * difference, min(difference, ROUNDING))


@unit
def sweep(runs: Sweep, budget: int) -> int:
    """Run them all; keeps x, v, z, F_f at the end, and the status."""
    drive, value, slope, compared, out = runs.drive, runs.value, runs.slope, runs.compared, runs.out
    for n in range(runs.masses.size):
        c, a = runs.laws[n], runs.factors[n]
        law = Law(int(c[0]), c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9])
        for i in range(value.size):
            value[i], slope[i] = a * drive.value[i], a * drive.slope[i]
        scaled = Drive(
            drive.start, value, slope, a * drive.amplitude, drive.omega, drive.phase, drive.stiffness, drive.speed
        )
        bench = Bench(scaled, runs.masses[n], runs.v0[n], runs.times[0], runs.times)
        status = refine(law, bench, runs.wanted, 0.0, budget, compared)
        last = compared.records[compared.counts[RUN], 0]
        out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4] = last[X], last[V], last[Z], last[FF], status
    return 0
