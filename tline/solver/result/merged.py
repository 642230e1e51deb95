"""A run of the stretches of lines with cavities, seen as one of the lines that they are parts of."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.scene.cavities import places_of, stretches_of, with_cavities
from tline.scene.scene import Scene
from tline.solver.ledger.ledger import Entry, Ledger
from tline.solver.result.envelope import COLUMNS, Envelope
from tline.solver.result.result import LineRecord, Result
from tline.wording import place

NOTHING = [0.0] * (len(Entry._fields) - 1)  # in all columns


@dataclass(frozen=True, eq=False)
class CutRecord(LineRecord):
    """The waves of a line with cavities, at its ends and at both sides of every place.

    Attributes
    ----------
    stretches : tuple of LineRecord
        From end 1 on.
    """

    stretches: tuple[LineRecord, ...]

    def waves(self, t: ArrayLike, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t, at a place given as a share of the delay; at a cavity before it."""
        here = share * len(self.stretches)
        k = max(min(int(np.ceil(here)) - 1, len(self.stretches) - 1), 0)
        return self.stretches[k].waves(t, here - k)


def joined(result: Result, scene: Scene) -> Result:
    """The result of `parted(scene)` as one of the scene itself; `Result.parts` keeps the former."""
    if result.scene is scene:
        return result
    cut = with_cavities(scene.lines)
    stretches = {name: stretches_of(name, line) for name, line in cut.items()}
    hidden = {each for names in stretches.values() for each in names}
    lines = {name: record for name, record in result.lines.items() if name not in hidden}
    for name, names in stretches.items():
        records = tuple(result.lines[each] for each in names if each in result.lines)
        if len(records) == len(names):
            lines[name] = _record(records)
    places = {node for name, line in cut.items() for node in places_of(name, line)}
    return replace(
        result,
        scene=scene,
        lines=lines,
        envelope=result.envelope and _without(result.envelope, places),
        ledger=result.ledger and _summed(result.ledger, scene),
        parts=result,
    )


def recorded(scene: Scene, names: Iterable[str]) -> list[str]:
    """The lines to be recorded for those of the scene."""
    cut = with_cavities(scene.lines)
    return [each for name in names for each in (stretches_of(name, cut[name]) if name in cut else [name])]


def _record(stretches: tuple[LineRecord, ...]) -> CutRecord:
    first, last = stretches[0], stretches[-1]
    return CutRecord(
        first.z0,
        first.delay * len(stretches),
        first.a1,
        first.b1,
        last.a2,
        last.b2,
        first.smeared,
        stretches,
    )


def _without(envelope: Envelope, places: set[str]) -> Envelope:
    """Extremes at the nodes that the scene names."""
    kept = [k for k, node in enumerate(envelope.nodes) if node not in places]
    columns = (getattr(envelope, name)[kept] for name in (*COLUMNS, "weight", "per_metre"))
    return Envelope(tuple(envelope.nodes[k] for k in kept), *columns)


def _summed(ledger: Ledger, scene: Scene) -> Ledger:
    """One account for a line, and one for all its cavities."""
    whole: dict[str, str] = {}
    for name, line in with_cavities(scene.lines).items():
        whole |= {place("lines", each): place("lines", name) for each in stretches_of(name, line)}
        whole |= {place("loads", each): place("lines", name, "cavities") for each in places_of(name, line)}
    sums: dict[str, list[float]] = {}
    for entry in ledger.entries:
        where = whole.get(entry.where, entry.where)
        sums[where] = [x + y for x, y in zip(sums.get(where, NOTHING), entry[1:], strict=True)]
    return Ledger(tuple(Entry(where, *numbers) for where, numbers in sums.items()), ledger.turnover)
