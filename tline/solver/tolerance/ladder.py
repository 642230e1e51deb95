"""Runs on ever finer grids, each compared with the one before: how accurate each is, and what forbids a finer one.

Whoever asks for a tolerance brings the grids and makes the runs; what these attempts are worth is told here alone.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import inf, log

from tline.solver.description.description import Description
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.notes import smeared
from tline.solver.result.result import Result
from tline.solver.tolerance.budget import Budget
from tline.solver.tolerance.compare import compare, with_errors

HELPS = 0.5  # a step that leaves more of the difference than this does not converge
MOST_INSIDE = 2e7  # line-end samples in all runs together, for the sake of instants inside slabs alone,
WORTH = 64  # or so many times those of the first run, if that is more
TRIED = 2  # halvings of the slab, from which the next ones are foretold,
FORETOLD = 2e6  # and line-end samples in all runs together: before, runs may converge slower than they will; so few
# are cheap where nothing else is computed inside lines
STALE, CHEAP = 2, 1e5  # halvings of the slab in a row that may bring nothing; line-end samples that are tried anyway
MOST_SAMPLES = 3e9  # line-end samples in all runs together
LOST = 0.3  # estimates beyond, one after the other, with cavities: no run resembles another
COLLAPSE = (
    ": cavities collapse at other instants in each run, and that spreads; order = 1 and no tolerance give one run"
)


class Ladder:
    """The runs so far, and the best of them.

    Parameters
    ----------
    description : Description
    first : Result
    tol : float
    unknown : float
        Share of a difference that a step leaves, as long as there is one difference.

    Attributes
    ----------
    last : Result
        The finest run.
    told : Accuracy
        Estimated errors of the run before it, which bound its own.
    helps : bool
        Whether the last step converged.
    stale : int
        Halvings of the slab in a row that brought nothing.
    """

    def __init__(self, description: Description, first: Result, tol: float, unknown: float = SLOWEST):
        self.description, self.unknown = description, unknown
        self.last, self.helps, self.stale = first, True, 0
        self.told = Accuracy(tol)
        self._attempts, self._differences = [Attempt.of(first)], [self.told]
        self._best, self._accuracy, self._pair = first, self.told, None

    @property
    def compared(self) -> int:
        """Pairs of runs so far."""
        return len(self._differences) - 1

    def climb(self, finer: Result) -> None:
        """Take a finer run, and compare the last one with it."""
        pair = self.description, self.last, finer, self.told.tol, self._differences[1:], self.unknown
        comparison = compare(*pair)
        self.told = comparison.errors
        self._differences.append(comparison.differences)
        self._attempts[-1] = replace(self._attempts[-1], estimate=self.told.worst)
        self._attempts.append(Attempt.of(finer))
        if better(self.told, self._accuracy):
            self._best, self._accuracy, self._pair = with_errors(finer, self.last, comparison.by), self.told, pair
        blind, left = finer.resolution.blind, gained(*self._differences[-2:])
        self.helps = not blind and left <= HELPS
        narrowed = finer.resolution.h < self.last.resolution.h
        self.stale = self.stale + 1 if narrowed and not blind and left >= 1.0 else 0
        self.last = finer

    def limit(self, most: float, budget: Budget) -> str:
        """What forbids a finer run, of so many line-end samples in all; empty if nothing does."""
        foretell = foretells(self._attempts, self.description)
        assert self.told.tol is not None
        limit = budget.limit(self._attempts, self.told.tol)
        limit = limit or limit_of(self._attempts, foretell * self.stale, self.description.collapses, most)
        if self.description.blurred and self.compared > 1:  # by jumps inside slabs, which no finer run follows
            limit = limit or inside_slabs(self.told)
        return limit or (not self.last.resolution.blind and inside_limit(self._attempts, self.told, foretell)) or ""

    def result(self, limit: str) -> Result:
        """The best run, and how accurate it is; `limit` is what forbade to go on, if anything did."""
        best, accuracy, tol = self._best, self._accuracy, self.told.tol
        assert tol is not None
        if self._pair and accuracy.at_slab_ends > tol:
            accuracy = compare(*self._pair, whole=True).errors
        damped = () if limit else best.resolution.notes  # that does not matter where the tolerance is met
        damped += tuple(smeared(best.fronts)) if best.fronts.lost <= tol and not limit else ()
        unresolved = tuple(note for note in best.unresolved if note not in damped)
        limit = limit and (inside_slabs(accuracy) or limit)
        accuracy = replace(accuracy, attempts=tuple(self._attempts), limit=limit)
        elements = {where: each for where, each in best.elements.items() if len(each.states)}
        return replace(best, elements=elements, unresolved=unresolved, accuracy=accuracy)


def rank(found: Accuracy) -> tuple[float, float]:
    """What orders runs by their accuracy: slab ends first, as long as these are not as asked; then any instant."""
    assert found.tol is not None
    return max(found.at_slab_ends, found.tol), found.worst


def better(found: Accuracy, best: Accuracy) -> bool:
    """Whether a run is at least as accurate as another."""
    return rank(found) <= rank(best)


def gained(before: Accuracy, found: Accuracy) -> float:
    """What a step left of the difference: at slab ends as long as these are not as asked, and then inside."""
    assert found.tol is not None
    here, there = (
        (accuracy.at_slab_ends if found.at_slab_ends > found.tol else accuracy.worst) for accuracy in (found, before)
    )
    return here / there if there > 0 else inf


def foretells(attempts: Sequence[Attempt], description: Description) -> bool:
    """Whether the runs so far tell how the next ones would converge."""
    return description.dispersive or description.collapses or sum(a.samples for a in attempts) >= FORETOLD


def limit_of(attempts: Sequence[Attempt], stale: int, collapses: bool, most: float) -> str:
    """What forbids a finer run; empty if nothing does."""
    told = [a.estimate for a in attempts if a.estimate is not None][-STALE - 1 :]
    samples, next_ = sum(a.samples for a in attempts), _growth(attempts) * attempts[-1].samples
    lost = collapses and len(told) > 1 and min(told) > (LOST if len(told) > STALE else 1.0)
    if (stale >= STALE and (collapses or samples > CHEAP)) or lost:
        return f"narrower slabs do not help{COLLAPSE * collapses}"
    if samples + next_ > most:
        return f"a finer run would take the total beyond {most:.0e} line-end samples"
    return ""


def inside_limit(attempts: Sequence[Attempt], found: Accuracy, foretell: bool = True) -> str:
    """What forbids finer runs for the sake of instants inside slabs: that they would not be enough."""
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
    """By how much a halved slab multiplies samples: by two, and by four in segments, of which there are more."""
    halved = [fine.samples / rough.samples for rough, fine in pairwise(attempts) if fine.slab < rough.slab]
    return max([2.0, *halved[-1:]])


def inside_slabs(accuracy: Accuracy) -> str:
    """What kept the tolerance from being met, if that was not at slab ends."""
    if accuracy.tol is None or accuracy.at_slab_ends > accuracy.tol or accuracy.worst <= accuracy.tol:
        return ""
    name, told = max(accuracy.inside.items(), key=lambda item: item[1].worst)
    return (
        f"inside slabs the error at '{name}' is up to {told.worst:.1g}, where a law or a front bends the wave; at slab "
        f"ends it is {accuracy.at_slab_ends:.1g}: read values there, ask for less, or give a narrower slab"
    )
