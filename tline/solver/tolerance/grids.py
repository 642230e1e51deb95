"""Runs whose delays are rounded to whole slabs, on ever narrower ones, until extremes no longer move.

This is the method of characteristics of textbooks, in the first order: no front lies inside a slab, so a network of
many pipes costs little. Fronts arrive up to half a slab early or late at every pipe's end; the tolerance is therefore
one of the highest and the lowest values, at all nodes and probes.

"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError, NoFlowError
from tline.solver.description.resolution import resolution
from tline.solver.result.accuracy import Accuracy, Estimate
from tline.solver.result.result import ProbeResult, Result
from tline.solver.tolerance.compare import Difference, relative
from tline.solver.tolerance.ladder import Grids, Ladder, Search, Step, limit_of

CAUTION = 2.0  # ratio of errors to differences: rounded delays err at random, and by half as much on half the slab


class Rounded(Grids):
    """Slabs halved until the extremes of two runs agree to the tolerance; at least two comparisons are made."""

    latest = True

    def __init__(self, search: Search):
        super().__init__(search._replace(envelope=True))

    def first(self) -> Result:
        """The run on the widest slabs."""
        return self.search.run(resolution(self.search.description))

    def next(self, ladder: Ladder) -> Result:
        """The run on slabs half as wide; where it finds no flow, no finer one is tried."""
        try:
            return self.search.run(resolution(self.search.description, h=ladder.last.resolution.h / 2))
        except NoFlowError as error:
            raise InputError(error.where, error.problem) from error

    def step(self, ladder: Ladder, finer: Result) -> Step:
        """Estimate errors from the change of extremes; at each node no less than half the previous estimate."""
        told, before = compared(self.search.tol, ladder.last, finer), ladder.best.envelope
        assert finer.envelope is not None
        assert before is not None
        halved = {key: getattr(before, key) / 2 for key in ("lowest_error", "highest_error")}
        return Step(replace(finer, envelope=replace(finer.envelope, **halved)), told, CAUTION)

    def is_enough(self, ladder: Ladder) -> bool:
        """Whether the tolerance is met; a single comparison is no proof."""
        return ladder.compared > 1 and ladder.told.met

    def limit(self, ladder: Ladder) -> str:
        """Reason against a finer run: too many samples; empty if none."""
        return limit_of(ladder.attempts, 0, False, self.search.most)


def compared(tol: float | None, coarse: Result, fine: Result) -> Accuracy:
    """Errors by the differences of extremes.

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
    return Accuracy(tol, told, told, told)


def _extremes(probe: ProbeResult) -> NDArray:
    """Lowest and highest gauge effort, and flow times impedance, at slab ends; shape (2, 2)."""
    seen = probe.at_slab_ends
    both = np.stack([seen.gauge_pressure, probe.record.z0 * seen.y], axis=1)
    return np.stack([both.min(axis=0), both.max(axis=0)])
