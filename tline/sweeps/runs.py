"""Sweeps: a scene is run with many values, here or elsewhere, and selected results of each run are kept."""

import time
import warnings
from collections.abc import Mapping
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from tline.atomic import check_writable
from tline.errors import InputError
from tline.scene.file import as_scene
from tline.solver.description.given import Scene
from tline.solver.prepared import prepare
from tline.solver.simulate import UnresolvedWarning, asked
from tline.sweeps.design import design, whole
from tline.sweeps.executors import Task
from tline.sweeps.file import save, take_over
from tline.sweeps.keep import kept_of
from tline.sweeps.table import Sweep
from tline.sweeps.work import SweepWork
from tline.words.progress import Progress
from tline.workers import interrupts_deferred

SAVED, SHARE = 10.0, 20  # s between writing the file, and times that writing took
MOST_WORKERS = 4096


class InterruptedWarning(UserWarning):
    """A sweep was interrupted: it holds the runs done until then."""


def sweep(
    scene: Scene | str | Path | Mapping[str, Any],
    vary: Mapping[str, Any],
    *,
    sample: str | None = None,
    seed: int | str = 0,
    keep: Any = "extremes",
    tol: float | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    resume: str | Path | None = None,
    active: bool = False,
    progress: bool = False,
) -> Sweep:
    """Run a scene with many values.

    Parameters
    ----------
    scene : Scene, path or dict
        Any scene, the path of its TOML file, or its tables.
    vary : mapping of str to values or distribution
        By dotted path, as in a scene file: ``"lines.cable.z0"``, ``"sources.s.value.duration"``, ``"t_end"``. A list or
        array of values in SI, of texts with units, or of anything that a scene file may hold there; a range
        ``"40 ohm:60 ohm:5"`` of five values, or ``"1 pF:1 nF:7:log"``; a distribution ``"uniform(45 ohm, 55 ohm)"``,
        ``"loguniform(1 pF, 1 nF)"`` or ``"normal(50 ohm, 2 ohm)"``, or a frozen one of `scipy.stats`.
    sample : str, optional
        ``"grid"``, every value of a path with every one of the others, if there are values only; ``"list"``, values of
        equally long lists side by side; ``"random:COUNT"``, ``"latin:COUNT"`` (hypercube) or ``"sobol:COUNT"``
        (scrambled; a power of two), drawn from distributions, where a list counts as equally probable values.
    seed : int, from 0
        Another one draws other values.
    keep : results to keep of each run, optional
        ``"extremes"``: the lowest and the highest effort at every probe, and when. Instants in s, as a list or as text
        ``"0 s:2 s:101"``: efforts and flows there. A function of the `Result` to a number or an array, named by itself
        or by the key of a dict. Or a list of these.
    tol : float, 1e-13 to 0.1, optional
        Of each run, as of `tline.solver.simulate.simulate`.
    executor : concurrent.futures.Executor, optional
        Where batches of runs are made: threads, processes, Dask's ``Client.get_executor()``,
        ``mpi4py.futures.MPIPoolExecutor()``.
    workers : int, from 1, optional
        Processes to start in place of an executor, 1 for none; if not given, as many as there are processors
        once ten seconds of work are left. With an executor, number of batches that it works on at once, if unknown.
    resume : str or Path, optional
        An NPZ file: runs that it holds are not made again. It is written every ten seconds or more, at the end, and
        when the sweep is interrupted.
    active : bool
        Make runs with loads that are not positive real.
    progress : bool
        Show a bar on stderr if the sweep takes more than two seconds.

    Returns
    -------
    Sweep
        All inputs, and the results kept. A run that fails has a sentence in place of numbers. The numbers do not depend
        on where and in which batches runs are made: every search for order and slab begins where that of one run in the
        middle ended. After Ctrl-C, the runs done until then, with a warning; KeyboardInterrupt otherwise.

    Raises
    ------
    InputError
        An argument is not as above, values fit nowhere in the scene, or processes cannot start.

    Warns
    -----
    InterruptedWarning
        Somebody pressed Ctrl-C.
    UnresolvedWarning
        Something was not resolved in some runs: once, with the first; ``Sweep.unresolved`` has them all.

    Notes
    -----
    Lossless linear scenes from rest, without functions to keep, run side by side in compiled code (docs/sweeps.md), 10⁴
    to 10⁵ of them a second, and use no executor.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 20}},
    ... )
    >>> found = sweep(scene, {"lines.line.z0": "40 ohm:60 ohm:3"})
    >>> found["highest"][:, 0].round(9).tolist()  # 2 z0/(z0 + 20)
    [1.333333333, 1.428571429, 1.5]
    >>> sweep(scene, {"sources.s.resistance": "normal(20 ohm, 1 ohm)"}, sample="latin:8", keep=[30e-9])["u"].shape
    (8, 1, 1)
    """
    started, scene = time.perf_counter(), as_scene(scene)
    chosen = design(scene, vary, sample, seed)
    kept, tol = kept_of(scene, keep), asked(scene, tol)
    workers = None if workers is None else whole("workers", workers, 1, MOST_WORKERS)
    inputs = {path: chosen.column(path) for path in chosen.levels}
    table = Sweep(scene, inputs, chosen.shape, chosen.sample, kept.t, tol, origin={"keep": kept.names})
    file = _File(table, resume)
    work = SweepWork(chosen, table, Task(prepare(scene), kept, tol, active, {}), executor, workers)
    interrupted = False
    with warnings.catch_warnings(), Progress(chosen.runs, "run", progress) as bar:
        warnings.simplefilter("ignore", UnresolvedWarning)  # once, at the end
        bar.update(int(table.done.sum()))
        try:
            for rows, batch in work.batches():
                with interrupts_deferred():  # lest half of it is taken over
                    table.put(rows[batch.done], batch.kept, {int(rows[k]): text for k, text in batch.errors.items()})
                    table.unresolved |= {int(rows[k]): text for k, text in batch.unresolved.items()}
                bar.update(len(rows))
                file.write_now_and_then()
        except KeyboardInterrupt:
            interrupted = True
        finally:
            table.seconds = time.perf_counter() - started
            with interrupts_deferred():
                file.write()
    if interrupted and not table.done.any():
        raise KeyboardInterrupt
    if table.unresolved:
        warnings.warn(table.told_unresolved, UnresolvedWarning, stacklevel=2)
    if interrupted:
        warnings.warn(f"interrupted: {table.told}", InterruptedWarning, stacklevel=2)
    return table


class _File:
    """File from which a sweep resumes, if there is one."""

    def __init__(self, table: Sweep, path: str | Path | None):
        self._table, self._path, self._next = table, path, time.monotonic() + SAVED
        if path is not None and Path(path).suffix.lower() != ".npz":
            raise InputError("resume", "unknown kind of file", ".npz", f"'{path}'")
        if path is not None and Path(path).exists():
            take_over(table, path)
        elif path is not None:
            check_writable(path)

    def write_now_and_then(self) -> None:
        """Write the file if the last time is long ago."""
        if time.monotonic() >= self._next:
            self.write()

    def write(self) -> None:
        """Write the file."""
        if self._path is not None and self._table.done.any():
            started = time.monotonic()
            save(self._table, self._path)
            ended = time.monotonic()
            self._next = ended + max(SAVED, SHARE * (ended - started))
