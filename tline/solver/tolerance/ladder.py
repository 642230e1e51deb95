"""One loop for all tolerances: runs on ever finer grids, each compared with the one before.

Subclasses of `Grids` choose the grids: orders and slabs, places of losses, slabs of convolutions. The error of a run,
the choice of the result and the reason to stop are found here alone.
"""

import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise
from math import ceil, inf, log
from typing import Any, NamedTuple

from tline.compiled.announce import compiling_seconds
from tline.errors import InputError, NoFlowError
from tline.solver.description.description import Description
from tline.solver.description.resolution import Resolution
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.notes import smeared
from tline.solver.result.result import Result
from tline.solver.run import NO_KINKS, Kinks, run
from tline.solver.tolerance.compare import compare, with_errors
from tline.words.progress import DELAY

MOST_SECONDS = 600  # default, if no limit is given
PACE = 0.5  # share of an estimate that a run is assumed to leave before anything is known
SAMPLES = 2.0  # smallest growth of samples from one run to the next
HELPS = 0.5  # a step that leaves a larger share of the difference does not converge
MISSED = 4  # grids in a row without a flow, at most
MOST_INSIDE = 2e7  # line-end samples in all runs together, for the sake of instants inside slabs alone,
WORTH = 64  # or this many times those of the first run, if that is more
TRIED = 2  # halvings of the slab, from which the next ones are predicted,
FORETOLD = 2e6  # and line-end samples in all runs together: before, runs may converge slower than they will; so few
# are cheap where nothing else is computed inside lines
STALE, CHEAP = 2, 1e5  # halvings of the slab in a row without gain; line-end samples that are tried anyway
MOST_SAMPLES = 3e9  # line-end samples in all runs together
LOST = 0.3  # consecutive estimates beyond this, with cavities: no run resembles another
COLLAPSE = (
    ": cavities collapse at other instants in each run, and that spreads; order = 1 and no tolerance give one run"
)


class Budget:
    """Computing time from now on for all runs of a search, without compilation.

    Ten minutes if none is given; if shown, the expected remaining time is printed after two seconds.
    """

    def __init__(self, seconds: float | None = None, shown: bool = False):
        self.asked, self.seconds, self._shown = seconds is not None, seconds or MOST_SECONDS, shown
        self._started = self._begun = _passed()
        self._keeps: Callable[[Any], float] = lambda best: 0.0

    @property
    def left(self) -> float:
        """Seconds that are left; below zero if they are over."""
        return self.seconds - (_passed() - self._started)

    def keeping(self, keeps: Callable[[Any], float]) -> "Budget":
        """Return a budget for a search from now on that leaves `keeps(best)` seconds to others, or all (inf)."""
        other = copy(self)
        other._begun, other._keeps = _passed(), keeps
        return other

    def limit(self, attempts: Sequence[Attempt], tol: float, least: float = 1.0, best: Any = None) -> str:
        """Reason against one more run after these, each with the time of its comparison; empty if none.

        A run is of use with at least `least` times as many samples as the last one; the best result is `best`.
        """
        passed, kept = self.seconds - self.left, self._keeps(best)
        stepping = sum(attempt.seconds for attempt in attempts)
        takes = (_passed() - self._begun) * attempts[-1].seconds / stepping if stepping else 0.0
        growth = max([SAMPLES, *(fine.samples / rough.samples for rough, fine in pairwise(attempts[-2:]))])
        if self._shown and passed > DELAY:
            self._shown = False
            told = [attempt.estimate for attempt in attempts if attempt.estimate]
            pace = min(told[-1] / told[-2], PACE) if len(told) > 1 and told[-1] > 0 else PACE
            runs = max(ceil(log(tol / told[-1]) / log(pace)), 1) if told else 1
            expected = takes * sum(growth**k for k in range(1, runs + 1))
            sys.stderr.write(f"some {expected:.2g} s more are expected\n")
        if passed + max(growth, least) * takes <= self.seconds - kept:
            return ""
        if kept == inf:
            return "all the time that is left is kept for runs that follow"
        wanted = "a finer run" if least <= growth else "a run in which no oscillation passes unseen"
        return f"{wanted} would take the total beyond {self.seconds - kept:g} s"


def _passed() -> float:
    return time.process_time() - compiling_seconds()


class Step(NamedTuple):
    """Contribution of a finer run to those before it."""

    result: Result  # that run, or the extrapolation from it and others
    told: Accuracy  # estimated errors: of the run before it, which bound its own, or of the extrapolation
    by: float  # ratio of errors to differences from the run before it
    differences: Accuracy | None = None  # from the run before it, if errors are estimated from them


class Start(NamedTuple):
    """Start of a search, found by a search with other values."""

    order: int
    left: float  # of a difference, by a step of the order
    halved: int = 0  # halvings of the slab that suit the scene
    told: float = inf  # error estimate of a search on this grid


class Search(NamedTuple):
    """Request for a search: scene, tolerance, records and limits."""

    description: Description
    tol: float  # 0 where order or slab are fixed by hand, and none is asked
    record: list[str]
    progress: bool
    budget: Budget
    most: float = MOST_SAMPLES  # largest number of line-end samples
    envelope: bool = False
    ledger: bool | None = None
    active: bool = False  # whether active elements are allowed
    start: Start | None = None  # from a run with other values

    def run(
        self, chosen: Resolution, kinks: Kinks = NO_KINKS, laws: Sequence[str] = (), slabs: int | None = None
    ) -> Result:
        """Run to the scene's end time, or for a number of slabs."""
        asked = self.description, chosen, self.record
        return run(*asked, envelope=self.envelope, progress=self.progress, kinks=kinks, laws=laws, slabs=slabs)


class Grids(ABC):
    """Ever finer grids for one way to compute a scene."""

    unknown = SLOWEST  # share of a difference that a step leaves, as long as there is one difference
    latest = False  # whether the finest run is the result, though an earlier error estimate may be smaller by chance

    def __init__(self, search: Search):
        self.search = search

    @abstractmethod
    def first(self) -> Result:
        """The run on the first grid."""

    @abstractmethod
    def next(self, ladder: "Ladder") -> Result:
        """The run on the next finer grid.

        Raises
        ------
        StopIteration
            No finer grid exists.
        NoFlowError
            No flow was found there; the next may do.
        InputError
            It cannot be computed, and no finer one.
        """

    def step(self, ladder: "Ladder", finer: Result) -> Step:
        """Estimate the error of the last run from its difference to a finer one."""
        pair = ladder.last, finer, self.search.tol, ladder.differences, self.unknown
        return Step(finer, *compare(self.search.description, *pair))

    def is_enough(self, ladder: "Ladder") -> bool:
        """Whether the tolerance is met, as far as is known how fast runs converge."""
        return ladder.told.met

    def limit(self, ladder: "Ladder") -> str:
        """Reason against a finer run, apart from the budget; empty if none."""
        return ladder.limit()


class Ladder:
    """The runs so far, and the best of them.

    `last` is the finest run, `told` its errors after the last step, and `helps` whether that converged; `stale` counts
    halvings of the slab in a row without gain; `best` is the result.
    """

    def __init__(self, grids: Grids, first: Result):
        self._grids, self.search = grids, grids.search
        self.last, self.helps, self.stale, self.attempts = first, True, 0, [Attempt.of(first)]
        self.left, self._orders = 1.0, 1
        self.told, self.differences = Accuracy(self.search.tol), []
        self.best, self._accuracy, self._steps = first, self.told, [self.told]
        self._pair = None

    @property
    def compared(self) -> int:
        """Pairs of runs so far."""
        return len(self.attempts) - 1

    @property
    def least(self) -> float:
        """Smallest growth of samples for a run in which every oscillation is resolved."""
        periods = (period for _, period in self.search.description.time_scales.values())
        chosen = self.last.resolution
        return chosen.resolved / min(periods, default=inf) if chosen.blind else 1.0

    def climb(self, finer: Result) -> None:
        """Take a finer run."""
        step = self._grids.step(self, finer)
        self.told, steps = step.told, step.differences or step.told
        self.attempts[-1] = replace(self.attempts[-1], estimate=self.told.worst)
        self.attempts.append(Attempt.of(finer))
        if self._grids.latest or rank(self.told) <= rank(self._accuracy):
            self.best, self._accuracy = with_errors(step.result, self.last, step.by), self.told
            self._pair = step.differences and (self.last, finer, self.search.tol, [*self.differences])
        self._steps.append(steps)
        self.differences += [step.differences] if step.differences else []
        blind, narrowed = finer.resolution.blind, finer.resolution.h < self.last.resolution.h
        self.left = gained(*self._steps[-2:]) ** (1 / self._orders)
        self._orders = max(finer.resolution.s - self.last.resolution.s, 1)
        self.helps = not blind and self.left <= HELPS
        self.stale = self.stale + 1 if narrowed and not blind and self.left >= 1.0 else 0
        self.last = finer

    def limit(self) -> str:
        """Reason against a finer run, as predicted from the runs so far; empty if none."""
        description, attempts = self.search.description, self.attempts
        foretell = description.dispersive or description.collapses or sum(a.samples for a in attempts) >= FORETOLD
        limit = limit_of(attempts, foretell * self.stale, description.collapses, self.search.most)
        if description.blurred and self.compared > 1:  # by jumps inside slabs, which no finer run follows
            limit = limit or inside_slabs(self.told)
        return limit or (not self.last.resolution.blind and inside_limit(attempts, self.told, foretell)) or ""

    def result(self, limit: str) -> Result:
        """Return the best run and its accuracy; `limit` is the reason to stop, if there was one."""
        best, accuracy, tol = self.best, self._accuracy, self.search.tol
        if self._pair and accuracy.at_slab_ends > tol:
            accuracy, *_ = compare(self.search.description, *self._pair, self._grids.unknown, whole=True)
        damped = () if limit else best.resolution.notes  # that does not matter where the tolerance is met
        damped += tuple(smeared(best.fronts)) if best.fronts.lost <= tol and not limit else ()
        unresolved = tuple(note for note in best.unresolved if note not in damped)
        limit = limit and (inside_slabs(accuracy) or limit)
        accuracy = replace(accuracy, attempts=tuple(self.attempts), limit=limit)
        elements = {where: each for where, each in best.elements.items() if len(each.states)}
        return replace(best, elements=elements, unresolved=unresolved, accuracy=accuracy)


def refined(grids: Grids) -> Result:
    """Run on ever finer grids until the estimated error is within the tolerance, or a limit is reached."""
    ladder, missed, limit = Ladder(grids, grids.first()), 0, ""
    while not limit:
        try:
            ladder.climb(grids.next(ladder))
        except StopIteration:
            limit = "order and slab are as fine as they may be"
        except NoFlowError as error:
            missed, ladder.helps = missed + 1, False
            limit = f"{error.where}: {error.problem}" if missed > MISSED else ""
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
        else:
            if grids.is_enough(ladder):
                break
            asked = ladder.attempts, grids.search.tol, ladder.least, ladder.best
            limit = grids.search.budget.limit(*asked) or grids.limit(ladder)
    return ladder.result(limit)


def rank(found: Accuracy) -> tuple[float, float]:
    """Sort key of runs by accuracy: error at slab ends, as long as beyond the tolerance; then at any instant."""
    assert found.tol is not None
    return max(found.at_slab_ends, found.tol), found.worst


def gained(before: Accuracy, found: Accuracy) -> float:
    """Share of the difference left by a step: at slab ends as long as these are beyond the tolerance, then inside."""
    assert found.tol is not None
    here, there = (
        (accuracy.at_slab_ends if found.at_slab_ends > found.tol else accuracy.worst) for accuracy in (found, before)
    )
    return here / there if there > 0 else inf


def limit_of(attempts: Sequence[Attempt], stale: int, collapses: bool, most: float) -> str:
    """Reason against a finer run; empty if none."""
    told = [a.estimate for a in attempts if a.estimate is not None][-STALE - 1 :]
    samples, next_ = sum(a.samples for a in attempts), _growth(attempts) * attempts[-1].samples
    lost = collapses and len(told) > 1 and min(told) > (LOST if len(told) > STALE else 1.0)
    if (stale >= STALE and (collapses or samples > CHEAP)) or lost:
        return f"narrower slabs do not help{COLLAPSE * collapses}"
    if samples + next_ > most:
        return f"a finer run would take the total beyond {most:.0e} line-end samples"
    return ""


def inside_limit(attempts: Sequence[Attempt], found: Accuracy, foretell: bool = True) -> str:
    """Reason against finer runs for instants inside slabs: they would not suffice; empty if none."""
    assert found.tol is not None
    if found.at_slab_ends > found.tol or found.worst <= found.tol:
        return ""
    told = [(a.slab, a.estimate) for a in attempts if a.estimate is not None]
    halvings = [worst for (h, _), (slab, worst) in pairwise(told) if slab < h]
    samples = sum(a.samples for a in attempts)
    left = log(max(max(MOST_INSIDE, WORTH * attempts[0].samples) / samples, 1.0), _growth(attempts))
    if left < 1:
        return "no room"
    if len(halvings) < TRIED or not foretell:
        return ""
    widest = max(worst for slab, worst in told if slab > told[-1][0])
    pace = (widest / found.worst) ** (1 / len(halvings))
    return "" if pace > 1 and found.worst <= found.tol * pace**left else "too slow"


def _growth(attempts: Sequence[Attempt]) -> float:
    """Growth of samples by a halved slab: as in the last halving, at least two."""
    halved = [fine.samples / rough.samples for rough, fine in pairwise(attempts) if fine.slab < rough.slab]
    return max([2.0, *halved[-1:]])


def inside_slabs(accuracy: Accuracy) -> str:
    """Explain that the tolerance is missed inside slabs alone; empty if it is not so."""
    if accuracy.tol is None or accuracy.at_slab_ends > accuracy.tol or accuracy.worst <= accuracy.tol:
        return ""
    name, told = max(accuracy.inside.items(), key=lambda item: item[1].worst)
    return (
        f"inside slabs the error at '{name}' is up to {told.worst:.1g}, where a law or a front bends the wave; at slab "
        f"ends it is {accuracy.at_slab_ends:.1g}: read values there, ask for less, or give a narrower slab"
    )
