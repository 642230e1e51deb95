"""Error against run time on one scene: the production method, runs to a tolerance, baseline methods, other programs.

Programs are measured in the same run as all else; absent ones are named.

| peer | how | its clock of stepping | of all |
|---|---|---|---|
| ngspice | T and O elements, its largest step refined | its own figure, in milliseconds | the process |
| scikit-rf | two-ports in a row, inverse FFT over a damped window | all but the grid of frequencies | the same |
| rthym-moc | its factor of friction that of the scene, where it can be | its run(), setting up included | the same |
| TSNet | in an environment of its own, one pipe as two | its MOCSimulator() | the process |

Where friction depends on the flow, a staggered grid of characteristics is added, and its extrapolation.
"""

import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.charts import inverse_fft
from tline.study.charts.measure import FULL, QUICK, ChartTable, Effort, Judge, Row, TimedRun, timed
from tline.study.charts.scenes import chart_scene
from tline.study.programs import ngspice, rthym, tsnet

ORDERS = (1, 2, 3, 5, 8)
TOLERANCES = tuple(10.0**-k for k in range(3, 11))
GOOD = 1e-13  # an error that needs no refinement
PATIENT = FULL._replace(longest=1.0)  # s; peers need it
GRIDS = "moc_grid", "moc_extrapolated"
PEERS: dict[str, Any] = {
    "ngspice": ngspice, "scikit-rf, inverse FFT": inverse_fft, "rthym-moc": rthym, "TSNet": tsnet,
}  # fmt: skip


class Rival(NamedTuple):
    """Method or program compared with the production method on a chart."""

    label: str
    kind: str
    why: str | None  # reason for its absence
    run: Callable[[int], TimedRun]  # with a number of steps per shortest delay


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
    from tline.study.baseline import BASELINES

    scene = chart_scene(name).scene
    dynamic = any(isinstance(load, RationalImpedance) for load in scene.loads.values())
    idle = {key for key in BASELINES if key.endswith("_euler") and not dynamic}
    methods = [_baseline(key, scene, "no load to integrate" if key in idle else "") for key in BASELINES]
    return _chart(name, methods, quick, QUICK if quick else FULL, progress)


def peers(name: str, quick: bool = False, progress: bool = False) -> ChartTable:
    """Measure other programs, and the production method for comparison, on one scene of the charts.

    Parameters
    ----------
    name, quick, progress
        As of `work_precision`.

    Raises
    ------
    InputError
        There is no such scene.

    Examples
    --------
    >>> table = peers("rc", quick=True)
    >>> len(list(table.curves())) > 3
    True
    """
    scene = chart_scene(name).scene
    rivals = [grid for grid in (_baseline(key, scene) for key in GRIDS) if not grid.why]
    rivals += [Rival(key, "peer", one.incompatibility(scene), partial(one.run, scene)) for key, one in PEERS.items()]
    table = _chart(name, rivals, quick, QUICK if quick else PATIENT, progress)
    if scene.medium == "hydraulic" and not describe(scene).lossy:
        table.notes.append("rthym-moc has friction here, which cannot be switched off.")
    return table


def _baseline(key: str, scene: Scene, idle: str = "") -> Rival:
    from tline.study.baseline import BASELINES

    method = BASELINES[key]

    def run(n: int) -> TimedRun:
        begun = time.process_time()
        trace = method.run(scene, n)
        return TimedRun(trace.t, trace.u, trace.seconds, time.process_time() - begun)

    return Rival(method.label, "baseline", method.incompatibility(scene) or idle or None, run)


def _chart(name: str, rivals: Iterable[Rival], quick: bool, effort: Effort, progress: bool) -> ChartTable:
    """Measure the production method on a scene, and rivals or the reasons for their absence."""
    from tqdm import tqdm

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        judge, rows = begin(name, quick)
        own = f"Errors are against a grid of characteristics, extrapolated, good to {judge.own:.0e}."
        table = ChartTable(name, chart_scene(name).title, [*rows], [own] if judge.own else [])
        for label, kind, why, run in tqdm(rivals, disable=not progress, unit="curve"):
            if why:
                table.notes.append(f"absent: {label} ({why})")
            else:
                add(table, label, kind, run, judge, effort)
    return table


@cache
def begin(name: str, quick: bool) -> tuple[Judge, tuple[Row, ...]]:
    """Return the judge of runs of a scene, and the production method on it, measured once for all charts."""
    effort = QUICK if quick else FULL
    scene = chart_scene(name).scene
    judge = Judge(scene, effort.instants)
    return judge, tuple(production(scene, judge, effort))


def production(scene: Scene, judge: Judge, effort: Effort) -> Iterator[Row]:
    """Measure the production method: each order over its slabs, and runs to tolerances, without reading of scenes."""
    for s in ORDERS:
        cut = cache(partial(_cut, scene, s))
        yield from refined(f"slabs s = {s}", "ours", lambda n, cut=cut: simulated(cut(n)), "slabs", judge, effort)
    yield from to_tolerances(scene, judge, effort)


def add(table: ChartTable, label: str, kind: str, run: Callable[[int], TimedRun], judge: Judge, effort: Effort) -> None:
    """Add a method to a table, or the reason for its absence."""
    try:
        table.rows += refined(label, kind, run, "steps", judge, effort)
    except InputError as error:
        table.notes.append(f"absent: {label} ({error})")


def refined(
    label: str, kind: str, run: Callable[[int], TimedRun], unit: str, judge: Judge, effort: Effort
) -> Iterator[Row]:
    """Measure one method, its step halved until it is too slow or nearly exact."""
    ran = False
    for k in range(effort.refinements):
        n = 2**k
        try:
            done = timed(partial(run, n), effort)
        except InputError:
            if k + 1 == effort.refinements and not ran:
                raise
            if ran:  # this many steps are too many
                return
            continue  # this few are too few
        ran = True
        yield row(label, kind, f"{n} {unit} per shortest delay", done, judge)
        if done.seconds > effort.longest or judge.errors(done)[1] < max(GOOD, judge.own):
            return


def row(label: str, kind: str, setting: str, done: TimedRun, judge: Judge, asked: float = np.inf) -> Row:
    """Build the row of a run from the judge's errors."""
    return Row(label, kind, setting, *judge.errors(done), done.seconds, done.stepping, asked, done.estimated)


def _cut(scene: Scene, order: int, n: int) -> Scene:
    """Return the scene with a number of slabs per shortest delay."""
    shortest = min(line.parameters.delay or 0.0 for line in scene.lines.values())
    return fixed(scene, order, shortest / n)


def fixed(scene: Scene, order: int, slab: float) -> Scene:
    """Return the scene with order and slab fixed."""
    return Scene(**scene.table() | {"solver": {"order": order, "slab": slab}})


def simulated(scene: Scene, tol: float | None = None) -> TimedRun:
    """Time one run of the production method, or all attempts for a tolerance."""
    from tline.solver.simulate import simulate

    describe(scene).known.clear()  # of earlier searches, which would be repeated as they ended
    begun = time.process_time()
    result = simulate(scene, tol=tol, ledger=False)
    seconds = time.process_time() - begun
    accuracy, probes = result.accuracy, result.probes
    stepping = sum(attempt.seconds for attempt in accuracy.attempts) if accuracy else result.seconds
    u = {name: probe.at_slab_ends.u for name, probe in probes.items()}
    estimated = accuracy.worst if accuracy else np.inf
    ends = result.t[: result.slabs.whole + 1]
    return TimedRun(ends, u, stepping, seconds, estimated, lambda name, t: probes[name].at(t).u)


def to_tolerances(scene: Scene, judge: Judge, effort: Effort) -> Iterator[Row]:
    """Cost of runs to a tolerance, all attempts counted, their estimated and their true error.

    A tolerance below the judge's own error is left out, and all below one that takes too long.
    """
    for tol in TOLERANCES[:: 3 if effort is QUICK else 1]:
        if tol < judge.own:
            return
        done = timed(partial(simulated, scene, tol), effort)
        yield row("to a tolerance", "tolerance", f"tolerance {tol:.0e}", done, judge, tol)
        if done.seconds > PATIENT.longest:
            return
