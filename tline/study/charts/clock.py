"""What a run of a chart is, and how its time is taken.

The clock runs while time is stepped, sampling of sources included; compiling, reading the scene and setting up are not
in it. A time is the median of several runs.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

RUNS, MOST_RUNS = 5, 5  # of which the median is taken, and how many times that if they are short


class Effort(NamedTuple):
    """How far a chart goes."""

    instants: int  # compared, at most
    longest: float  # s of one run; refinement ends beyond
    refinements: int  # halvings of the step, at most
    runs: int


FULL, QUICK = Effort(200, 0.2, 12, RUNS), Effort(40, 0.01, 3, 1)

# seconds by which the first run of a process is longer than its second
START = """
import time
from tline.study.charts.scenes import chart_scene
from tline.solver.simulate import simulate
scene = chart_scene("rc").scene
instants = [time.perf_counter()]
for _ in range(2):
    simulate(scene)
    instants.append(time.perf_counter())
print(2 * instants[1] - instants[0] - instants[2])
"""

Traces = dict[str, NDArray]


class TimedRun(NamedTuple):
    """Instants, efforts by probe, seconds of stepping alone and in all, and the error as estimated, if it is."""

    t: NDArray
    u: Traces
    seconds: float
    first: float
    estimated: float = np.inf


def timed(run: Callable[[], TimedRun], effort: Effort) -> TimedRun:
    """A run with the medians of its times: of at least as many runs as asked, of more if they are short."""
    run()  # compiles, or loads what is compiled
    runs, spent = [], 0.0
    while len(runs) < effort.runs or (spent < effort.longest and len(runs) < MOST_RUNS * effort.runs):
        runs.append(run())
        spent += runs[-1].first
    return runs[0]._replace(seconds=median(r.seconds for r in runs), first=median(r.first for r in runs))


@cache
def compilation() -> str:
    """What stands beside the clock, in one sentence, measured in two new processes with a numba cache of their own."""
    with tempfile.TemporaryDirectory() as folder:
        call, own = [sys.executable, "-W", "ignore", "-c", START], os.environ | {"NUMBA_CACHE_DIR": folder}
        cold, warm = (
            float(subprocess.run(call, env=own, check=True, capture_output=True, text=True).stdout) for _ in range(2)
        )
    return f"Not in the slabs' times: compiling, {cold:.1f} s once; loading what is compiled, {warm:.2f} s a process."
