"""What a probe at one of several coupled conductors, or at a pair of them, sees: the sum of its modes."""

from collections.abc import Mapping, Sequence

import numpy as np

from tline.solver.description.probes import ProbePlace
from tline.solver.result.result import LineRecord, Wave


def record_of(probe: ProbePlace, records: Mapping[str, LineRecord]) -> LineRecord:
    """What a probe recorded; at conductors as on a single line that carries their voltage and current.

    The z0 is then that of the conductor while the others are held at zero, of two while these are in that mode.
    """
    at = probe.conductor
    if at is None:
        return records[probe.line]
    modes, weights = at.ends[0].modes, np.array(at.weights)
    z0 = 1 / float(weights @ modes.admittance @ weights)
    voltage, current = weights @ modes.T / (weights @ weights), np.linalg.inv(modes.T) @ weights  # per u and y of modes
    found = [records[line] for line in probe.lines]

    def wave(a: str, b: str, sign: float) -> Wave:
        parts = [
            part
            for record, v, i in zip(found, voltage, sign * z0 * current, strict=True)
            for part in (
                (getattr(record, a), (v + i / record.z0) / 2),
                (getattr(record, b), (v - i / record.z0) / 2),
            )
        ]
        return _sum(parts)

    delay = max(record.delay for record in found)
    smeared = any(record.smeared for record in found)
    waves = wave("a1", "b1", 1.0), wave("a1", "b1", -1.0), wave("a2", "b2", 1.0), wave("a2", "b2", -1.0)
    return LineRecord(z0, delay, *waves, smeared, raw=any(record.raw for record in found))


def _sum(parts: Sequence[tuple[Wave, float]]) -> Wave:
    """Waves at the ends of one group, whose fronts are the same, times numbers."""
    (first, _), *_ = parts
    values = sum((factor * wave.values for wave, factor in parts), np.zeros_like(first.values))
    before = sum(factor * wave.before for wave, factor in parts)
    pieces = sum((factor * wave.pieces.values for wave, factor in parts), np.zeros_like(first.pieces.values))
    return Wave(values, before, first.basis, first.h, first.pieces._replace(values=pieces))
