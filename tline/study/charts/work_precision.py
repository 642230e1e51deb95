"""Error against run time of the production method, of runs to a tolerance, and of baseline methods, on one scene."""

import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.scene.rational_load import Rational
from tline.scene.scene import Scene
from tline.study.charts.clock import FULL, QUICK, Effort, TimedRun, compilation, timed
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
    scene, judge, table = begun(name, effort, quick)
    with tqdm(total=len(BASELINES) + 1, disable=not progress, unit="method") as bar, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        table.rows += production(scene, judge, effort)
        bar.update()
        dynamic = any(isinstance(load, Rational) for load in scene.loads.values())
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


def begun(name: str, effort: Effort, quick: bool) -> tuple[Scene, Judge, ChartTable]:
    """A scene of the charts, who judges runs of it, and the table that they will fill."""
    given = chart_scene(name)
    judge, notes = Judge(given.scene, effort.instants), [] if quick else [compilation()]
    if judge.own:
        notes.append(f"Errors are against a grid of characteristics, extrapolated, good to {judge.own:.0e}.")
    return given.scene, judge, ChartTable(name, given.title, notes=notes)


def production(scene: Scene, judge: Judge, effort: Effort) -> Iterator[Row]:
    """The production method: each order over its slabs, and runs to tolerances."""
    for s in ORDERS:
        yield from refined(f"slabs s = {s}", "ours", partial(_slabs, scene, s), "slabs", judge, effort)
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
        error, rms = judge.errors(done.t, done.u)
        yield Row(label, kind, f"{n} {unit} per shortest delay", error, rms, done.seconds, done.first)
        if done.seconds > effort.longest or error < GOOD:
            return


def _slabs(scene: Scene, order: int, n: int) -> TimedRun:
    shortest = min(line.parameters.delay or 0.0 for line in scene.lines.values())
    return simulated(fixed(scene, order, shortest / n))


def fixed(scene: Scene, order: int, slab: float) -> Scene:
    """The scene with order and slab fixed."""
    return Scene(**scene.table() | {"solver": {"order": order, "slab": slab}})


def simulated(scene: Scene, tol: float | None = None) -> TimedRun:
    """One run of the production method, or all that a tolerance takes."""
    from tline.solver.simulate import simulate

    begun = time.perf_counter()
    result = simulate(scene, tol=tol, ledger=False)
    first = time.perf_counter() - begun
    accuracy = result.accuracy
    seconds = sum(attempt.seconds for attempt in accuracy.attempts) if accuracy else result.seconds
    u = {name: probe.u for name, probe in result.probes.items()}
    return TimedRun(result.t, u, seconds, first, accuracy.at_slab_ends if accuracy else np.inf)


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
        error, rms = judge.errors(done.t, done.u)
        setting = f"tolerance {tol:.0e}"
        yield Row("to a tolerance", "tolerance", setting, error, rms, done.seconds, done.first, tol, done.estimated)
