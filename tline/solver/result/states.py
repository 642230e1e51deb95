"""What elements with states, or openings that move, show of themselves over time: the table of it is their own.

An element tells what it shows in `shows` (`tline.scene.law.Shown`): word, SI unit, and from which state and flow.
"""

from collections.abc import Callable, Collection
from importlib import import_module
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description, describe
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import varies
from tline.solver.description.given import GAS_VOLUME, OPENING, AirVessel, Shape
from tline.solver.result.result import ElementRecord, Result
from tline.words.wording import place

MOST_SAMPLES = 2e7  # of states that a run keeps without being asked


class StateTrace(NamedTuple):
    """One quantity of an element at slab ends."""

    where: str  # place of the element
    word: str  # what it is called, such as "speed"
    unit: str  # SI; empty of a share
    t: NDArray  # (slabs + 1,) from t = 0 on, s
    values: NDArray  # (slabs + 1,) in SI

    @property
    def name(self) -> str:
        """What a column of it is called."""
        return f"{self.where.partition('.')[2]} {self.word}"

    def extremes(self) -> tuple[float, float, float, float]:
        """Lowest value and its instant, highest value and its instant."""
        low, high = int(np.argmin(self.values)), int(np.argmax(self.values))
        return float(self.values[low]), float(self.t[low]), float(self.values[high]), float(self.t[high])

    def row(self, size: float) -> tuple[float, ...]:
        """Value before t = 0, lowest and its instant, highest and its instant, and last, in a unit of this size."""
        low, low_at, high, high_at = self.extremes()
        return float(self.values[0]) / size, low / size, low_at, high / size, high_at, float(self.values[-1]) / size


def watched(description: Description, samples: float) -> Collection[str]:
    """Places of the elements whose states a run of so many samples for each keeps."""
    found = {e.where for e in description.elements if e.kind.states or e.governor is not None}
    return found if len(found) * samples <= MOST_SAMPLES else ()


def states_of(result: Result) -> list[StateTrace]:
    """All that elements of a scene show, in its order; of stretches in lines with cavities too."""
    whole = result.parts or result
    found, t = list[StateTrace](), whole.t
    placed = {place(*at): element for at, element in whole.scene.placed}
    for element in describe(whole.scene).elements:
        record, owner = whole.elements.get(element.where), placed[element.where]
        given = getattr(owner, element.kind.control, None)
        if isinstance(given, Shape) and varies(given):
            found.append(StateTrace(element.where, element.kind.control, "", t, given.value(t, t)))
        shows = owner.shows if element.governor is None else (OPENING,)
        if record is not None and shows and len(record.states):
            ends = record.wave.h * np.arange(len(record.states))
            states, flows = (np.interp(t, ends, values) for values in (record.states, flow_of(element, record)))
            found += [StateTrace(element.where, x.word, x.unit, t, x.of(owner, states, flows)) for x in shows]
    return found


def emptied(result: Result) -> dict[str, tuple[float, float]]:
    """Vessels, by place, that run empty of liquid, with the instant, s, and the volume that gas fills then, m³."""
    vessels = {
        place(*at): element.total_volume
        for at, element in result.scene.placed
        if isinstance(element, AirVessel) and not element.bladder
    }
    if all(total is None for total in vessels.values()):
        return {}
    found = {}
    for trace in result.states:
        total = vessels.get(trace.where)
        if total is None or trace.word != GAS_VOLUME:
            continue
        over = np.flatnonzero(trace.values >= total)
        if over.size:
            found[trace.where] = _reached(trace, int(over[0]), float(total)), float(total)
    return found


def _reached(trace: StateTrace, k: int, value: float) -> float:
    """When a trace came to a value that it has at slab end k, on a straight line from the one before, s."""
    if k == 0:
        return float(trace.t[0])
    share = (value - trace.values[k - 1]) / (trace.values[k] - trace.values[k - 1])
    return float(trace.t[k - 1] + share * (trace.t[k] - trace.t[k - 1]))


def flow_of(element: PlacedLaw, record: ElementRecord) -> NDArray:
    """Flow into a store at slab ends, at first as after one slab; not a number where its unit does not tell it."""
    module = import_module(f"tline.solver.kernel.{element.kind.unit.rpartition('.')[0]}")
    entering: Callable | None = getattr(module, "entering", None)
    if entering is None:
        return np.full(len(record.states), np.nan)
    c, drives = np.array(element.constants), record.wave.at_slab_ends()[1:]
    pairs = zip(record.states[1:], drives, strict=True)
    flows = [entering(c, 0, y, 0.0, drive, record.impedance)[0] for y, drive in pairs]
    return np.array([*flows[:1], *flows])
