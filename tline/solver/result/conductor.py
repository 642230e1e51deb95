"""What a probe at one of several coupled conductors sees: the sum of its modes."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from tline.scene.coupled import End, ends_of
from tline.scene.scene import Scene
from tline.solver.result.result import LineRecord, Wave


class Conductor(NamedTuple):
    """Where a probe at coupled conductors stands: which line, which conductor, and at which end."""

    line: str
    place: int
    end: int
    ends: tuple[End, End]

    @property
    def lines(self) -> list[str]:
        """The lines of its modes."""
        return [node.removesuffix(", end 1") for node in self.ends[0].modal]


def conductor(scene: Scene, probe: str) -> Conductor | None:
    """The conductor that a probe sees, None if it sees a single line."""
    name, at = scene.probed_line(probe), scene.probes[probe].at
    ends = ends_of({name: scene.lines[name]})
    for side, end in enumerate(ends):
        if at in end.conductors:
            return Conductor(name, end.conductors.index(at), side, (ends[0], ends[1]))
    return None


def record_of(at: Conductor, records: Mapping[str, LineRecord]) -> LineRecord:
    """What the probe would have recorded on a single line that carries the conductor's voltage and current.

    Its z0 is that of the conductor while the others are held at zero.
    """
    modes, j = at.ends[0].modes, at.place
    z0 = 1 / float(modes.admittance[j, j])
    voltage, current = modes.T[j], np.linalg.inv(modes.T)[:, j]  # per u and y of each mode
    found = [records[line] for line in at.lines]

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
    return LineRecord(z0, delay, *waves, smeared)


def _sum(parts: Sequence[tuple[Wave, float]]) -> Wave:
    """Waves at the ends of one group, whose fronts are the same, times numbers."""
    (first, _), *_ = parts
    values = sum((factor * wave.values for wave, factor in parts), np.zeros_like(first.values))
    before = sum(factor * wave.before for wave, factor in parts)
    pieces = sum((factor * wave.pieces.values for wave, factor in parts), np.zeros_like(first.pieces.values))
    return Wave(values, before, first.basis, first.h, first.pieces._replace(values=pieces))
