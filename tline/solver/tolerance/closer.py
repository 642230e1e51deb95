"""Runs of scenes that come ever closer to the one that is asked for, until that changes little."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np

from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import Result
from tline.solver.tolerance.compare import added, relative
from tline.solver.tolerance.difference import Difference

CLOSER = 0.1  # tolerance of the next over what the last step changed
SHARE = 1 / 3  # of the tolerance, for what slabs may have wrong
OFF = 0.618  # of what is between them: places of instants at which two runs are compared, between round ones
INSTANTS, PER_SLAB, MOST = 4001, 4, 200_000
ROUGH = 1e-3  # tolerance of the slabs of the first runs
MOST_SAMPLES = 3e7  # line-end samples of all runs
GROWTH = 6  # times as many samples with each doubling of places where losses mix modes


class Step(NamedTuple):
    """A run, of the tolerance of its slabs."""

    run: Callable[[float], Result]
    left: float | None = None  # of what it changes, that is still wrong, if that is known


def closer(
    steps: Iterator[Step], tol: float, too_far: Callable[[int, int, float], str], rough: float = 0.0
) -> Result | None:
    """Make runs until the estimated error is within a tolerance, or a limit is reached; None of a single one.

    Where each step leaves the share r of the change before, the next ones leave r + r² + …; r counts as a half at most,
    and as that after the first.

    Parameters
    ----------
    steps : iterator of Step
        At its end nothing closer can be had.
    tol : float
    too_far : callable
        What forbids the next run, if anything does: of the number of steps, of all samples and of the last change.
    rough : float
        Tolerance of the slabs of the first runs, where that of all would be less.
    """
    close, samples, share, last = max(rough, SHARE * tol), 0, SLOWEST, 0.0
    first = next(steps, None)
    if first is None:
        return None
    coarse, result, attempts = first.run(close), None, ()
    for number, step in enumerate(steps, 1):
        fine = step.run(close)
        assert coarse.accuracy
        assert fine.accuracy
        attempts += coarse.accuracy.attempts
        samples += sum(attempt.samples for attempt in fine.accuracy.attempts)
        changed = _changes(coarse, fine)
        share = min(changed.worst / last, SLOWEST) if last > 0 else SLOWEST
        last = changed.worst
        by = share / (1 - share) if step.left is None else step.left
        left = changed.times(by, by)
        own = fine.accuracy
        sums = (added(one, other) for one, other in zip(_parts(own), _parts(left), strict=True))
        accuracy = Accuracy(tol, *sums, attempts=(*attempts, *own.attempts), limit=own.limit)
        if not accuracy.limit and accuracy.worst > tol:
            accuracy = replace(accuracy, limit=too_far(number, samples, last))
        result = replace(fine, accuracy=accuracy, unresolved=() if accuracy.met else fine.unresolved)
        if accuracy.met or accuracy.limit:
            break
        coarse, close = fine, max(min(close, CLOSER * last), SHARE * tol)
    return result


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


def with_mixed_modes(run: Callable[[int, float], Result], tol: float) -> Result:
    """Double the places of losses until the estimated error is within a tolerance, or a limit is reached.

    Places are of first order behind jumps, and nearly of second behind corners.

    Parameters
    ----------
    run : callable
        Of a number of doublings and the tolerance of its slabs.
    tol : float
    """

    def too_far(steps: int, samples: int, last: float) -> str:
        if GROWTH * samples <= MOST_SAMPLES:
            return ""
        return f"the losses mix the modes; {steps} doublings of the places where they stand leave {last:.1g}"

    result = closer((Step(partial(run, doublings)) for doublings in count()), tol, too_far, ROUGH)
    assert result
    return result
