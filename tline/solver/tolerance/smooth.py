"""The largest difference between two runs at a line's end, where no front lies inside a slab: products of matrices."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import Matrix, basis
from tline.solver.result.result import ProbeResult


def is_smooth(coarse: ProbeResult, fine: ProbeResult) -> bool:
    """Whether both are at the end of a line, with samples at the ends of their own slabs, none of them in pieces."""
    return fine.share in (0.0, 1.0) and all(
        len(wave.values) + 1 == len(probe.slab_ends) and not len(wave.pieces.slab)
        for probe in (coarse, fine)
        for wave in probe.waves
    )


def smooth_difference(
    coarse: ProbeResult, fine: ProbeResult, every: int, places: int
) -> tuple[NDArray, NDArray, NDArray]:
    """Largest differences at slab ends of the coarser run and at any place, and largest values of the finer one.

    Each is of effort and of z0 times flow, shape (2,). So many fine slabs make one coarse slab; in each of them places
    are Chebyshev's, and its end.
    """
    count = min(len(fine.record.a1.values) // every, len(coarse.record.a1.values))
    in_coarse, in_fine = _matrices(coarse.record.a1.basis.s, fine.record.a1.basis.s, every, places)
    ours = [wave.values[: count * every] @ in_fine for wave in fine.waves]
    off = [
        mine - (wave.values[:count] @ in_coarse).reshape(mine.shape)
        for mine, wave in zip(ours, coarse.waves, strict=True)
    ]
    before = [one.before - other.before for one, other in zip(fine.waves, coarse.waves, strict=True)]
    a, b = ours
    start = sum(wave.before for wave in fine.waves) / 2 - fine.height.weight
    weight = 2 * fine.height.weight
    amplitude = np.array([max(abs(start), _largest(a + b - weight if weight else a + b) / 2), _largest(a - b) / 2])
    inside, at_ends = np.empty(2), np.empty(2)
    for k, sign in enumerate((1.0, -1.0)):
        apart = off[0] + sign * off[1]
        first = abs(before[0] + sign * before[1]) / 2
        at_ends[k] = max(_largest(apart[every - 1 :: every, -1]) / 2, first)
        inside[k] = max(_largest(apart if every == 1 else apart[:, :-1]) / 2, at_ends[k])
    return at_ends, inside, amplitude


def _largest(values: NDArray) -> float:
    return max(float(values.max(initial=0.0)), -float(values.min(initial=0.0)))


@lru_cache
def _matrices(coarse: int, fine: int, every: int, places: int) -> tuple[Matrix, Matrix]:
    """From values at the points of a slab of either order to values at the places."""
    x = np.append((1 - np.cos(np.pi * np.arange(places) / places)) / 2, 1.0)
    spread = (np.arange(every)[:, None] + x).ravel() / every
    return basis(coarse).evaluation(spread).T, basis(fine).evaluation(x).T
