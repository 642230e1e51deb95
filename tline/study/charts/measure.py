"""Runs of a chart: measurement of their time and of their errors against the exact solution, and the table of results.

Two times, of the processor where it is this process: while time is stepped, sampling of sources included; and from the
call to its answer, as a user waits for it. Compiling is in neither. Each is the median of several runs.
"""

from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass, field, fields
from functools import partial
from itertools import groupby
from math import inf
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tline.atomic import write_table
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.reference import Solution
from tline.study.reference.friction import FrictionSolution
from tline.study.reference.lossy import LossySolution

RUNS, MOST_RUNS = 5, 5  # of which the median is taken, and how many times that if they are short
DIGITS, DIGITS_BETWEEN = 18, 15
SEED = 0
DEGREE = 16  # between fronts


class Effort(NamedTuple):
    """Effort spent on a chart."""

    instants: int  # compared
    longest: float  # s of one run; refinement ends beyond
    refinements: int  # halvings of the step, at most
    runs: int


FULL, QUICK = Effort(200, 0.1, 12, RUNS), Effort(40, 0.01, 3, 1)

Traces = dict[str, NDArray]


class TimedRun(NamedTuple):
    """Instants, efforts by probe, seconds of stepping alone and in all, and the error as estimated, if it is.

    Between its instants a run is defined by its method, or by the straight line that programs draw.
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
    """Repeat a run for the medians of its times: at least as many runs as asked, more if they are short."""
    run()  # compiles, or loads compiled code
    runs, spent = [], 0.0
    while len(runs) < effort.runs or (spent < effort.longest and len(runs) < MOST_RUNS * effort.runs):
        runs.append(run())
        spent += runs[-1].seconds
    return runs[0]._replace(stepping=median(r.stepping for r in runs), seconds=median(r.seconds for r in runs))


class Known(NamedTuple):
    """Efforts at a probe, exact or as good as that."""

    fronts: NDArray  # instants, s
    efforts: Callable[[NDArray], NDArray]  # at times within the run
    error: float = 0.0  # of them, where no exact solution is known


def interpolated(scene: Scene, probe: str) -> Known:
    """Slow exact solution, interpolated by a polynomial between any two fronts: there it is analytic."""
    solution, t_end = LossySolution(scene, probe), scene.t_end
    edges = np.unique([0.0, *solution.fronts[(solution.fronts > 0) & (solution.fronts < t_end)], t_end])
    nodes, width = chebyshev.chebpts1(DEGREE + 1), np.diff(edges)
    t = edges[:-1, None] + (nodes + 1) / 2 * width[:, None]
    u = np.array(solution.at(t.ravel().tolist(), DIGITS_BETWEEN).u, float).reshape(t.shape)
    series = chebyshev.chebfit(nodes, u.T, DEGREE)

    def efforts(t: NDArray) -> NDArray:
        k = np.clip(np.searchsorted(edges, t) - 1, 0, len(width) - 1)
        return chebyshev.chebval(2 * (t - edges[k]) / width[k] - 1, series[:, k], tensor=False)

    return Known(solution.fronts, efforts)


class Judge:
    """Errors of efforts on a scene, at random instants, equal for all runs.

    Errors are largest behind fronts: a tenth as many fronts are followed by instants at distances from the shortest
    delay down to a 2^14th of it.
    """

    def __init__(self, scene: Scene, instants: int):
        self.scene = scene
        self.solutions = _solutions(scene)
        shortest = min(line.parameters.delay or 0.0 for line in scene.lines.values())
        behind = shortest * 0.5 ** (np.arange(15) + 0.5)  # at no whole share, where another front may be
        anywhere = np.random.default_rng(SEED).uniform(0, scene.t_end, instants)
        self.times = {
            probe: np.sort(np.append(anywhere, solution.fronts[: instants // 10, None] + behind))
            for probe, solution in self.solutions.items()
        }
        self.times = {probe: t[t <= scene.t_end] for probe, t in self.times.items()}
        self.exact = {probe: solution.efforts(self.times[probe]) for probe, solution in self.solutions.items()}
        self.amplitude = max(np.abs(u).max() for u in self.exact.values())
        self.own = max(solution.error for solution in self.solutions.values()) / self.amplitude

    def errors(self, run: TimedRun) -> tuple[float, float]:
        """Largest error over the largest effort: at any instant, and at those of the run next to the instants drawn."""
        anywhere, at_own = [], []
        for probe, t in self.times.items():
            anywhere.append(run.at(probe, t) - self.exact[probe])
            k = np.unique(np.searchsorted(run.t, t))
            k = k[(k > 0) & (k < len(run.t))]
            k = k[run.t[k] <= self.scene.t_end]
            at_own.append(run.u[probe][k] - self.solutions[probe].efforts(run.t[k]))
        return self._relative(anywhere), self._relative(at_own)

    def _relative(self, wrong: list[NDArray]) -> float:
        relative = np.abs(np.concatenate(wrong)) / self.amplitude
        return float(np.where(np.isfinite(relative), relative, np.inf).max())


def _solutions(scene: Scene) -> dict[str, Known]:
    """Exact solutions by probe, or their substitutes."""
    if any(line.losses and not line.losses.linear for line in scene.single_lines.values()):
        solution = FrictionSolution(scene)
        return {
            probe: Known(solution.fronts[probe], partial(solution.at, probe), solution.error) for probe in scene.probes
        }
    if describe(scene).lossy:
        return {probe: interpolated(scene, probe) for probe in scene.probes}
    closed = {probe: Solution(scene, probe) for probe in scene.probes}
    return {
        probe: Known(each.fronts, lambda t, each=each: each.at(t.tolist(), DIGITS).efforts)
        for probe, each in closed.items()
    }


@dataclass(frozen=True)
class Row:
    """One method at one refinement."""

    method: str  # label of the curve
    kind: str  # "ours", "tolerance", "baseline" or "peer"
    setting: str  # refined quantity, such as "8 slabs per shortest delay"
    error: float  # largest error of the efforts at any instant, relative to the largest effort
    error_at_own: float  # largest relative error at the instants that the method itself computes
    seconds: float  # median time from the call to its answer, compiled code at hand
    stepping: float  # median time of stepping alone (peers: as `peers` says)
    # asked, estimated: of a run to a tolerance: tolerance asked, and error estimated by the solver; else infinite
    asked: float = inf
    estimated: float = inf


@dataclass
class ChartTable:
    """Rows of one chart."""

    name: str  # name, title: of the scene
    title: str
    rows: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # absent programs with the reason, and remarks

    def curves(self) -> Iterator[tuple[str, list[Row]]]:
        """Methods and their rows, in the order of measurement."""
        for method, rows in groupby(self.rows, key=lambda row: row.method):
            yield method, list(rows)

    def save(self, path: str | Path) -> None:
        """Write as CSV; the notes are comments before the heading."""
        head = [column.name for column in fields(Row)]
        write_table(path, head, (astuple(row) for row in self.rows), (self.title, *self.notes))
