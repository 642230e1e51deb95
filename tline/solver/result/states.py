"""States and openings of elements over time, as listed by the elements, and measures of a finished run.

An element lists them in `shows` (`tline.scene.law.Shown`): word, SI unit, and formula of state and flow.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Mapping
from importlib import import_module
from math import inf, nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description, describe
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import varies
from tline.solver.description.given import (
    AIR_VOLUME,
    GAS_VOLUME,
    OPENING,
    Extent,
    Interval,
    LevelCrossing,
    Measure,
    Shape,
    Signal,
)
from tline.solver.radau import Basis
from tline.solver.result.dense_output import edges_of, on, search, shown
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.wave import ElementRecord
from tline.words.wording import place

MOST_SAMPLES = 2e7  # samples of states that a run keeps by default
BISECTIONS = 50  # of the time between two samples
NEARLY_FULL = 0.1  # of the volume of pipes, below which air in them leaves their waves and heads as they are


class StateTrace(NamedTuple):
    """One quantity of an element at slab ends."""

    where: str  # place of the element in the scene
    word: str  # name of the quantity, such as "speed"
    unit: str  # SI; empty for a ratio
    t: NDArray  # (slabs + 1,) from t = 0 on, s
    values: NDArray  # (slabs + 1,) in SI

    @property
    def name(self) -> str:
        """Heading of its column in tables."""
        return f"{self.where.partition('.')[2]} {self.word}"

    def extremes(self) -> tuple[float, float, float, float]:
        """Return the lowest value and its instant, and the highest and its instant."""
        low, high = int(np.argmin(self.values)), int(np.argmax(self.values))
        return float(self.values[low]), float(self.t[low]), float(self.values[high]), float(self.t[high])

    def row(self, size: float) -> tuple[float, ...]:
        """Return the value before t = 0, lowest and its instant, highest and its instant, and last, in this unit."""
        low, low_at, high, high_at = self.extremes()
        return float(self.values[0]) / size, low / size, low_at, high / size, high_at, float(self.values[-1]) / size


def watched(description: Description, samples: float) -> Collection[str]:
    """Places of the elements whose states a run keeps, at `samples` samples for each."""
    found = {e.where for e in description.elements if e.kind.states or e.governor is not None}
    return found if len(found) * samples <= MOST_SAMPLES else ()


def states_of(result: Result) -> list[StateTrace]:
    """Traces of all elements of a scene, in its order, including cavities along lines."""
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
            ends = record.wave.h * np.arange(record.states.shape[1])
            *states, flows = (np.interp(t, ends, values) for values in (*record.states, flow_of(element, record)))
            each = ((x, x.of(owner, states[x.last], flows)) for x in shows)
            found += [StateTrace(element.where, x.word, x.unit, t, values) for x, values in each if values is not None]
    return found


def emptied(result: Result) -> dict[str, tuple[float, float]]:
    """Vessels that run empty of liquid, by place, with the instant, s, and the volume then filled by gas, m³."""
    vessels = ((place(*at), x) for at, x in result.scene.placed if x.kind == "air vessel" and not x.bladder)
    return _beyond(result, GAS_VOLUME, {where: x.total_volume for where, x in vessels if x.total_volume is not None})


def drained(result: Result) -> dict[str, tuple[float, float]]:
    """Air valves whose air leaves pipes that end there no longer nearly full, by place.

    Each has the instant, s, and the volume of air, m³: `NEARLY_FULL` of that of all these pipes.
    """
    valves = {place(*at): x.at for at, x in result.scene.placed if x.kind == "air valve"}
    volumes = defaultdict[str, float](float)
    for line in result.scene.single_lines.values() if valves else ():
        area, length = (getattr(line.parameters, key, None) for key in ("area", "length"))
        for node in line.nodes:
            volumes[node] += inf if area is None or length is None else float(area * length)
    return _beyond(result, AIR_VOLUME, {where: NEARLY_FULL * (volumes[at] or inf) for where, at in valves.items()})


def _beyond(result: Result, word: str, most: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Elements with a state that reaches the most it may have, with the instant and that value."""
    found = {}
    for trace in result.states if most else ():
        value = most.get(trace.where, inf)
        over = np.flatnonzero(trace.values >= value)
        if trace.word == word and over.size:  # the instant, by linear interpolation from the slab end before
            last = slice(max(int(over[0]) - 1, 0), int(over[0]) + 1)
            found[trace.where] = float(np.interp(value, trace.values[last], trace.t[last])), float(value)
    return found


def flow_of(element: PlacedLaw, record: ElementRecord) -> NDArray:
    """Flow into a store at slab ends, the first as after one slab; NaN if its kernel unit does not compute it."""
    module = import_module(f"tline.solver.kernel.{element.kind.unit.rpartition('.')[0]}")
    entering: Callable | None = getattr(module, "entering", None)
    if entering is None:
        return np.full(record.states.shape[1], np.nan)
    c, drives = np.array(element.constants), record.wave.at_slab_ends()[1:]
    pairs = zip(record.states[0, 1:], drives, strict=True)
    flows = [entering(c, 0, y, 0.0, drive, record.impedance)[0] for y, drive in pairs]
    return np.array([*flows[:1], *flows])


class Measured(NamedTuple):
    """Value of a measure in SI, NaN where its event does not happen, and its unit."""

    value: float
    unit: str


def measures_of(result: Result) -> dict[str, Measured]:
    """Evaluate each measure of the scene, by name."""
    effort = result.medium.units["effort"]
    return {name: _measured(measure, result.probes, effort) for name, measure in result.scene.measures.items()}


def _measured(measure: Measure, probes: Mapping[str, ProbeResult], unit: str) -> Measured:
    match measure:
        case Extent():
            value = _extent(measure, probes)
            return Measured(value, f"{unit} s" if measure.kind == "integral" else unit)
        case Interval():
            return Measured(_instant(measure.stop, probes) - _instant(measure.start, probes), "s")
        case LevelCrossing():
            return Measured(_instant(measure, probes), "s")
        case _:
            at = _instant(measure.when, probes) if measure.when else float(measure.at or 0.0)
            end = min(probe.slabs.end for probe, _ in _probes(measure, probes))
            return Measured(_at(measure, probes, at) if at <= end else nan, unit)


def _probes(signal: Signal, probes: Mapping[str, ProbeResult]) -> list[tuple[ProbeResult, float]]:
    """Probes whose gauge efforts, times a sign, make a signal."""
    return [(probes[name], sign) for name, sign in ((signal.probe, 1.0), (signal.minus, -1.0)) if name is not None]


def _at(signal: Signal, probes: Mapping[str, ProbeResult], t: float) -> float:
    """Value of a signal at an instant; at a jump that before it."""
    found = 0.0
    for probe, sign in _probes(signal, probes):
        (a, of_a), (b, of_b) = shown(probe.record, probe.share)
        found += sign * (float(a(t - of_a) + b(t - of_b)) / 2 - probe.height.weight)
    return found


def _pieces(
    signal: Signal, probes: Mapping[str, ProbeResult], start: float, stop: float
) -> tuple[NDArray, NDArray, Basis] | None:
    """Edges of the polynomials of a signal from an instant to another, and values at points; None behind the run."""
    end, each = inf, []
    for probe, sign in _probes(signal, probes):
        end = min(end, probe.slabs.end)
        each += [(wave, late, sign) for wave, late in shown(probe.record, probe.share)]
    if start >= end:
        return None
    edges = np.clip(edges_of([(wave, late) for wave, late, _ in each], end), start, min(stop, end))
    edges = edges[np.append(True, np.diff(edges) > 0.0)]
    order = max((wave.basis for wave, *_ in each), key=lambda basis: basis.s)
    u = np.sum([sign / 2 * on(wave, late, edges, order.c) for wave, late, sign in each], axis=0)
    return edges, u - sum(sign * probe.height.weight for probe, sign in _probes(signal, probes)), order


def _extent(measure: Extent, probes: Mapping[str, ProbeResult]) -> float:
    if (found := _pieces(measure, probes, measure.start, measure.stop or inf)) is None:
        return nan
    edges, u, order = found
    if measure.kind in ("mean", "rms", "integral"):
        whole = float(np.diff(edges) @ ((u**2 if measure.kind == "rms" else u) @ order.A[-1]))
        mean = whole / float(edges[-1] - edges[0])
        return whole if measure.kind == "integral" else sqrt(mean) if measure.kind == "rms" else mean
    (low, _), (high, _) = search(_at(measure, probes, float(edges[0])), edges, u, order)
    return {"minimum": low, "maximum": high}.get(measure.kind, high - low)


def _instant(crossing: LevelCrossing, probes: Mapping[str, ProbeResult]) -> float:
    if (found := _pieces(crossing, probes, crossing.after, inf)) is None:
        return nan
    (edges, u, order), level = found, float(crossing.level)
    places, values = np.append(0.0, order.c), np.column_stack([u @ order.begin, u])
    t = np.append(edges[0], edges[:-1, None] + np.diff(edges)[:, None] * places)
    u = np.append(_at(crossing, probes, float(edges[0])), values)
    rises, falls = ((s * u[:-1] < s * level) & (s * u[1:] >= s * level) for s in (1, -1))
    crossed = np.flatnonzero({"rise": rises, "fall": falls}.get(crossing.edge, rises | falls))
    if len(crossed) < crossing.count or not len(crossed):
        return nan
    k = int(crossed[crossing.count - 1])
    piece, sign = k // len(places), 1 if rises[k] else -1
    if t[k] == t[k + 1]:
        return float(t[k])
    low, high = places[k % len(places) - 1 :][:2]
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        here = float(order.evaluation([middle])[0] @ values[piece, 1:])
        low, high = (middle, high) if sign * here < sign * level else (low, middle)
    return float(edges[piece] + (edges[piece + 1] - edges[piece]) * high)
