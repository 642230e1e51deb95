"""Limits of gauge pressure or head, at all nodes or along a path, and the margin of a run to them."""

from collections.abc import Sequence
from math import inf, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.design.search import Trial
from tline.errors import InputError
from tline.pictures.bounds import one_liquid
from tline.pictures.path import Route, extremes_along, route
from tline.scene.heights import weight_at, words
from tline.scene.load import Reservoir
from tline.scene.scene import Scene
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import Result
from tline.units import to_si

LATE = 0.99  # of the run


class Limits(NamedTuple):
    """Limits of the extremes, and the places at which they hold."""

    scene: Scene
    way: Route | None  # the path; all nodes if None
    lowest: float  # lowest, highest: Pa; infinite where there is no limit
    highest: float
    per_metre: float | None  # of heads, Pa/m; None if gauge pressures are limited

    @property
    def record(self) -> tuple[str, ...]:
        """Lines whose waves must be recorded."""
        return self.way.lines if self.way else ()

    @property
    def where(self) -> str:
        """Places of the limits, in words."""
        return f"from {self.way.nodes[0]} to {self.way.nodes[-1]}" if self.way else "at all nodes"

    @property
    def word(self) -> str:
        """Name of the limited quantity."""
        return "gauge pressure" if self.per_metre is None else "head"

    @property
    def unit(self) -> tuple[float, str]:
        """Size, Pa, and name of the unit for display."""
        size, unit = words(self.scene).unit("m" if self.per_metre else "effort")
        return size * (self.per_metre or 1.0), unit

    def shown(self, pressure: float) -> str:
        """Format a pressure, or its head, with a unit."""
        size, unit = self.unit
        return f"{pressure / size:.4g} {unit}"

    def trial(self, size: float, result: Result) -> Trial:
        """Trial with the extremes of a run, and their margin."""
        self._refuse_broken(result.envelope)
        lowest, highest, error = self._extremes(result)
        return Trial(size, lowest, highest, min(lowest - self.lowest, self.highest - highest), error)

    def worst_node(self, result: Result, low: bool) -> str:
        """Node of the lowest or the highest limited value of a run."""
        seen = result.envelope
        assert seen is not None
        found = (
            np.nanargmin(self._at_nodes(seen, seen.lowest)) if low else np.nanargmax(self._at_nodes(seen, seen.highest))
        )
        return seen.nodes[int(found)]

    def at_the_end(self, result: Result) -> bool:
        """Whether a limited extreme comes so near the end of the run that a later one may exceed it."""
        seen = result.envelope
        assert seen is not None
        low, high = (seen.nodes.index(self.worst_node(result, low)) for low in (True, False))
        late = (self.lowest, seen.lowest_at[low]), (self.highest, seen.highest_at[high])
        return any(isfinite(limit) and when > LATE * result.t[-1] for limit, when in late)

    def _refuse_broken(self, seen: Envelope | None) -> None:
        assert seen is not None
        before = self._at_nodes(seen, seen.start)
        low, high = int(np.nanargmin(before)), int(np.nanargmax(before))
        for key, limit, k in (("lowest", self.lowest, low), ("highest", self.highest, high)):
            if before[k] < limit if key == "lowest" else before[k] > limit:
                problem = f"'{seen.nodes[k]}' is beyond it before the surge, at {self.shown(before[k])}"
                raise InputError(key, problem, "one that the steady state keeps, or a path", self.shown(limit))

    def _at_nodes(self, seen: Envelope, effort: NDArray) -> NDArray:
        """Limited quantity at nodes of the path, or at all that no reservoir holds; nan at others."""
        if self.way:
            chosen = np.isin(seen.nodes, self.way.nodes)
        else:
            held = {load.at for load in self.scene.loads.values() if isinstance(load, Reservoir)}
            chosen = np.array([node not in held for node in seen.nodes])
            chosen |= not chosen.any()
        return np.where(chosen, effort - np.nan_to_num(seen.weight) * (self.per_metre is None), np.nan)

    def _extremes(self, result: Result) -> tuple[float, float, float]:
        seen = result.envelope
        assert seen is not None
        error = _largest(np.stack([seen.lowest_error, seen.highest_error]))
        if self.way is None:
            low, high = np.nanmin(self._at_nodes(seen, seen.lowest)), np.nanmax(self._at_nodes(seen, seen.highest))
            return float(low), float(high), error
        along = extremes_along(result, self.way)
        weight = self._weight(along.x) * (self.per_metre is None)
        return float(np.nanmin(along.lowest - weight)), float(np.nanmax(along.highest - weight)), error

    def _weight(self, x: NDArray) -> NDArray:
        """Density·g·elevation at places of the path, where each line begins at the place at which the last one ends."""
        assert self.way is not None
        weight = weight_at(self.scene)
        unknown = np.nan if weight else 0.0
        parts = np.split(x, np.flatnonzero(np.diff(x) == 0) + 1)
        found = []
        for leg, places in zip(self.way.legs, parts, strict=True):
            nodes = self.scene.single_lines[leg.line].nodes[:: 1 if leg.forward else -1]
            found.append(np.interp(places, leg.span, [weight.get(node, unknown) for node in nodes]))
        return np.concatenate(found)


def limits(scene: Scene, path: Sequence[str], lowest: float | str | None, highest: float | str | None) -> Limits:
    """Read limits of a scene: gauge pressures, Pa, or texts with units; metres are a head above the zero of heights."""
    if scene.medium != "hydraulic":
        raise InputError("medium", "is designed for no surge", "'hydraulic'", f"'{scene.medium}'")
    if scene.start != "steady":
        raise InputError("start", "nothing is known of before", "'steady'", f"'{scene.start}'")
    given = {key: value for key, value in (("lowest", lowest), ("highest", highest)) if value is not None}
    if not given:
        raise InputError("highest", "no limit is given", "a lowest pressure or head, a highest, or both")
    read = {key: _read(key, value) for key, value in given.items()}
    if len({head for _, head in read.values()}) > 1:
        raise InputError("highest", "not of the kind of the lowest", "two pressures, or two heads", str(highest))
    per_metre = None
    if any(head for _, head in read.values()):
        per_metre = one_liquid(scene, scene.single_lines)
        if per_metre is None:
            raise InputError(next(iter(given)), "a head needs heights", "a pressure, or elevations of nodes")
    low, high = (
        read[key][0] * (per_metre or 1.0) if key in read else default
        for key, default in (("lowest", -inf), ("highest", inf))
    )
    if low >= high:
        raise InputError("lowest", "not below the highest", f"below {highest}", f"{lowest}")
    return Limits(scene, route(scene, *path) if path else None, low, high, per_metre)


def _read(key: str, value: float | str) -> tuple[float, bool]:
    """Convert a value to SI, and return whether it is a head."""
    try:
        return to_si(value, "Pa", key), False
    except InputError as error:
        try:
            return to_si(value, "m", key), True
        except InputError:
            expected = "a pressure such as '2 bar', or a head such as '35 m'"
            raise InputError(key, error.problem, expected, error.got) from None


def _largest(errors: NDArray) -> float:
    known = errors[np.isfinite(errors)]
    return float(known.max()) if known.size else float("nan")
