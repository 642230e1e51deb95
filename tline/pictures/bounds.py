"""Units of efforts along a route or on a map, and their bounds: the ground, the rating, a vacuum."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.pictures.path import Leg, Route
from tline.scene.heights import weight_at, words
from tline.scene.medium import readable
from tline.scene.scene import Scene
from tline.solver.result.notes import VACUUM
from tline.units import engineering, handy


class Scale(NamedTuple):
    """Name and unit in which efforts are displayed."""

    word: str  # name of the effort
    size: float  # of the unit in Pa or V
    unit: str


class Bound(NamedTuple):
    """Bound of the effort along a route."""

    kind: str  # ground, rating or vacuum
    name: str
    x: NDArray  # (places,) both ends of each line, in the route's unit
    effort: NDArray  # (places,) Pa or V; NaN where the height is not known

    def in_units(self, place: float, effort: float) -> "Bound":
        """Convert to units of these sizes."""
        return self._replace(x=self.x / place, effort=self.effort / effort)


def scale(scene: Scene, lines: Iterable[str], largest: float) -> Scale:
    """Choose head where nodes have heights and the lines hold one liquid; else a handy unit.

    Examples
    --------
    >>> pipe = {"nodes": ["a", "b"], "z0": 1e8, "delay": 1, "density": 1000}
    >>> given = {"medium": "hydraulic", "t_end": 1, "lines": {"pipe": pipe}, "probes": {"p": {"at": "a"}}}
    >>> scale(Scene(**given), ["pipe"], 2e5)
    Scale(word='pressure', size=100000.0, unit='bar')
    >>> scale(Scene(**given, nodes={"b": {"elevation": "35 m"}}), ["pipe"], 2e5)
    Scale(word='head', size=9806.65, unit='m')
    """
    if (one := one_liquid(scene, lines)) is not None:
        size, unit = handy(1.0, words(scene).shown.get("m", "m"))
        return Scale("head", one * size, unit)
    return Scale(words(scene).effort, *handy(largest, words(scene).shown["effort"]))


def spread(low: float, high: float) -> tuple[float, float]:
    """Limits of an axis for values from low to high, kept apart where these are equal within rounding."""
    largest = max(abs(low), abs(high))
    apart = 0.0 if high - low > 1e-9 * largest else 0.05 * largest or 1.0
    return float(low) - apart, float(high) + apart


def one_liquid(scene: Scene, lines: Iterable[str]) -> float | None:
    """Density·g, Pa/m, where all nodes of lines have heights and hold the same liquid; else None."""
    nodes = {node for line in lines for node in scene.single_lines[line].nodes}
    per_metre = {scene.heights[node].per_metre if node in scene.heights else None for node in nodes}
    return per_metre.pop() if len(per_metre) == 1 else None


def bounds(scene: Scene, way: Route, x: NDArray, lowest: NDArray) -> list[Bound]:
    """Ground, rating, and a vacuum where the lowest pressures, given at places x, fall below that of the air."""
    medium, weight = readable(scene), weight_at(scene)
    unit, liquid = medium.shown["effort"], medium.hydraulic
    places = np.array([place for leg in way.legs for place in leg.span])
    ground = np.array([weight.get(end, np.nan if weight else 0.0) for leg in way.legs for end in _ends(scene, leg)])
    found = [("ground", "ground", 0.0)] if weight else []
    if scene.rating is not None:
        rating = float(scene.rating)
        found.append(("rating", f"rating {engineering(rating, unit)}", rating))
        found += [] if liquid else [("rating", f"\N{MINUS SIGN}{engineering(rating, unit)}", -rating)]
    if liquid and (lowest < np.interp(x, places, ground)).any():
        found.append(("vacuum", f"vacuum, {engineering(VACUUM, unit)}".replace("-", "\N{MINUS SIGN}"), VACUUM))
    return [Bound(kind, name, places, ground + above) for kind, name, above in found]


def _ends(scene: Scene, leg: Leg) -> tuple[str, str]:
    near, far = scene.lines[leg.line].nodes
    return (near, far) if leg.forward else (far, near)
