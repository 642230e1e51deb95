"""How long a search may take, and what it expects to take."""

import sys
import time
from collections.abc import Sequence
from itertools import pairwise
from math import ceil, log

from tline.solver.result.accuracy import Attempt
from tline.words.progress import DELAY

MOST_SECONDS = 600  # where nothing is asked
PACE = 0.5  # of an estimate, that a run leaves where nothing is known yet
SAMPLES = 2.0  # times as many in the next run, at least


class Budget:
    """Computing time from now on for all runs of a search.

    Parameters
    ----------
    seconds : float, optional
        How many; ten minutes if not given.
    shown : bool
        Whether it is said, after two seconds, how many more are expected.
    """

    def __init__(self, seconds: float | None = None, shown: bool = False):
        self.asked, self.seconds, self._shown = seconds is not None, seconds or MOST_SECONDS, shown
        self._started = time.process_time()

    @property
    def left(self) -> float:
        """Seconds that are left; below zero if they are over."""
        return self.seconds - (time.process_time() - self._started)

    def limit(self, attempts: Sequence[Attempt], tol: float, least: float = 1.0) -> str:
        """What forbids one more run beside these, each with the time of its comparison; empty if nothing does.

        No run is of use that has not `least` times as many samples as the last one.
        """
        passed = self.seconds - self.left
        stepping = sum(attempt.seconds for attempt in attempts)
        last = passed * attempts[-1].seconds / stepping if stepping else 0.0
        growth = max([SAMPLES, *(fine.samples / rough.samples for rough, fine in pairwise(attempts[-2:]))])
        if self._shown and passed > DELAY:
            self._shown = False
            sys.stderr.write(f"some {_expected(attempts, tol, last, growth):.2g} s more are expected\n")
        if passed + max(growth, least) * last <= self.seconds:
            return ""
        wanted = "a finer run" if least <= growth else "a run in which no oscillation passes unseen"
        return f"{wanted} would take the total beyond {self.seconds:g} s"


def _expected(attempts: Sequence[Attempt], tol: float, last: float, growth: float) -> float:
    """Seconds of all runs to come, at the pace so far."""
    told = [attempt.estimate for attempt in attempts if attempt.estimate]
    pace = min(told[-1] / told[-2], PACE) if len(told) > 1 and told[-1] > 0 else PACE
    runs = max(ceil(log(tol / told[-1]) / log(pace)), 1) if told else 1
    return last * sum(growth**k for k in range(1, runs + 1))
