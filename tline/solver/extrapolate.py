"""Richardson extrapolation of runs whose slabs, and with them lumps of losses, are halved."""

from dataclasses import replace

import numpy as np

from tline.solver.result import Result, Wave

WAVES = ("a1", "b1", "a2", "b2")


def extrapolated(coarse: Result, fine: Result, power: int) -> Result | None:
    """Two runs, the slabs of one half as wide, without the error that halving divides by 2^power.

    The answer is on the coarse slabs: at their ends, and only there, the runs err alike. None if the runs differ in
    length, or fronts lie inside slabs.
    """
    return _combined(coarse, fine, 1.0 / (2.0**power - 1.0))


def seen_on(coarse: Result, fine: Result) -> Result | None:
    """A run on the slabs of a coarser one; None in the same cases."""
    return _combined(coarse, fine, 0.0)


def _combined(coarse: Result, fine: Result, weight: float) -> Result | None:
    """The fine run at the points of the coarse slabs, and a weight times its difference to the coarse one."""
    if fine.t[-1] < coarse.t[-1] - fine.resolution.h / 2:
        return None
    records = {}
    for name, line in coarse.lines.items():
        pairs = [(getattr(line, wave), getattr(fine.lines[name], wave)) for wave in WAVES]
        if any(len(wave.pieces.slab) for pair in pairs for wave in pair):
            return None
        waves = {wave: _wave(*pair, weight) for wave, pair in zip(WAVES, pairs, strict=True)}
        records[name] = replace(line, **waves)
    probes = {name: replace(probe, record=records[probe.line]) for name, probe in coarse.probes.items()}
    return replace(coarse, lines=records, probes=probes, envelope=fine.envelope)


def _wave(coarse: Wave, fine: Wave, weight: float) -> Wave:
    t = (np.arange(len(coarse.values))[:, None] + coarse.basis.c) * coarse.h
    seen = fine(t)
    return replace(coarse, values=seen + weight * (seen - coarse.values))
