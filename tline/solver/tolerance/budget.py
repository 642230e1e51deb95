"""How long a search may take, and what it expects to take."""

import sys
import time
from collections.abc import Callable, Sequence
from copy import copy
from itertools import pairwise
from math import ceil, log
from typing import Any

from tline.compiled.announce import compiling_seconds
from tline.solver.result.accuracy import Attempt
from tline.words.progress import DELAY

MOST_SECONDS = 600  # where nothing is asked
PACE = 0.5  # of an estimate, that a run leaves where nothing is known yet
SAMPLES = 2.0  # times as many in the next run, at least


class Budget:
    """Computing time from now on for all runs of a search, without what compiling takes.

    Ten minutes if none is given; where it is shown, it is said after two seconds how many more are expected.
    """

    def __init__(self, seconds: float | None = None, shown: bool = False):
        self.asked, self.seconds, self._shown = seconds is not None, seconds or MOST_SECONDS, shown
        self._started = self._begun = _passed()
        self._keeps: Callable[[Any], float] = lambda last: 0.0

    @property
    def left(self) -> float:
        """Seconds that are left; below zero if they are over."""
        return self.seconds - (_passed() - self._started)

    def keeping(self, keeps: Callable[[Any], float]) -> "Budget":
        """The same for a search from now on that leaves so many seconds to others, by its last result."""
        other = copy(self)
        other._begun, other._keeps = _passed(), keeps
        return other

    def limit(self, attempts: Sequence[Attempt], tol: float, least: float = 1.0, last: Any = None) -> str:
        """What forbids one more run beside these, each with the time of its comparison; empty if nothing does.

        No run is of use that has not `least` times as many samples as the last one, whose result is `last`.
        """
        passed, seconds = self.seconds - self.left, self.seconds - self._keeps(last)
        stepping = sum(attempt.seconds for attempt in attempts)
        takes = (_passed() - self._begun) * attempts[-1].seconds / stepping if stepping else 0.0
        growth = max([SAMPLES, *(fine.samples / rough.samples for rough, fine in pairwise(attempts[-2:]))])
        if self._shown and passed > DELAY:
            self._shown = False
            sys.stderr.write(f"some {_expected(attempts, tol, takes, growth):.2g} s more are expected\n")
        if passed + max(growth, least) * takes <= seconds:
            return ""
        wanted = "a finer run" if least <= growth else "a run in which no oscillation passes unseen"
        return f"{wanted} would take the total beyond {seconds:g} s"


def _passed() -> float:
    return time.process_time() - compiling_seconds()


def _expected(attempts: Sequence[Attempt], tol: float, last: float, growth: float) -> float:
    """Seconds of all runs to come, at the pace so far."""
    told = [attempt.estimate for attempt in attempts if attempt.estimate]
    pace = min(told[-1] / told[-2], PACE) if len(told) > 1 and told[-1] > 0 else PACE
    runs = max(ceil(log(tol / told[-1]) / log(pace)), 1) if told else 1
    return last * sum(growth**k for k in range(1, runs + 1))
