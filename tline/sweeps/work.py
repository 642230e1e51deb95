"""Execution of the runs of a sweep: side by side in compiled code, here one at a time, or on an executor."""

import os
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from math import isclose
from multiprocessing import parent_process

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.changed import changed
from tline.scene.quantity import LARGEST, SMALLEST
from tline.solver.description.given import Scene
from tline.solver.many.copies import variable
from tline.solver.many.nodes import within_element
from tline.solver.many.runs import ManyRuns, many_runs
from tline.solver.tolerance.ladder import Start
from tline.sweeps.design import Design
from tline.sweeps.executors import (
    Batch,
    NotSent,
    NoWorkers,
    Queue,
    Task,
    on_executor,
    on_processes,
    run_batch,
    run_sent,
    sent,
    workers_of,
)
from tline.sweeps.keep import ESTIMATE
from tline.sweeps.table import Sweep

LONG = 10.0  # s of work left above which processes are started
Batches = Iterator[tuple[NDArray, Batch]]
CHUNK = 20_000  # runs at once


class SweepWork:
    """Runs of a sweep that are not in its table yet."""

    def __init__(self, design: Design, table: Sweep, task: Task, executor: Executor | None, workers: int | None):
        self._design, self._table, self._task = design, table, task
        self._executor, self._workers = executor, workers
        self._samples = self._sampled()

    def batches(self) -> Batches:
        """Make all missing runs."""
        yield from self._side_by_side()
        if self._table.done.all():
            return
        yield from self._first()
        if self._executor is not None:
            key, data = sent(self._task, by_value=True)
            workers = workers_of(self._executor, self._workers)
            yield from on_executor(Queue(self._left, workers), self._executor, workers, self._submit(key, data))
        elif self._workers is not None and self._workers > 1:
            yield from self._processes(self._workers)
        else:
            yield from self._here()

    @property
    def _left(self) -> NDArray:
        return np.flatnonzero(~self._table.done)

    def _sampled(self) -> list[tuple[int, Scene]]:
        """Sample runs and their scenes."""
        found, mistakes = [], []
        for rows in _middle(np.arange(self._design.runs)):
            try:
                found.append((int(rows[0]), changed(self._task.prepared.scene, self._design.rows(rows)[0])))
            except InputError as error:
                mistakes.append(error)
        if not found:
            raise mistakes[0]
        return found

    def _side_by_side(self) -> Batches:
        try:
            fit, many = side_by_side(self._task, self._table, self._samples)
        except InputError as error:
            self._table.method = f"one at a time: {error}"
            return
        self._table.method = "vectorised"
        rows = np.flatnonzero(fit & ~self._table.done)
        yield from batches(self._task, many, rows, np.cumsum(fit)[rows] - 1)

    def _first(self) -> Batches:
        """Make one run to fix the start of the searches of all others."""
        told, prepared = self._table.origin, self._task.prepared
        if "starts" not in told:
            for rows in _middle(self._left):
                batch = run_batch(self._task, self._design.rows(rows))
                yield rows, batch
                if batch.done:
                    break
            told["starts"] = [[tol, *start] for tol, start in prepared.starts.items()]
        shapes = {name: array.shape[1:] for name, array in self._table.kept.items()}
        self._task = self._task._replace(shapes=shapes)
        prepared.fix({tol: Start(*start) for tol, *start in told["starts"]})

    def _here(self) -> Batches:
        """Make runs in this process, until enough are left to justify starting others."""
        queue, cores = Queue(self._left, 1), os.cpu_count() or 1
        alone = self._workers is not None or cores == 1 or parent_process() is not None
        while queue:
            rows = queue.take()
            batch = run_batch(self._task, self._design.rows(rows))
            queue.learn(batch, len(rows))
            yield rows, batch
            if not alone and queue.cost * queue.left > LONG:
                alone = True
                try:
                    yield from self._processes(cores)
                except NoWorkers as error:
                    warnings.warn(f"{error}; the sweep goes on in this process alone", stacklevel=2)
                except NotSent:
                    continue
                queue = Queue(self._left, 1)

    def _processes(self, workers: int) -> Batches:
        key, data = sent(self._task, by_value=False)
        yield from on_processes(Queue(self._left, workers), workers, self._submit(key, data))

    def _submit(self, key: str, data: bytes):
        def submit(executor: Executor, rows: NDArray) -> "Future[Batch]":
            return executor.submit(run_sent, key, data, self._design.rows(rows))

        return submit


def _middle(rows: NDArray) -> list[NDArray]:
    """Middle, first and last row, each alone."""
    return [rows[k : k + 1] for k in dict.fromkeys([len(rows) // 2, 0, len(rows) - 1])]


def side_by_side(task: Task, table: Sweep, samples: Sequence[tuple[int, Scene]]) -> tuple[NDArray, ManyRuns]:
    """Find the runs that can be made side by side, as a mask over all, with their solver; raise the reason if none can.

    In the sample runs no numbers may differ other than those that vary.
    """
    scene, inputs = task.prepared.scene, table.inputs
    if task.keep.functions or task.tol is None:
        raise InputError("", "functions of results are kept" if task.keep.functions else "order or slab are fixed")
    known = variable(scene)
    for path, values in inputs.items():
        if not (path in known or within_element(scene, path)) or values.dtype.kind != "f":
            raise InputError(path, "is no number of lossless lines, resistances, R, L and C, or within an element")
    for run, scene_of_run in samples:
        given = {path: values[run] for path, values in inputs.items() if path in known}
        expected, found = known | given, variable(scene_of_run)
        if expected.keys() != found.keys() or not all(isclose(found[key], expected[key]) for key in expected):
            raise InputError("", "what varies has an effect on other numbers")
    columns = np.array([values for path, values in inputs.items() if path in known])
    fit = np.all((columns >= SMALLEST) & (columns <= LARGEST), axis=0) & np.ones(len(table.done), bool)
    found = many_runs(task.prepared.description, {path: values[fit] for path, values in inputs.items()}, task.tol)
    if found.estimate > task.tol:
        raise InputError("solver.tol", f"the estimated error is {found.estimate:.1g} side by side")
    return fit, found


def batches(task: Task, found: ManyRuns, rows: NDArray, copies: NDArray) -> Iterator[tuple[NDArray, Batch]]:
    """Make runs side by side; `rows` are their numbers in the sweep, `copies` those among the copies."""
    for k in range(0, len(rows), CHUNK):
        mine = slice(k, k + CHUNK)
        kept = task.keep.of_copies(found, copies[mine])
        done = np.flatnonzero(kept[ESTIMATE] <= (task.tol or 0.0))  # the others are run one at a time
        yield rows[mine], Batch(done.tolist(), {name: array[done] for name, array in kept.items()}, {}, 0.0)
