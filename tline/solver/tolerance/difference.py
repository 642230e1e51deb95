"""The largest difference between two runs at a probe: at slab ends, and at any instant between them.

Inside slabs each run has its own polynomials. They are compared in every slab of the finer run: in one piece, at
Chebyshev's places; where a front of either run lies inside, at such places of every piece, on both sides of the front.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import chebyshev
from tline.solver.result.result import ProbeResult, Wave

BESIDE = 1e-7  # slabs, from a front or an edge to the places beside it
SETTLES = 16  # times that lumped lines settle: a piece up to that wide is blurred, for each pass adds one
CHUNK = 100_000  # slabs at a time


class Difference(NamedTuple):
    """Of effort (pressures are gauge pressures) and flow times impedance z0·y, each of shape (2,)."""

    at_ends: NDArray  # largest difference at slab ends
    inside: NDArray  # the same at all places, but where lumped lines settle after a front
    blurred: NDArray  # the same there, too
    amplitude: NDArray  # largest value of the finer run


def difference(coarse: ProbeResult, fine: ProbeResult, settle: float = 0.0) -> Difference:
    """Compare what one probe saw in two runs; a slab of the coarser run is a whole number of slabs of the finer one.

    `settle` is the time that lumped lines take after a front, s.
    """
    apart, every = (round(x / y) for x, y in (
        (coarse.slab_ends[1], fine.slab_ends[1]), (coarse.record.a1.h, fine.record.a1.h)
    ))  # fmt: skip
    ends, theirs = (np.stack([probe.gauge_pressure, fine.record.z0 * probe.y]) for probe in (fine, coarse))
    ends_there = ends[:, ::apart]
    common = min(ends_there.shape[1], theirs.shape[1])
    at_ends = np.abs(ends_there[:, :common] - theirs[:, :common]).max(axis=1)
    n = min(len(fine.record.a1.values), every * len(coarse.record.a1.values))
    inside, blurred, amplitude = at_ends, np.zeros(2), np.abs(ends).max(axis=1)
    narrow = SETTLES * settle
    if every * (n // every):
        for one, other in (*_in_one_piece(coarse, fine, every, n), _in_pieces(coarse, fine, n, narrow, np.inf)):
            inside = np.maximum(inside, np.abs(one - other).max(axis=1, initial=0.0))
            amplitude = np.maximum(amplitude, np.abs(other).max(axis=1, initial=0.0))
        if settle:
            one, other = _in_pieces(coarse, fine, n, 0.0, narrow)
            blurred = np.abs(one - other).max(axis=1, initial=0.0)
    return Difference(at_ends, inside, np.maximum(inside, blurred), amplitude)


def _in_one_piece(coarse: ProbeResult, fine: ProbeResult, every: int, n: int):
    """Both runs at places of the fine slabs that hold no front, chunk by chunk, each of shape (2, instants)."""
    x = np.array(chebyshev(max(coarse.record.a1.basis.s, fine.record.a1.basis.s)))
    if 0.0 < fine.share < 1.0:
        edges = [
            delay / probe.record.a1.h * k % 1.0 for probe, k in ((fine, 1), (coarse, every)) for delay in _ways(probe)
        ]
        x = np.unique(np.clip(np.concatenate([x, *(np.array([edge - BESIDE, edge + BESIDE]) for edge in edges)]), 0, 1))
    whole = ~_broken(coarse, fine, n)
    in_coarse = (np.arange(every)[:, None] + x).ravel() / every
    for first in range(0, n // every, CHUNK):
        count = min(CHUNK, n // every - first)
        kept = whole[first * every : (first + count) * every]
        ours = _on_slabs(fine, x, first * every, count * every)
        theirs = _on_slabs(coarse, in_coarse, first, count).reshape(2, count * every, len(x))
        yield theirs[:, kept].reshape(2, -1), ours[:, kept].reshape(2, -1)


def _on_slabs(probe: ProbeResult, x: NDArray, first: int, n: int) -> NDArray:
    """Gauge effort and z0 times flow at places x, in slabs, of n slabs from a first one on, shape (2, n, places)."""
    a, b = (
        _wave_on_slabs(wave, delay / wave.h, x, first, n)
        for wave, delay in zip(_waves(probe), _ways(probe), strict=True)
    )
    return np.stack([(a + b) / 2 - probe.height.weight, (a - b) / 2])


def _wave_on_slabs(wave: Wave, late: float, x: NDArray, first: int, n: int) -> NDArray:
    """A wave that comes so many slabs late, shape (n, places)."""
    slab = np.floor(x - late).astype(int)
    seen = np.empty((n, len(x)))
    for k in np.unique(slab):
        here = slab == k
        begin = min(max(first + int(k), 0), first + n)
        none = min(max(-first - int(k), 0), n)
        values = wave.values[begin : begin + n - none]
        seen[:none, here] = wave.before
        seen[none:, here] = values @ wave.basis.evaluation(x[here] - late - k).T
    return seen


def _in_pieces(
    coarse: ProbeResult, fine: ProbeResult, n: int, narrowest: float, widest: float
) -> tuple[NDArray, NDArray]:
    """Both runs at places of the pieces, so wide, of slabs that hold fronts, each of shape (2, instants)."""
    broken, h = _broken(coarse, fine, n), fine.record.a1.h
    if not broken.any():
        return np.empty((2, 0)), np.empty((2, 0))
    slabs = np.flatnonzero(broken)
    fronts = np.concatenate([breakpoints(coarse), breakpoints(fine)]) / h
    knots = np.unique(np.concatenate([slabs, slabs + 1, fronts[(fronts > 0) & (fronts < n)]]))
    start, width = knots[:-1], np.diff(knots)
    kept = (width > max(4 * BESIDE, narrowest / h)) & (width <= widest / h)
    kept &= broken[np.minimum((start + width / 2).astype(int), n - 1)]
    start, width = start[kept] + BESIDE, width[kept] - 2 * BESIDE
    x = np.array([*chebyshev(fine.record.a1.basis.s), 1.0])
    t = (start[:, None] + width[:, None] * x).ravel() * h
    z0 = fine.record.z0
    one, other = (np.stack([seen.gauge_pressure, z0 * seen.y]) for seen in (coarse.at(t), fine.at(t)))
    return one, other


def _broken(coarse: ProbeResult, fine: ProbeResult, n: int) -> NDArray:
    """Whether a front of either run lies inside each of n fine slabs, or a slab there is held in pieces."""
    broken = np.zeros(n + 1, bool)
    for probe in (coarse, fine):
        ratio = probe.record.a1.h / fine.record.a1.h
        for wave, delay in zip(_waves(probe), _ways(probe), strict=True):
            slabs = np.unique(wave.pieces.slab)
            if len(slabs):
                begin = np.floor((slabs + delay / wave.h) * ratio + BESIDE).astype(int)
                for k in range(round(ratio) + (delay > 0)):
                    broken[np.minimum(begin + k, n)] = True
    return broken[:n]


def breakpoints(probe: ProbeResult) -> NDArray:
    """Instants at which fronts inside slabs pass a probe, s."""
    return np.unique(
        np.concatenate([wave.breakpoints() + delay for wave, delay in zip(_waves(probe), _ways(probe), strict=True)])
    )


def _waves(probe: ProbeResult) -> tuple[Wave, Wave]:
    """The two waves that a probe sees, as they are at an end of its line."""
    record = probe.record
    return (record.a2, record.b2) if probe.share == 1.0 else (record.a1, record.b1 if probe.share == 0.0 else record.b2)


def _ways(probe: ProbeResult) -> tuple[float, float]:
    """How much later each is seen by the probe, s."""
    if probe.share in (0.0, 1.0):
        return 0.0, 0.0
    return probe.share * probe.record.delay, (1.0 - probe.share) * probe.record.delay
