"""Richardson extrapolation of runs whose slabs, and with them loss elements, are halved; and how alike these err.

Where corners fall inside slabs and are not followed, each holds the best polynomial across the corner. Halved slabs
begin and end where slabs do: a corner right before such an edge stays as far from it, and bends both polynomials alike.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.radau import basis
from tline.solver.result.result import LineRecord, Result, Wave

WAVES = ("a1", "b1", "a2", "b2")
SEEN = 64  # places of each half of a slab
PLACES = 1000  # of corners in a slab that are told apart


def extrapolated(coarse: Result, fine: Result, power: int) -> Result | None:
    """Two runs, the slabs of one half as wide, without the error that halving divides by 2^power.

    The answer is on the coarse slabs: at their ends, and only there, the runs err alike. None if the runs differ in
    length, or fronts lie inside slabs.
    """
    if fine.slabs.number * fine.slabs.width < (coarse.slabs.number - 0.25) * coarse.slabs.width:
        return None
    lines = (*coarse.lines.values(), *fine.lines.values())
    if any(len(getattr(line, wave).pieces.slab) for line in lines for wave in WAVES):
        return None
    weight = 1.0 / (2.0**power - 1.0)
    records = {name: _record(line, fine.lines[name], weight) for name, line in coarse.lines.items()}
    probes = {
        name: replace(probe, record=records.get(probe.line) or _record(probe.record, fine.probes[name].record, weight))
        for name, probe in coarse.probes.items()  # one at coupled conductors is on no line that is recorded
    }
    of_fine = {key: getattr(fine, key) for key in ("envelope", "accounts", "elements")}
    return replace(coarse, lines=records, probes=probes, **of_fine)


def _record(coarse: LineRecord, fine: LineRecord, weight: float) -> LineRecord:
    return replace(coarse, **{wave: _wave(getattr(coarse, wave), getattr(fine, wave), weight) for wave in WAVES})


def _wave(coarse: Wave, fine: Wave, weight: float) -> Wave:
    n, every = len(coarse.values), round(coarse.h / fine.h)
    seen = fine.values[: n * every].reshape(n, -1) @ _points(coarse.basis.s, fine.basis.s, every)
    return replace(coarse, values=seen + weight * (seen - coarse.values))


@lru_cache
def _points(s: int, other: int, every: int) -> NDArray:
    """From values in so many slabs, one after the other, to those at the points of order s of one as wide as all."""
    x = every * basis(s).c
    slab = np.ceil(x).astype(int) - 1
    spread = np.zeros((every, other, s))
    spread[slab, :, np.arange(s)] = basis(other).evaluation(x - slab)
    return spread.reshape(every * other, s)


def alike(description: Description, s: int, h: float) -> float:
    """Error of a run of order s on slabs of width h over its difference from that on slabs twice as wide; at least 1.

    It is that of corners of one size at all instants at which waveforms jump or bend.

    Examples
    --------
    >>> from tline.solver.tolerance.extrapolate import ratio
    >>> import numpy as np
    >>> ratio(3, np.array([0.6])) < 3 < ratio(3, np.array([0.97]))
    True
    """
    instants = [waveform.breaks(description.t_end) for waveform in description.waveforms.values()]
    places = np.concatenate([[0.0], *instants]) / (2 * h) % 1.0
    inside = np.unique((PLACES * places[(places > EDGE) & (places < 1 - EDGE)]).round()) / PLACES
    return max(ratio(s, inside), 1.0) if inside.size else 1.0


def ratio(s: int, places: NDArray) -> float:
    """Largest error of the best polynomials on the halves of a slab, over their largest distance from that of all."""
    u, weights = np.polynomial.legendre.leggauss(SEEN)
    points = np.concatenate([(u - 1) / 2, (u + 1) / 2])  # of both halves, -1 to 1
    corner = np.maximum(points - (2 * places[:, None] - 1), 0.0)
    whole = _projected(corner, points, np.tile(weights, 2), s)
    halves = np.hstack([_projected(half, u, weights, s) for half in np.split(corner, 2, axis=1)])
    return float(np.abs(halves - corner).max() / np.abs(halves - whole).max())


def _projected(values: NDArray, points: NDArray, weights: NDArray, s: int) -> NDArray:
    """Best polynomials of degree s - 1, at the points, row by row."""
    basis = np.polynomial.legendre.legvander(points, s - 1)
    size = (weights[:, None] * basis**2).sum(axis=0)
    return (values * weights @ basis / size) @ basis.T
