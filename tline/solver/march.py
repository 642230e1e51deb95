"""The time loop: projects the sources chunk by chunk and lets the kernel advance all nodes."""

import time
from collections import defaultdict
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from passivity.one_port.positive_real import check_positive_real
from passivity.status import Status
from tline.errors import InputError
from tline.scene.mistakes import place
from tline.scene.rational_load import Rational
from tline.solver.assemble import Assembly
from tline.solver.drive import on_slabs

CHUNK = 2e7  # line-end samples between two looks at the progress bar


def march(assembly: Assembly, n: int, *, progress: bool = False) -> tuple[NDArray, float]:
    """Advance an assembled scene by n slabs.

    Returns
    -------
    record : ndarray, shape (recorded ends, 2, n * s)
        What arrived at each recorded end, and what left it.
    seconds : float
        Time it took, without compiling or loading the kernel.

    Raises
    ------
    InputError
        The waves grew beyond all bounds.
    """
    from tqdm import tqdm

    from tline.solver.kernel import advance

    network, state, s, h = assembly.network, assembly.state, assembly.resolution.s, assembly.resolution.h
    breaks = [[waveform.breaks(n * h) for waveform, _ in parts] for parts in assembly.drives]
    record = np.empty((2 * len(assembly.recorded), 2, n * s))
    advance(network, state, 0, np.zeros((len(breaks), 0)), record, 0)  # compiled now, or loaded
    chunk = max(int(CHUNK / (2 * len(network.delay) * s)), 1)
    changes = defaultdict(list)
    for slab, node, row in assembly.changes:
        changes[slab].append((node, row))
    edges = sorted({*range(0, n, chunk), n, *(slab for slab in changes if slab < n)})
    started = time.perf_counter()
    with tqdm(total=n, disable=not progress, delay=2, unit="slab", unit_scale=True) as bar:
        for low, high in pairwise(edges):
            for node, row in changes[low]:
                network.step_row[node] = row
            if advance(network, state, high - low, _drive(assembly, breaks, low, high - low), record, low) >= 0:
                _refuse(assembly)
            bar.update(high - low)
    return record, time.perf_counter() - started


def _drive(assembly: Assembly, breaks: list[list[NDArray]], first: int, n: int) -> NDArray:
    """The sources' parts of the Thévenin waves on n slabs, shape (drives, n * s)."""
    drive = np.zeros((len(breaks), n, assembly.resolution.s))
    for row, parts, marks in zip(drive, assembly.drives, breaks, strict=True):
        for (waveform, share), mark in zip(parts, marks, strict=True):
            row += share * on_slabs(waveform, mark, assembly.basis, assembly.resolution.h, first, n)
    return drive.reshape(len(breaks), n * assembly.resolution.s)


def _refuse(assembly: Assembly) -> None:
    loads = assembly.scene.loads.items()
    active = [
        place("loads", name)
        for name, load in loads
        if isinstance(load, Rational) and check_positive_real(load.rational()).status is Status.REFUTED
    ]
    raise InputError(
        " and ".join(active) or "lines", "the waves grow beyond all bounds", "passive loads", "active ones"
    )
