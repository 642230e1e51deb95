"""Error against run time of the production method, of runs to a tolerance, and of baseline methods, on one scene."""

import time
import warnings
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.study.charts.clock import FULL, QUICK, Effort, TimedRun, timed
from tline.study.charts.judge import Judge
from tline.study.charts.scenes import chart_scene
from tline.study.charts.table import ChartTable, Row

ORDERS = (1, 2, 3, 5, 8)
TOLERANCES = tuple(10.0**-k for k in range(3, 11))
GOOD = 1e-13  # an error that needs no refinement


def work_precision(name: str, quick: bool = False, progress: bool = False) -> ChartTable:
    """Measure all methods on one scene of the charts.

    Parameters
    ----------
    name : str
        One of `tline.study.charts.scenes.NAMES`.
    quick : bool
        Few refinements, each run once: a look, not a measurement.
    progress : bool
        Show a progress bar on stderr.

    Raises
    ------
    InputError
        There is no such scene.

    Examples
    --------
    >>> table = work_precision("rc", quick=True)
    >>> all(row.error <= row.asked for row in table.rows if row.kind == "tolerance")
    True
    """
    from tqdm import tqdm

    from tline.study.baseline import BASELINES

    effort = QUICK if quick else FULL
    with tqdm(total=len(BASELINES) + 1, disable=not progress, unit="method") as bar, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begun = begin(name, quick)
        (scene, judge), table = begun[:2], begun.table()
        bar.update()
        dynamic = any(isinstance(load, RationalImpedance) for load in scene.loads.values())
        for key, method in BASELINES.items():
            idle = key.endswith("_euler") and not dynamic
            why = method.incompatibility(scene) or ("no load to integrate" if idle else "")
            if why:
                table.notes.append(f"absent: {method.label} ({why})")
            else:
                run = partial(baseline_run, method, scene)
                add(table, method.label, "baseline", run, judge, effort)
            bar.update()
    return table


class Begun(NamedTuple):
    """A scene of the charts, who judges runs of it, and what all its charts begin with."""

    scene: Scene
    judge: Judge
    title: str
    name: str
    rows: tuple[Row, ...]
    notes: tuple[str, ...]

    def table(self) -> ChartTable:
        """A chart with the production method on it."""
        return ChartTable(self.name, self.title, [*self.rows], [*self.notes])


@cache
def begin(name: str, quick: bool) -> Begun:
    """Measure the production method on one scene, once for all charts of it."""
    given, effort = chart_scene(name), QUICK if quick else FULL
    judge = Judge(given.scene, effort.instants)
    own = f"Errors are against a grid of characteristics, extrapolated, good to {judge.own:.0e}."
    notes = (own,) if judge.own else ()
    return Begun(given.scene, judge, given.title, name, tuple(production(given.scene, judge, effort)), notes)


def production(scene: Scene, judge: Judge, effort: Effort) -> Iterator[Row]:
    """The production method: each order over its slabs, and runs to tolerances; reading a scene does not count."""
    for s in ORDERS:
        cut = cache(partial(_cut, scene, s))
        yield from refined(f"slabs s = {s}", "ours", lambda n, cut=cut: simulated(cut(n)), "slabs", judge, effort)
    yield from to_tolerances(scene, judge, effort)


def add(table: ChartTable, label: str, kind: str, run: Callable[[int], TimedRun], judge: Judge, effort: Effort) -> None:
    """Put a method on a table, or say why it is absent."""
    try:
        table.rows += refined(label, kind, run, "steps", judge, effort)
    except InputError as error:
        table.notes.append(f"absent: {label} ({error})")


def refined(
    label: str, kind: str, run: Callable[[int], TimedRun], unit: str, judge: Judge, effort: Effort
) -> Iterator[Row]:
    """One method, its step halved until it is too slow or as good as exact."""
    ran = False
    for k in range(effort.refinements):
        n = 2**k
        try:
            done = timed(partial(run, n), effort)
        except InputError:
            if k + 1 == effort.refinements and not ran:
                raise
            if ran:  # so many steps are too many
                return
            continue  # so few are too few
        ran = True
        yield row(label, kind, f"{n} {unit} per shortest delay", done, judge)
        if done.seconds > effort.longest or judge.errors(done)[1] < GOOD:
            return


def row(label: str, kind: str, setting: str, done: TimedRun, judge: Judge, asked: float = np.inf) -> Row:
    """A run as judged."""
    return Row(label, kind, setting, *judge.errors(done), done.seconds, done.stepping, asked, done.estimated)


def _cut(scene: Scene, order: int, n: int) -> Scene:
    """The scene with so many slabs per shortest delay."""
    shortest = min(line.parameters.delay or 0.0 for line in scene.lines.values())
    return fixed(scene, order, shortest / n)


def fixed(scene: Scene, order: int, slab: float) -> Scene:
    """The scene with order and slab fixed."""
    return Scene(**scene.table() | {"solver": {"order": order, "slab": slab}})


def simulated(scene: Scene, tol: float | None = None) -> TimedRun:
    """One run of the production method, or all that a tolerance takes."""
    from tline.solver.description.description import describe
    from tline.solver.simulate import simulate

    describe(scene).known.clear()  # of searches before, which would be repeated as they ended
    begun = time.perf_counter()
    result = simulate(scene, tol=tol, ledger=False)
    seconds = time.perf_counter() - begun
    accuracy, probes = result.accuracy, result.probes
    stepping = sum(attempt.seconds for attempt in accuracy.attempts) if accuracy else result.seconds
    u = {name: probe.at_slab_ends.u for name, probe in probes.items()}
    estimated = accuracy.worst if accuracy else np.inf
    ends = result.t[: result.slabs.whole + 1]
    return TimedRun(ends, u, stepping, seconds, estimated, lambda name, t: probes[name].at(t).u)


def baseline_run(method: Any, scene: Scene, n: int) -> TimedRun:
    """A baseline method's run of n steps per shortest delay."""
    begun = time.perf_counter()
    trace = method.run(scene, n)
    return TimedRun(trace.t, trace.u, trace.seconds, time.perf_counter() - begun)


def to_tolerances(scene: Scene, judge: Judge, effort: Effort) -> Iterator[Row]:
    """What runs to a tolerance cost, all attempts counted, what they think they reached, and what is true.

    A tolerance below what the judge knows is left out.
    """
    for tol in TOLERANCES[:: 3 if effort is QUICK else 1]:
        if tol < judge.own:
            return
        done = timed(partial(simulated, scene, tol), effort)
        yield row("to a tolerance", "tolerance", f"tolerance {tol:.0e}", done, judge, tol)
