"""States and openings of elements over time, as listed by the elements, and measures of a finished run.

An element lists them in `shows` (`tline.scene.law.Shown`): word, SI unit, and formula of state and flow.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
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
    AirValve,
    AirVessel,
    Extent,
    Interval,
    LevelCrossing,
    Measure,
    Shape,
    Signal,
)
from tline.solver.result.dense_output import PLACES, curve, drawable, highest
from tline.solver.result.result import ElementRecord, ProbeResult, Result
from tline.words.wording import place

MOST_SAMPLES = 2e7  # samples of states that a run keeps by default
BISECTIONS = 50  # of the time between two samples
NEARLY_FULL = 0.1  # of the volume of pipes, below which air in them leaves their waves and heads as they are
GAUSS = np.polynomial.legendre.leggauss(4)


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
    vessels = ((place(*at), x) for at, x in result.scene.placed if isinstance(x, AirVessel) and not x.bladder)
    return _beyond(result, GAS_VOLUME, {where: x.total_volume for where, x in vessels if x.total_volume is not None})


def drained(result: Result) -> dict[str, tuple[float, float]]:
    """Air valves whose air leaves pipes that end there no longer nearly full, by place.

    Each has the instant, s, and the volume of air, m³: `NEARLY_FULL` of that of all these pipes.
    """
    valves = {place(*at): x.at for at, x in result.scene.placed if isinstance(x, AirValve)}
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
        if trace.word == word and over.size:
            found[trace.where] = _reached(trace, int(over[0]), float(value)), float(value)
    return found


def _reached(trace: StateTrace, k: int, value: float) -> float:
    """Instant, s, at which a trace reaches a value by slab end k, by linear interpolation from the end before."""
    if k == 0:
        return float(trace.t[0])
    share = (value - trace.values[k - 1]) / (trace.values[k] - trace.values[k - 1])
    return float(trace.t[k - 1] + share * (trace.t[k] - trace.t[k - 1]))


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


class Track(NamedTuple):
    """Signal as samples, with both sides of every front and slab edge, and as a function of time."""

    t: NDArray
    u: NDArray
    at: Callable[[NDArray], NDArray]
    step: float  # largest time between samples, s

    def within(self, start: float, stop: float) -> Track:
        """Return the part between two instants."""
        ends = np.array([start, min(stop, self.t[-1])])
        inside = (self.t > ends[0]) & (self.t < ends[1])
        near, far = self.at(ends)
        t, u = np.concatenate([ends[:1], self.t[inside], ends[1:]]), np.concatenate([[near], self.u[inside], [far]])
        return self._replace(t=t, u=u)


def measures_of(result: Result) -> dict[str, Measured]:
    """Evaluate each measure of the scene, by name.

    Examples
    --------
    >>> import tline as tl
    >>> scene = tl.examples["open_line"].with_changes(
    ...     measures={"swing": {"kind": "peak to peak", "probe": next(iter(tl.examples["open_line"].probes))}}
    ... )
    >>> tl.simulate(scene).measures["swing"].unit
    'V'
    """
    effort = result.medium.units["effort"]
    return {name: _measured(measure, result.probes, effort) for name, measure in result.scene.measures.items()}


def _measured(measure: Measure, probes: Mapping[str, ProbeResult], unit: str) -> Measured:
    match measure:
        case Extent():
            track = _track(measure, probes)
            if measure.start >= track.t[-1]:
                return Measured(nan, unit)
            value = _extent(measure.kind, track.within(measure.start, measure.stop or np.inf))
            return Measured(value, f"{unit} s" if measure.kind == "integral" else unit)
        case Interval():
            return Measured(_instant(measure.stop, probes) - _instant(measure.start, probes), "s")
        case LevelCrossing():
            return Measured(_instant(measure, probes), "s")
        case _:
            track = _track(measure, probes)
            at = _instant(measure.when, probes) if measure.when else float(measure.at or 0.0)
            return Measured(float(track.at(np.array(at))) if at <= track.t[-1] else nan, unit)


def _track(signal: Signal, probes: Mapping[str, ProbeResult]) -> Track:
    first = _of_probe(probes[signal.probe])
    if signal.minus is None:
        return first
    second = _of_probe(probes[signal.minus])
    t = np.sort(np.concatenate([first.t, second.t]))
    ends = [_both_sides(each, t) for each in (first, second)]
    return Track(t, ends[0] - ends[1], lambda x: first.at(x) - second.at(x), min(first.step, second.step))


def _of_probe(probe: ProbeResult) -> Track:
    seen, shown = curve(probe, PLACES), replace(probe, record=drawable(probe.record))
    step = float(np.diff(seen.t).max())
    return Track(seen.t, seen.gauge_pressure, lambda x: shown.at(x).gauge_pressure, step)


def _both_sides(track: Track, t: NDArray) -> NDArray:
    """Values at rising instants; the second of two equal ones is the value behind a jump."""
    behind = np.append(False, np.diff(t) == 0)
    before, after = (np.searchsorted(track.t, t, side) for side in ("left", "right"))
    known = after > before
    values = track.at(t)
    values[known] = track.u[np.where(behind, after - 1, before)[known]]
    return values


def _extent(kind: str, track: Track) -> float:
    if kind in ("mean", "rms", "integral"):
        points, weights = GAUSS
        middle, half = (track.t[1:] + track.t[:-1]) / 2, np.diff(track.t) / 2
        u = track.at(middle[:, None] + half[:, None] * points)
        whole = float(half @ ((u**2 if kind == "rms" else u) @ weights))
        mean = whole / float(track.t[-1] - track.t[0])
        return whole if kind == "integral" else sqrt(mean) if kind == "rms" else mean
    noise = 1e-13 * float(np.abs(track.u).max())
    low, high = (highest(track.at, track.t, track.u, sign, noise, track.step)[0] for sign in (-1, 1))
    return {"minimum": low, "maximum": high}.get(kind, high - low)


def _instant(crossing: LevelCrossing, probes: Mapping[str, ProbeResult]) -> float:
    track, level = _track(crossing, probes), float(crossing.level)
    if crossing.after >= track.t[-1]:
        return nan
    t, u, *_ = track.within(crossing.after, np.inf)
    rises, falls = ((s * u[:-1] < s * level) & (s * u[1:] >= s * level) for s in (1, -1))
    found = np.flatnonzero({"rise": rises, "fall": falls}.get(crossing.edge, rises | falls))
    if len(found) < crossing.count or not len(found):
        return nan
    k = found[crossing.count - 1]
    low, high, sign = t[k], t[k + 1], 1 if rises[k] else -1
    for _ in range(BISECTIONS if high > low else 0):
        middle = (low + high) / 2
        low, high = (middle, high) if sign * float(track.at(middle)) < sign * level else (low, middle)
    return float(high)
