"""Runs of conductors whose losses mix the modes: with twice as many places of losses until that changes little."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import Result
from tline.solver.tolerance.budget import Budget
from tline.solver.tolerance.compare import added, relative
from tline.solver.tolerance.difference import Difference

CLOSER = 0.1  # tolerance of the next over what the last doubling changed
SHARE = 1 / 3  # of the tolerance, for what slabs may have wrong
OFF = 0.618  # of what is between them: places of instants at which two runs are compared, between round ones
INSTANTS, PER_SLAB, MOST = 4001, 4, 200_000
ROUGH = 1e-3  # tolerance of the slabs of the first runs
MOST_SAMPLES = 3e7  # line-end samples of all runs
GROWTH = 6  # times as many samples with each doubling


def with_mixed_modes(run: Callable[[int, float], Result], tol: float, budget: Budget) -> Result:
    """Double the places of losses until the estimated error is within a tolerance, or a limit is reached.

    Places are of first order behind jumps, and nearly of second behind corners. Where each doubling leaves the share r
    of the change before, the next ones leave r + r² + …; r counts as a half at most, and as that after the first.

    Parameters
    ----------
    run : callable
        Of a number of doublings and the tolerance of its slabs.
    tol : float
    budget : Budget
    """
    close, samples, last, attempts, doublings = max(ROUGH, SHARE * tol), 0, 0.0, (), 1
    coarse = run(0, close)
    while True:
        fine = run(doublings, close)
        assert coarse.accuracy
        assert fine.accuracy
        attempts += coarse.accuracy.attempts
        samples += sum(attempt.samples for attempt in fine.accuracy.attempts)
        changed = _changes(coarse, fine)
        share = min(changed.worst / last, SLOWEST) if last > 0 else SLOWEST
        last = changed.worst
        left = changed.times(share / (1 - share), share / (1 - share))
        own = fine.accuracy
        sums = (added(one, other) for one, other in zip(_parts(own), _parts(left), strict=True))
        accuracy = Accuracy(tol, *sums, attempts=(*attempts, *own.attempts), limit=own.limit)
        if not accuracy.limit and accuracy.worst > tol and GROWTH * samples > MOST_SAMPLES:
            limit = f"the losses mix the modes; {doublings} doublings of the places where they stand leave {last:.1g}"
            accuracy = replace(accuracy, limit=limit)
        elif accuracy.worst > tol and not accuracy.limit:
            accuracy = replace(accuracy, limit=budget.limit(accuracy.attempts, tol))
        if accuracy.met or accuracy.limit:
            return replace(fine, accuracy=accuracy, unresolved=() if accuracy.met else fine.unresolved)
        coarse, close, doublings = fine, max(min(close, CLOSER * last), SHARE * tol), doublings + 1


def _parts(accuracy: Accuracy) -> tuple:
    return accuracy.estimates, accuracy.inside, accuracy.blurred


def _changes(coarse: Result, fine: Result) -> Accuracy:
    """Largest differences of two runs at any instant, over amplitudes."""
    n = min(max(INSTANTS, PER_SLAB * fine.slabs.number), MOST)
    t = (np.arange(n) + OFF) / (n + 1) * fine.slabs.end
    found = {}
    for name, probe in fine.probes.items():
        one, other = (np.array([each.u, each.y]) for each in (coarse.probes[name].at(t), probe.at(t)))
        off, most = abs(one - other).max(axis=1), abs(other).max(axis=1)
        found[name] = Difference(off, off, off, most)
    return Accuracy(None, *relative(found))
