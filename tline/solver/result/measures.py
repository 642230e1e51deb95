"""What the measures of a scene say of a finished run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.given import Extent, Interval, LevelCrossing, Measure, Signal
from tline.solver.result.dense_output import PLACES, curve, drawable, highest
from tline.solver.result.result import ProbeResult, Result

BISECTIONS = 50  # of the time between two samples, as long as these halves are numbers of their own
GAUSS = np.polynomial.legendre.leggauss(4)


class Measured(NamedTuple):
    """A value in SI, not a number where what is measured does not happen, and its unit."""

    value: float
    unit: str


class Track(NamedTuple):
    """A signal as samples, both sides of every front and slab's edge among them, and at any instant."""

    t: NDArray
    u: NDArray
    at: Callable[[NDArray], NDArray]
    step: float  # time between samples, s

    def within(self, start: float, stop: float) -> Track:
        """The part between two instants."""
        ends = np.array([start, min(stop, self.t[-1])])
        inside = (self.t > ends[0]) & (self.t < ends[1])
        near, far = self.at(ends)
        t, u = np.concatenate([ends[:1], self.t[inside], ends[1:]]), np.concatenate([[near], self.u[inside], [far]])
        return self._replace(t=t, u=u)


def measures_of(result: Result) -> dict[str, Measured]:
    """Each measure by name.

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
    """A probe's effort, or the difference of two."""
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
    """Values at rising instants; of two that are the same the second is that behind a jump."""
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
    """When the level is crossed, not a number if it never is."""
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
