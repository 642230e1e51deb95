"""Runs of the smooth laws that are compared with rougher ones, and made finer until they agree as asked for."""

from math import inf

from friction.kernel import law as laws
from friction.kernel.bristles import rosenbrock
from friction.kernel.structures import EVENTS, RUN, STEPS, SmoothRun
from tline.compiled.unit import function, unit

FINEST, ROUGHEST = 1e-14, 0.1  # tolerances of single steps
START = 0.1  # tolerance of single steps, of that of the run, to begin with
SPREAD = 30.0  # between the tolerances of two runs that are compared
STEP_ROUNDING = 1e-16  # of each step


@unit
def solve(run: SmoothRun, budget: int) -> int:
    """One run, whose steps count up to the budget; returns the status."""
    return refine(run.law, run.bench, run.wanted, run.at_least, budget, run.compared)


@function
def refine(law, bench, wanted, at_least, budget, compared):
    """A run to a tolerance `wanted`, 0 for none, then with steps as fine as `at_least`; returns its status.

    Errors are estimated for each column, relative to its largest magnitude, and of the instants of events, relative to
    t_end, in that of time. Each run has a tolerance `SPREAD` times below that of the one before, and so half its steps,
    also where corners of the force bound them.
    """
    errors, counts, weights, k, parts = compared.errors, compared.counts, compared.weights, 0, 1
    rough = min(SPREAD * max(at_least if wanted <= 0.0 else START * wanted, FINEST), ROUGHEST)
    status = rosenbrock(law, bench, rough, parts, budget, compared, k)
    while status in (laws.DONE, laws.STALLED):
        alone, before = status == laws.STALLED, counts[EVENTS]  # a finer run has nothing then to be compared with
        for column in range(weights.size):
            weights[column] = compared.peaks[column]
        k, parts, tol = 1 - k, 2 * parts, max(FINEST, rough / SPREAD)
        status = rosenbrock(law, bench, tol, parts, budget, compared, k)
        if status == laws.STALLED and tol > FINEST:
            rough = tol
            continue
        if status != laws.DONE:
            return status
        worst = compare(compared, k, bench.drive.stiffness != 0.0)
        errors[laws.T] = 1.0 if alone else compare_events(compared, before, bench.t_end)
        worst = max(worst, errors[laws.T])
        if wanted <= 0.0 or worst <= wanted:
            return laws.DONE
        if tol <= FINEST:
            return laws.INACCURATE
        rough = tol
    return status


@function
def compare_events(compared, before, t_end):
    """Estimate of the error of their instants, of `before` in the other run; 1 if they are not the same events."""
    met = compared.counts[EVENTS]
    if met != before:
        return 1.0
    k, worst = compared.counts[RUN], 0.0
    events, others = compared.events[k], compared.events[1 - k]
    for i in range(min(met, events.shape[0])):
        if events[i, 0] != others[i, 0] or events[i, 1] != others[i, 1]:
            return 1.0
        worst = max(worst, abs(events[i, 2] - others[i, 2]) / t_end)
    return worst


@function
def compare(compared, k, pulled):
    """Estimates of the errors of run k, its differences to the other; the largest.

    Errors invisible to it are added: reversals that both pass without landing, and rounding. No column is better
    than the largest error of a step. The applied force depends on the motion if a spring has `pulled` only.
    """
    errors, peaks, worst = compared.errors, compared.peaks, 0.0
    hidden = peaks[laws.MODE] + STEP_ROUNDING * compared.counts[STEPS]
    for column in range(errors.size):
        errors[column] = 0.0
    for column in (laws.X, laws.V, laws.Z, laws.FA, laws.FF, laws.WA, laws.WF):
        size, difference = peaks[column], 0.0
        for i in range(compared.records.shape[1]):
            size = max(size, abs(compared.records[k, i, column]))
            difference = max(difference, abs(compared.records[0, i, column] - compared.records[1, i, column]))
        for i in range(compared.instants.size):
            if compared.instants[i] < inf:
                difference = max(difference, abs(compared.checks[0, i, column] - compared.checks[1, i, column]))
        if size > 0.0 and (pulled or column != laws.FA):
            errors[column] = max(difference / size, peaks[laws.T]) + hidden
        worst = max(worst, errors[column])
    return worst
