"""Runs of a sweep in batches, in whatever process: a failed run is a sentence, not the end."""

import pickle
import time
import warnings
from collections.abc import Mapping
from hashlib import sha256
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.prepared import Prepared
from tline.solver.simulate import UnresolvedWarning
from tline.sweeps.keep import Keep

Floats = NDArray[np.float64]
LONGEST = 500  # characters of a sentence


class Task(NamedTuple):
    """What is done with every run of a sweep."""

    prepared: Prepared
    keep: Keep
    tol: float | None
    active: bool
    shapes: Mapping[str, tuple[int, ...]]  # of what is kept, as far as that is known

    def run(self, values: Mapping[str, Any]) -> tuple[dict[str, Floats], str]:
        """What is kept of one run, and the first sentence on what was not resolved in it, if any."""
        result = self.prepared.run(values, tol=self.tol, ledger=False, active=self.active)
        return self.keep.of(result), next(iter(result.unresolved), "")


class Batch(NamedTuple):
    """Finished runs."""

    done: list[int]  # those of the batch that ran, counted from 0
    kept: Mapping[str, Floats]  # (done, …) what is kept of them
    errors: Mapping[int, str]  # why the others failed
    seconds: float
    unresolved: Mapping[int, str] = MappingProxyType({})  # what was not resolved, of those where that is so


class NotSent(InputError):
    """Something cannot be sent to other processes."""


def sent(task: Task, by_value: bool) -> tuple[str, bytes]:
    """A task as bytes for other processes, and what tells it from others.

    Parameters
    ----------
    task : Task
    by_value : bool
        Whether functions of the main module shall be sent as code, for those who cannot import it.

    Raises
    ------
    NotSent
        A function that it keeps cannot be sent.
    """
    try:
        data = _by_value(task) if by_value else pickle.dumps(task)
    except Exception:  # noqa: BLE001 (whatever pickle stumbles on)
        data = None if by_value else _by_value(task)
    if data is None:
        expected = "functions at the top level of a module, or workers=1"
        raise NotSent("keep", "a function cannot be sent to other processes", expected)
    return sha256(data).hexdigest(), data


def _by_value(task: Task) -> bytes | None:
    """With cloudpickle, where that is installed and able to."""
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
        warnings.simplefilter("ignore", UnresolvedWarning)  # `Batch.unresolved` tells
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
    """One line about an error, which is never empty."""
    text = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
    return " ".join(text.split())[:LONGEST]
