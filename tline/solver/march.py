"""The time loop: projects the sources chunk by chunk and lets the kernel advance all nodes."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.assemble import Assembly
from tline.solver.drive import on_slabs

CHUNK = 2e7  # line-end samples between two looks at the progress bar


def march(assembly: Assembly, n: int, *, progress: bool = False) -> NDArray:
    """Advance an assembled scene by n slabs.

    Returns
    -------
    ndarray, shape (recorded ends, 2, n * s)
        What arrived at each recorded end, and what left it.

    Raises
    ------
    InputError
        The waves grew beyond all bounds.
    """
    from tqdm import tqdm

    from tline.solver.kernel import advance

    network, state, s = assembly.network, assembly.state, assembly.resolution.s
    breaks = [[waveform.breaks(float(assembly.scene.t_end)) for waveform, _ in parts] for parts in assembly.drives]
    record = np.empty((2 * len(assembly.recorded), 2, n * s))
    chunk = max(int(CHUNK / (2 * len(network.delay) * s)), 1)
    edges = sorted({*range(0, n, chunk), n, *(slab for slab, _, _ in assembly.changes if slab < n)})
    changes = iter([*assembly.changes, (n, 0, 0)])
    slab, node, row = next(changes)
    with tqdm(total=n, disable=not progress, delay=2, unit="slab", unit_scale=True) as bar:
        for low, high in pairwise(edges):
            while slab <= low:
                network.step_row[node] = row
                slab, node, row = next(changes)
            drive = np.zeros((len(assembly.drives), (high - low) * s))
            for line, parts, marks in zip(drive, assembly.drives, breaks, strict=True):
                for (waveform, share), mark in zip(parts, marks, strict=True):
                    line += (
                        share * on_slabs(waveform, mark, assembly.basis, assembly.resolution.h, low, high - low).ravel()
                    )
            failed = advance(network, state, high - low, drive, record, low)
            if failed >= 0:
                _refuse(assembly, failed, high * assembly.resolution.h)
            bar.update(high - low)
    return record


def _refuse(assembly: Assembly, node: int, t: float) -> None:
    where = f"node '{assembly.nodes[node]}'" if node < len(assembly.nodes) else "lines"
    raise InputError(where, f"the waves have grown beyond all bounds before t = {t:.6g} s: an active load feeds them")
