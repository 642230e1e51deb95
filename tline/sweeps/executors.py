"""Batches of runs on executors: in this process, in other processes, or on any executor of concurrent.futures."""

import os
import pickle
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from hashlib import sha256
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.prepared import Prepared
from tline.solver.simulate import UnresolvedWarning
from tline.sweeps.keep import Keep
from tline.workers import Workers

Floats = NDArray[np.float64]
LONGEST = 500  # characters of a sentence
SECONDS = 1.0  # target duration of a batch
FIRST = 1  # runs in a batch of unknown cost
FEWEST = 4  # batches for each worker, so that all end at about the same time
GROWTH = 8  # largest ratio of a batch to the largest before
DIED = "the process died that ran it: out of memory, or killed"


class Task(NamedTuple):
    """Work on every run of a sweep."""

    prepared: Prepared
    keep: Keep
    tol: float | None
    active: bool
    shapes: Mapping[str, tuple[int, ...]]  # shapes of the arrays kept, if known

    def run(self, values: Mapping[str, Any]) -> tuple[dict[str, Floats], str]:
        """Return the arrays kept of one run, and the first sentence on unresolved features in it, if any."""
        result = self.prepared.run(values, tol=self.tol, ledger=False, active=self.active)
        return self.keep.of(result), next(iter(result.unresolved), "")


class Batch(NamedTuple):
    """Finished runs."""

    done: list[int]  # those of the batch that ran, counted from 0
    kept: Mapping[str, Floats]  # (done, …) arrays kept of them
    errors: Mapping[int, str]  # why the others failed
    seconds: float
    unresolved: Mapping[int, str] = MappingProxyType({})  # sentences on unresolved features, by run


class NotSent(InputError):
    """Task that cannot be sent to other processes."""


def sent(task: Task, by_value: bool) -> tuple[str, bytes]:
    """Serialise a task for other processes, with its functions as code if `by_value`, and return its digest first."""
    try:
        data = _by_value(task) if by_value else pickle.dumps(task)
    except Exception:  # noqa: BLE001 (whatever pickle stumbles on)
        data = None if by_value else _by_value(task)
    if data is None:
        expected = "functions at the top level of a module, or workers=1"
        raise NotSent("keep", "a function cannot be sent to other processes", expected)
    return sha256(data).hexdigest(), data


def _by_value(task: Task) -> bytes | None:
    """Serialise with cloudpickle, if installed and able to."""
    try:
        import cloudpickle

        return cloudpickle.dumps(task)
    except Exception:  # noqa: BLE001 (whatever pickle stumbles on)
        return None


def run_sent(key: str, data: bytes, rows: list[dict[str, Any]]) -> Batch:
    """Run a batch of a task that was sent; the last task is ready for the next batch."""
    task = _received.get(key)
    if task is None:
        _received.clear()
        warnings.simplefilter("ignore", UnresolvedWarning)  # reported by `Batch.unresolved`
        task = _received[key] = pickle.loads(data)
    return run_batch(task, rows)


_received: dict[str, Task] = {}


def run_batch(task: Task, rows: list[dict[str, Any]]) -> Batch:
    """Run a batch."""
    started, done, kept, errors, unresolved = time.perf_counter(), [], [], {}, {}
    expected = task.shapes
    for k, values in enumerate(rows):
        try:
            found, doubt = task.run(values)
            shapes = {name: array.shape for name, array in found.items()}
            expected = expected or shapes
            if shapes != expected:
                other = next(name for name, shape in shapes.items() if shape != expected[name])
                raise InputError("keep", f"{other} has another shape than before")
        except Exception as error:  # noqa: BLE001 (of one run among many, whose own functions may raise anything)
            errors[k] = sentence(error)
        else:
            done.append(k)
            kept.append(found)
            unresolved |= {k: doubt} if doubt else {}
    arrays = {name: np.stack([found[name] for found in kept]) for name in kept[0]} if kept else {}
    return Batch(done, arrays, errors, time.perf_counter() - started, unresolved)


def sentence(error: BaseException) -> str:
    """Describe an error in one line, which is never empty."""
    text = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
    return " ".join(text.split())[:LONGEST]


class Queue:
    """Waiting runs, dealt out in batches sized by the cost of finished runs."""

    def __init__(self, rows: NDArray, workers: int):
        self._rows, self._given, self._workers, self._largest = rows, 0, workers, FIRST
        self._again: list[NDArray] = []
        self.cost = 0.0  # s, of a run

    def __bool__(self) -> bool:
        return bool(self._again) or self._given < len(self._rows)

    @property
    def left(self) -> int:
        """Number of waiting runs."""
        return len(self._rows) - self._given + sum(map(len, self._again))

    def take(self) -> NDArray:
        """Take the next batch."""
        if self._again:
            return self._again.pop()
        wanted = int(SECONDS / self.cost) if self.cost else FIRST
        fair = -(-(len(self._rows) - self._given) // (FEWEST * self._workers)) if self._workers > 1 else wanted
        size = max(min(wanted, fair, GROWTH * self._largest), 1)
        self._largest = max(size, self._largest)
        batch = self._rows[self._given : self._given + size]
        self._given += len(batch)
        return batch

    def put_back(self, rows: NDArray) -> None:
        """Return a batch to the queue, before all others."""
        self._again.append(rows)

    def learn(self, batch: Batch, size: int) -> None:
        """Measure the cost of a run."""
        self.cost = batch.seconds / size


Submit = Callable[[Executor, NDArray], "Future[Batch]"]


def on_executor(queue: Queue, executor: Executor, workers: int, submit: Submit) -> Iterator[tuple[NDArray, Batch]]:
    """Run all batches on an executor of the caller; batches are yielded as they are finished."""
    waiting: dict[Future[Batch], NDArray] = {}
    try:
        while queue or waiting:
            _fill(waiting, queue, 2 * workers, submit, executor)
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                if isinstance(error := future.exception(), BrokenExecutor):
                    raise InputError("executor", "is broken", "one that works", sentence(error))
                yield from _outcome(future, waiting.pop(future), queue)
    except KeyboardInterrupt:
        yield from _finished(waiting)
        raise
    finally:
        for future in waiting:
            future.cancel()


def on_processes(queue: Queue, workers: int, submit: Submit) -> Iterator[tuple[NDArray, Batch]]:
    """Run all batches on new processes.

    When one dies, its batches are run again; a batch during which processes die a second time is run alone, and at last
    run by run: only runs that fail alone are lost.
    """
    waiting: dict[Future[Batch], NDArray] = {}
    deaths, suspects, worked = 0, [], False
    pool = Workers(workers)
    try:
        while queue or waiting or suspects:
            if suspects and not waiting:
                rows = suspects.pop()
                waiting[submit(pool, rows)] = rows
            elif not suspects:
                _fill(waiting, queue, workers + 1, submit, pool)
            finished = wait(waiting, return_when=FIRST_COMPLETED).done
            broken = [future for future in finished if isinstance(future.exception(), BrokenExecutor)]
            for future in finished.difference(broken):
                worked = True
                yield from _outcome(future, waiting.pop(future), queue)
            if broken:
                deaths += 1
                if deaths > 1 and not worked:
                    raise NoWorkers
                lost, alone = list(waiting.values()), len(waiting) == 1 and deaths > 1
                waiting.clear()
                pool.end()
                pool = Workers(workers)
                if alone and len(lost[0]) == 1:
                    yield lost[0], Batch([], {}, {0: DIED}, 0.0)
                elif deaths == 1:
                    for rows in lost:
                        queue.put_back(rows)
                else:
                    suspects += [half for rows in lost for half in np.array_split(rows, 2) if len(half)]
    except KeyboardInterrupt:
        yield from _finished(waiting)
        raise
    finally:
        pool.end()


class NoWorkers(InputError):
    """Processes die before they have done anything."""

    def __init__(self, *_: object):
        expected = 'calls of a script under if __name__ == "__main__":, or workers=1'
        super().__init__("workers", "the processes of the sweep die as they start", expected)


def workers_of(executor: Executor, asked: int | None) -> int:
    """Number of batches that an executor works on at once, if it reveals that."""
    if asked is not None:
        return asked
    client: Any = getattr(executor, "_client", None)  # of Dask
    if client is not None:
        return max(sum(client.nthreads().values()), 1)
    return getattr(executor, "_max_workers", None) or os.cpu_count() or 1


def _fill(waiting: dict, queue: Queue, most: int, submit: Submit, executor: Executor) -> None:
    while queue and len(waiting) < most:
        rows = queue.take()
        try:
            future = submit(executor, rows)
        except BrokenExecutor as error:
            future = Future()
            future.set_exception(error)
        waiting[future] = rows


def _outcome(future: "Future[Batch]", rows: NDArray, queue: Queue) -> Iterator[tuple[NDArray, Batch]]:
    """Return the outcome of a batch; one that failed as a whole is divided, down to single runs."""
    error = future.exception()
    if error is None:
        queue.learn(future.result(), len(rows))
        yield rows, future.result()
    elif len(rows) == 1:
        yield rows, Batch([], {}, {0: sentence(error)}, 0.0)
    else:
        for half in np.array_split(rows, 2):
            queue.put_back(half)


def _finished(waiting: "dict[Future[Batch], NDArray]") -> Iterator[tuple[NDArray, Batch]]:
    """Return the batches that were finished at an interrupt."""
    for future, rows in list(waiting.items()):
        if future.done() and not future.cancelled() and future.exception() is None:
            yield rows, future.result()
