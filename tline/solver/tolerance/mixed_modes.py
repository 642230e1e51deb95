"""Conductors whose losses mix the modes and that are no convolution: with twice as many places in each run."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import Result
from tline.solver.tolerance.compare import added, relative
from tline.solver.tolerance.difference import Difference
from tline.solver.tolerance.ladder import Grids, Ladder, Search, Step

CLOSER = 0.1  # tolerance of the next over what the last doubling changed
SHARE = 1 / 3  # of the tolerance, for what slabs may have wrong
OFF = 0.618  # of what is between them: places of instants at which two runs are compared, between round ones
INSTANTS, PER_SLAB, MOST = 4001, 4, 200_000
ROUGH = 1e-3  # tolerance of the slabs of the first runs
MOST_SAMPLES = 3e7  # line-end samples of all runs
GROWTH = 6  # times as many samples with each doubling


class Doublings(Grids):
    """Twice as many places, and slabs as close as these are.

    Places are of first order behind jumps, and nearly of second behind corners. Where each doubling leaves the share r
    of the change before, the next ones leave r + r² + …; r counts as a half at most, and as that after the first.

    `run` takes a number of doublings and the tolerance of its slabs.
    """

    def __init__(self, search: Search, run: Callable[[int, float], Result]):
        super().__init__(search)
        self.run, self.close, self.samples, self.changed = run, max(ROUGH, SHARE * search.tol), 0, 0.0

    def first(self) -> Result:
        """The run with the fewest places."""
        return self.run(0, self.close)

    def next(self, ladder: Ladder) -> Result:
        """The run with twice as many."""
        if ladder.compared:
            self.close = max(min(self.close, CLOSER * self.changed), SHARE * self.search.tol)
        return self.run(ladder.compared + 1, self.close)

    def step(self, ladder: Ladder, finer: Result) -> Step:
        """What places may leave, beside what slabs do."""
        own, found = finer.accuracy, _changes(ladder.last, finer)
        assert own is not None
        self.samples += sum(attempt.samples for attempt in own.attempts)
        share = min(found.worst / self.changed, SLOWEST) if self.changed > 0 else SLOWEST
        self.changed, left = found.worst, found.times(share / (1 - share), share / (1 - share))
        estimates, inside, blurred = (
            added(getattr(own, name), getattr(left, name)) for name in ("estimates", "inside", "blurred")
        )
        told = Accuracy(self.search.tol, estimates, inside, blurred)
        return Step(replace(finer, unresolved=()) if told.met else finer, told, 1.0)

    def is_enough(self, ladder: Ladder) -> bool:
        """Whether the tolerance is met, by slabs, too."""
        return ladder.told.met and not self._own(ladder)

    def limit(self, ladder: Ladder) -> str:
        """What forbids more places: what slabs could not, or time."""
        if self._own(ladder) or GROWTH * self.samples <= MOST_SAMPLES:
            return self._own(ladder)
        problem = f"the losses mix the modes; {ladder.compared} doublings of the places where they stand leave"
        return f"{problem} {self.changed:.1g}"

    def _own(self, ladder: Ladder) -> str:
        return ladder.last.accuracy.limit if ladder.last.accuracy else ""


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
