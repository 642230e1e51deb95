"""The largest difference between two runs at a line's end, where no front lies inside a slab."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.kernel.difference import BLOCK, Compared, find_difference
from tline.solver.radau import Matrix, basis
from tline.solver.result.result import ProbeResult


def is_smooth(coarse: ProbeResult, fine: ProbeResult) -> bool:
    """Whether both are at the end of a line, with samples at the ends of their own slabs, none of them in pieces."""
    return fine.share in (0.0, 1.0) and all(
        len(wave.values) == probe.slabs.number and not len(wave.pieces.slab)
        for probe in (coarse, fine)
        for wave in (probe.record.a1, probe.record.a2)
    )


def smooth_difference(
    coarse: ProbeResult, fine: ProbeResult, count: int, every: int, places: int
) -> tuple[NDArray, NDArray, NDArray]:
    """Largest differences at slab ends of the coarser run and at any place, and largest values of the finer one.

    Each is of effort and of z0 times flow, shape (2,), in so many coarse slabs. So many fine slabs make one of them; in
    each of these places are Chebyshev's, and its end.
    """
    s, other = coarse.waves[0].basis.s, fine.waves[0].basis.s
    weight, most = fine.height.weight, np.zeros((6, BLOCK))
    a, b = (np.ascontiguousarray(wave.values[:count]) for wave in coarse.waves)
    c, d = (np.ascontiguousarray(wave.values[: count * every]) for wave in fine.waves)
    work = np.empty((2, s, BLOCK)), np.empty((2, other, BLOCK)), np.empty((4, BLOCK)), most
    find_difference(pack(Compared(a, b, c, d, *at_same_places(s, other, every, places), 2 * weight, *work)))
    at_ends, inside, largest = most.max(axis=1).reshape(3, 2) / 2
    (a, b), (c, d) = ([wave.before for wave in probe.waves] for probe in (fine, coarse))
    at_ends = np.maximum(at_ends, np.abs([a - c + b - d, a - c - b + d]) / 2)
    return at_ends, np.maximum(inside, at_ends), np.maximum(largest, [abs(a + b - 2 * weight) / 2, 0.0])


@lru_cache
def at_same_places(coarse: int, fine: int, every: int, places: int) -> tuple[Matrix, Matrix]:
    """From values at the points of a slab of either order to values at the places."""
    x = np.append((1 - np.cos(np.pi * np.arange(places) / places)) / 2, 1.0)
    spread = (np.arange(every)[:, None] + x).ravel() / every
    return basis(coarse).evaluation(spread).reshape(every, len(x), coarse), basis(fine).evaluation(x)
