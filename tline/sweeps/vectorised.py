"""Runs of a sweep that are made side by side in compiled code, where the scene allows it."""

from collections.abc import Iterator, Sequence
from math import isclose

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.quantity import LARGEST, SMALLEST
from tline.solver.description.given import Scene
from tline.solver.many import ManyRuns, many_runs
from tline.solver.many.copies import variable
from tline.sweeps.batches import Batch, Task
from tline.sweeps.table import Sweep

CHUNK = 20_000  # runs at once


def side_by_side(task: Task, table: Sweep, samples: Sequence[tuple[int, Scene]]) -> tuple[NDArray, ManyRuns]:
    """Runs that can be made side by side, as a mask over all, and what makes them.

    Parameters
    ----------
    task : Task
    table : Sweep
    samples : sequence of (int, Scene)
        Some runs and their scenes, in which no other numbers may differ than those that vary.

    Raises
    ------
    InputError
        Why they must be made one at a time.
    """
    scene, inputs = task.prepared.scene, table.inputs
    if task.keep.functions or task.tol is None:
        raise InputError("", "functions of results are kept" if task.keep.functions else "order or slab are fixed")
    known = variable(scene)
    for path, values in inputs.items():
        if path not in known or values.dtype.kind != "f":
            raise InputError(path, "is no number of lossless lines, resistances, R, L and C")
    for run, changed in samples:
        expected, found = known | {path: values[run] for path, values in inputs.items()}, variable(changed)
        if expected.keys() != found.keys() or not all(isclose(found[key], expected[key]) for key in expected):
            raise InputError("", "what varies has an effect on other numbers")
    columns = np.stack([*inputs.values()])
    fit = np.all((columns >= SMALLEST) & (columns <= LARGEST), axis=0)
    found = many_runs(task.prepared.description, {path: values[fit] for path, values in inputs.items()}, task.tol)
    if found.estimate > task.tol:
        raise InputError("solver.tol", f"the estimated error is {found.estimate:.1g} side by side")
    return fit, found


def batches(task: Task, found: ManyRuns, rows: NDArray, copies: NDArray) -> Iterator[tuple[NDArray, Batch]]:
    """Make runs side by side; `rows` are their numbers in the sweep, `copies` those among the copies."""
    for k in range(0, len(rows), CHUNK):
        mine = slice(k, k + CHUNK)
        kept = task.keep.of_copies(found, copies[mine])
        yield rows[mine], Batch([*range(len(rows[mine]))], kept, {}, 0.0)
