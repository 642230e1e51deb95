"""How wrong a run is, against the exact solution."""

from collections.abc import Mapping

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.charts.clock import TimedRun
from tline.study.reference import Solution
from tline.study.reference.friction import FrictionSolution
from tline.study.reference.lossy import LossySolution

DIGITS, DIGITS_BETWEEN = 18, 15
SEED = 0
DEGREE = 16  # between fronts


class Closed:
    """An exact solution as it is."""

    def __init__(self, scene: Scene, probe: str):
        self._solution = Solution(scene, probe)
        self.fronts = self._solution.fronts

    def efforts(self, t: NDArray) -> NDArray:
        """At times within the run."""
        return self._solution.at(t.tolist(), DIGITS).efforts


class Interpolated:
    """An exact solution that is slow, by a polynomial between any two fronts: there it is analytic."""

    def __init__(self, scene: Scene, probe: str):
        solution, t_end = LossySolution(scene, probe), scene.t_end
        self.fronts = solution.fronts
        self._edges = np.unique([0.0, *self.fronts[(self.fronts > 0) & (self.fronts < t_end)], t_end])
        nodes = chebyshev.chebpts1(DEGREE + 1)
        low, width = self._edges[:-1], np.diff(self._edges)
        t = low[:, None] + (nodes + 1) / 2 * width[:, None]
        u = np.array(solution.at(t.ravel().tolist(), DIGITS_BETWEEN).u, float).reshape(t.shape)
        self._series = chebyshev.chebfit(nodes, u.T, DEGREE)

    def efforts(self, t: NDArray) -> NDArray:
        """At times within the run."""
        k = np.clip(np.searchsorted(self._edges, t) - 1, 0, len(self._edges) - 2)
        x = 2 * (t - self._edges[k]) / np.diff(self._edges)[k] - 1
        return chebyshev.chebval(x, self._series[:, k], tensor=False)


class Stepped:
    """What stands for an exact solution where none is known."""

    def __init__(self, solution: FrictionSolution, probe: str):
        self._solution, self._probe = solution, probe
        self.fronts, self.error = solution.fronts[probe], solution.error

    def efforts(self, t: NDArray) -> NDArray:
        """At times within the run."""
        return self._solution.at(self._probe, t)


class Judge:
    """Errors of efforts on a scene.

    Parameters
    ----------
    scene : Scene
    instants : int
        How many are drawn at random, the same for all runs. Errors are largest behind fronts: a tenth as many fronts
        are followed by instants at distances from the shortest delay down to a 2^14th of it.
    """

    def __init__(self, scene: Scene, instants: int):
        self.scene = scene
        self.solutions = _solutions(scene)
        shortest = min(line.parameters.delay or 0.0 for line in scene.lines.values())
        behind = shortest * 0.5 ** (np.arange(15) + 0.5)  # at no whole share, where another front may be
        anywhere = np.random.default_rng(SEED).uniform(0, scene.t_end, instants)
        self.times = {
            probe: _within(np.append(anywhere, solution.fronts[: instants // 10, None] + behind), scene.t_end)
            for probe, solution in self.solutions.items()
        }
        self.exact = {probe: solution.efforts(self.times[probe]) for probe, solution in self.solutions.items()}
        self.amplitude = max(np.abs(u).max() for u in self.exact.values())
        self.own = max(getattr(solution, "error", 0.0) for solution in self.solutions.values()) / self.amplitude

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


def _within(t: NDArray, end: float) -> NDArray:
    return np.sort(t[t <= end])


def _solutions(scene: Scene) -> Mapping[str, Closed | Interpolated | Stepped]:
    """By probe: what is exact, or stands for it."""
    if all(line.losses is None or line.losses.linear for line in scene.single_lines.values()):
        solve = Interpolated if describe(scene).lossy else Closed
        return {probe: solve(scene, probe) for probe in scene.probes}
    solution = FrictionSolution(scene)
    return {probe: Stepped(solution, probe) for probe in scene.probes}
