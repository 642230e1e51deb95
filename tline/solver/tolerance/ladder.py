"""Runs on ever finer grids, each compared with the one before: how accurate each is, and what forbids a finer one.

Whoever asks for a tolerance brings the grids and makes the runs; what these attempts are worth is told here alone.
"""

from dataclasses import replace
from math import inf

from tline.solver.description.description import Description
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import Result
from tline.solver.tolerance.compare import compare, with_errors
from tline.solver.tolerance.limits import foretells, inside_limit, inside_slabs, limit_of

HELPS = 0.5  # a step that leaves more of the difference than this does not converge


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

    def limit(self, most: float) -> str:
        """What forbids a finer run, of so many line-end samples in all; empty if nothing does."""
        foretell = foretells(self._attempts, self.description)
        limit = limit_of(self._attempts, foretell * self.stale, self.description.collapses, most)
        return limit or (not self.last.resolution.blind and inside_limit(self._attempts, self.told, foretell)) or ""

    def result(self, limit: str) -> Result:
        """The best run, and how accurate it is; `limit` is what forbade to go on, if anything did."""
        best, accuracy, tol = self._best, self._accuracy, self.told.tol
        assert tol is not None
        if self._pair and accuracy.at_slab_ends > tol:
            accuracy = compare(*self._pair, whole=True).errors
        damped = () if limit else best.resolution.notes  # that does not matter where the tolerance is met
        unresolved = tuple(note for note in best.unresolved if note not in damped)
        limit = limit and (inside_slabs(accuracy) or limit)
        accuracy = replace(accuracy, attempts=tuple(self._attempts), limit=limit)
        return replace(best, elements={}, unresolved=unresolved, accuracy=accuracy)


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
