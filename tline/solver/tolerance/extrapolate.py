"""Richardson extrapolation of runs whose slabs, and with them loss elements, are halved."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import basis
from tline.solver.result.result import LineRecord, Result, Wave

WAVES = ("a1", "b1", "a2", "b2")


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
    return replace(coarse, lines=records, probes=probes, envelope=fine.envelope, accounts=fine.accounts)


def seen_at_ends(coarse: Result, fine: Result) -> Result:
    """A run with the slab ends of a coarser one for its samples; between them it is as it is."""
    probes = {name: replace(probe, slabs=coarse.slabs) for name, probe in fine.probes.items()}
    return replace(fine, slabs=coarse.slabs, resolution=coarse.resolution, probes=probes)


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
