"""What a run of a chart is, and how its time is taken.

Two clocks: one runs while time is stepped, sampling of sources included; the other from the call to its answer, as a
user waits for it. Compiling is in neither. A time is the median of several runs.
"""

from collections.abc import Callable
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

RUNS, MOST_RUNS = 5, 5  # of which the median is taken, and how many times that if they are short


class Effort(NamedTuple):
    """How far a chart goes."""

    instants: int  # compared
    longest: float  # s of one run; refinement ends beyond
    refinements: int  # halvings of the step, at most
    runs: int


FULL, QUICK = Effort(200, 0.1, 12, RUNS), Effort(40, 0.01, 3, 1)

Traces = dict[str, NDArray]


class TimedRun(NamedTuple):
    """Instants, efforts by probe, seconds of stepping alone and in all, and the error as estimated, if it is.

    Between its instants a run is what its method says, or the straight line that programs draw.
    """

    t: NDArray
    u: Traces
    stepping: float
    seconds: float
    estimated: float = np.inf
    between: Callable[[str, NDArray], NDArray] | None = None

    def at(self, probe: str, t: NDArray) -> NDArray:
        """Efforts of a probe at any instants."""
        return self.between(probe, t) if self.between else np.interp(t, self.t, self.u[probe])


def timed(run: Callable[[], TimedRun], effort: Effort) -> TimedRun:
    """A run with the medians of its times: of at least as many runs as asked, of more if they are short."""
    run()  # compiles, or loads what is compiled
    runs, spent = [], 0.0
    while len(runs) < effort.runs or (spent < effort.longest and len(runs) < MOST_RUNS * effort.runs):
        runs.append(run())
        spent += runs[-1].seconds
    return runs[0]._replace(stepping=median(r.stepping for r in runs), seconds=median(r.seconds for r in runs))
