"""Runs whose delays are rounded to whole slabs, on ever narrower ones, until extremes no longer move.

This is the method of characteristics of textbooks, in the first order: no front lies inside a slab, so a network of
many pipes costs little. Fronts arrive up to half a slab early or late at every pipe's end; what a tolerance is about
are therefore the highest and the lowest values, at all nodes and probes.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.resolution import resolution
from tline.solver.result.accuracy import Accuracy, Attempt, Estimate
from tline.solver.result.result import ProbeResult, Result
from tline.solver.tolerance.compare import relative
from tline.solver.tolerance.difference import Difference
from tline.solver.tolerance.ladder import Search, limit_of

CAUTION = 2.0  # errors over differences: delays that are rounded err at random, and by half as much on half the slab


def rounded(search: Search) -> Result:
    """Halve slabs until the extremes of two runs differ by what is asked; two comparisons are made at least."""
    search = search._replace(envelope=True)
    chosen = resolution(search.description)
    result = search.run(chosen)
    attempts, found, limit = [Attempt.of(result)], Accuracy(search.tol), ""
    while not limit and (found.worst > search.tol or len(attempts) < 3):
        try:
            finer = search.run(resolution(search.description, h=result.resolution.h / 2))
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
            break
        found, result = compared(search.tol, result, finer)
        attempts[-1] = replace(attempts[-1], estimate=found.worst)
        attempts.append(Attempt.of(finer))
        limit = search.budget.limit(attempts, search.tol) or limit_of(attempts, 0, False, search.most)
    limit = limit if found.worst > search.tol else ""
    return replace(result, accuracy=replace(found, attempts=tuple(attempts), limit=limit))


def compared(tol: float | None, coarse: Result, fine: Result) -> tuple[Accuracy, Result]:
    """Errors by the differences of extremes, and the finer run with those of its envelope.

    Those at nodes are relative to the largest effort of all (pressures are gauge pressures), as those at a probe are to
    its own; no probe is said to be better than that.
    """
    assert fine.envelope is not None
    assert coarse.envelope is not None
    envelope = fine.envelope.compared(coarse.envelope, CAUTION)
    weight = np.nan_to_num(envelope.weight)
    most = max(np.abs(envelope.highest - weight).max(), np.abs(envelope.lowest - weight).max())
    worst = max(envelope.highest_error.max(), envelope.lowest_error.max()) / most if most > 0 else 0.0
    seen = {name: (_extremes(coarse.probes[name]), _extremes(probe)) for name, probe in fine.probes.items()}
    off = {name: (CAUTION * np.abs(a - b).max(axis=0), np.abs(b).max(axis=0)) for name, (a, b) in seen.items()}
    told, *_ = relative({name: Difference(error, error, error, size) for name, (error, size) in off.items()})
    told = {name: each.or_more(Estimate(float(worst), 0.0)) for name, each in told.items()}
    return Accuracy(tol, told, told, told), replace(fine, envelope=envelope)


def _extremes(probe: ProbeResult) -> NDArray:
    """Lowest and highest gauge effort, and flow times impedance, at slab ends; shape (2, 2)."""
    seen = probe.at_slab_ends
    both = np.stack([seen.gauge_pressure, probe.record.z0 * seen.y], axis=1)
    return np.stack([both.min(axis=0), both.max(axis=0)])
