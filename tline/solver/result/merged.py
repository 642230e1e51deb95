"""Results of an expanded scene, merged into those of the scene described.

A probe at one of several coupled conductors, or at a pair of them, records the sum of its modes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from tline.solver.description.description import Description, describe
from tline.solver.description.given import Scene, Stretches
from tline.solver.description.lines import ProbePlace
from tline.solver.ledger.ledger import Entry, Ledger
from tline.solver.loop.slabs import Slabs
from tline.solver.result.envelope import COLUMNS
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.wave import LineRecord, Wave
from tline.words.wording import place

NOTHING = [0.0] * (len(Entry._fields) - 1)  # in all columns


@dataclass(frozen=True, eq=False)
class CutRecord(LineRecord):
    """Waves of a line in stretches, at its ends and at both sides of every place."""

    cut: Stretches
    stretches: tuple[LineRecord, ...]  # from end 1 on

    def passing(self, share: float) -> tuple[tuple[Wave, float], tuple[Wave, float]]:
        """Waves a and b that pass a place given as a share of the delay; at a cavity before it."""
        k, part = self.cut.stretch_at(share)
        return self.stretches[k].passing(part)


def merged(result: Result, description: Description) -> Result:
    """Merge the result of an expanded scene into one of the scene described; `Result.parts` keeps the former."""
    cut = description.stretches
    hidden = {each for stretches in cut.values() for each in stretches.lines}
    lines = {name: record for name, record in result.lines.items() if name not in hidden}
    for name, stretches in cut.items():
        records = tuple(result.lines[each] for each in stretches.lines if each in result.lines)
        if len(records) == len(stretches.lines):
            first, last, delay = records[0], records[-1], sum(record.delay for record in records)
            waves = first.a1, first.b1, last.a2, last.b2
            lines[name] = CutRecord(first.z0, delay, *waves, first.smeared, stretches, records, raw=first.raw)
    envelope, places = result.envelope, {node for stretches in cut.values() for node in stretches.places}
    if envelope:
        kept = [k for k, node in enumerate(envelope.nodes) if node not in places]
        columns = {name: getattr(envelope, name)[kept] for name in (*COLUMNS, "weight", "per_metre")}
        envelope = replace(envelope, nodes=tuple(envelope.nodes[k] for k in kept), **columns)
    return replace(
        result,
        scene=description.scene,
        lines=lines,
        envelope=envelope,
        accounts=_Summed(result, description.scene),
        parts=result,
    )


def recorded(description: Description, names: Iterable[str]) -> list[str]:
    """Lines of the expanded scene that represent lines of the scene."""
    cut = description.stretches
    return [each for name in names for each in (cut[name].lines if name in cut else [name])]


class _Summed(NamedTuple):
    """Ledger of an expanded scene, summed by the lines of the scene when it is first read."""

    parts: Result
    scene: Scene

    def __call__(self) -> Ledger | None:
        if (ledger := self.parts.ledger) is None:
            return None
        whole: dict[str, str] = {}
        for name, stretches in describe(self.scene).stretches.items():
            whole |= {place("lines", each): place("lines", name) for each in stretches.lines}
            whole |= {f"node '{each}'": place("lines", name) for each in stretches.places}
            whole |= {place("loads", each): place("lines", name, "cavities") for each in stretches.cavities}
        sums: dict[str, list[float]] = {}
        for entry in ledger.entries:
            where = whole.get(entry.where, entry.where)
            sums[where] = [x + y for x, y in zip(sums.get(where, NOTHING), entry[1:], strict=True)]
        return Ledger(tuple(Entry(where, *numbers) for where, numbers in sums.items()), ledger.turnover)


def probed(
    description: Description, lines: Mapping[str, LineRecord], alone: Mapping[str, LineRecord], slabs: Slabs
) -> dict[str, ProbeResult]:
    """Results of probes by name, from records of lines, and of nodes without line ends."""
    found = {}
    for name, at in description.probes.items():
        record = alone[at.node] if at.node else record_of(at, lines)
        found[name] = ProbeResult(name, at.line, at.share, record, slabs, at.height)
    return found


def record_of(probe: ProbePlace, records: Mapping[str, LineRecord]) -> LineRecord:
    """Record of a probe; at coupled conductors that of a single line with their voltage and current.

    The z0 is then that of the conductor with the others at zero, or of the pair in its mode.
    """
    at = probe.conductor
    if at is None:
        return records[probe.line]
    voltage, current, z0 = at.parts
    found = [records[line] for line in probe.lines]

    def wave(a: str, b: str, sign: float) -> Wave:
        parts: list[tuple[Wave, float]] = []
        for record, v, i in zip(found, voltage, sign * z0 * current, strict=True):
            parts += [(getattr(record, a), (v + i / record.z0) / 2), (getattr(record, b), (v - i / record.z0) / 2)]
        first = parts[0][0]
        values = sum((factor * wave.values for wave, factor in parts), np.zeros_like(first.values))
        pieces = sum((factor * wave.pieces.values for wave, factor in parts), np.zeros_like(first.pieces.values))
        before = sum(factor * wave.before for wave, factor in parts)
        return Wave(values, before, first.basis, first.h, first.pieces._replace(values=pieces))

    delay = max(record.delay for record in found)
    smeared = any(record.smeared for record in found)
    waves = wave("a1", "b1", 1.0), wave("a1", "b1", -1.0), wave("a2", "b2", 1.0), wave("a2", "b2", -1.0)
    return LineRecord(z0, delay, *waves, smeared, raw=any(record.raw for record in found))
