"""Sites of nodes, and their heights as pressures: the weight of the liquid between a node and the highest one."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from pydantic import BeforeValidator

from tline.errors import InputError
from tline.scene.connected import Joined
from tline.scene.element import Element, optional
from tline.scene.medium import Medium, readable
from tline.scene.ports import Multiport
from tline.scene.quantity import GRAVITY, AnyEffort, Quantity, Role
from tline.words.wording import first_of, place, shown

if TYPE_CHECKING:
    from tline.scene.scene import Scene


def _pair(position: Any) -> Any:
    numbers = isinstance(position, list | tuple) and all(type(x) in (int, float) and abs(x) < 1e100 for x in position)
    if not numbers or len(position) != 2:
        raise InputError("", "not a place on a map", "two numbers such as [120, 45.5]", shown(position))
    return position


Place = Annotated[tuple[float, float], BeforeValidator(_pair)]


class Site(Element):
    """Height and place of a node.

    In a scene with elevations the effort u is the piezometric pressure, density·g·head, with g = 9.80665 m/s²: constant
    along a pipe at rest whatever its slope. Reservoirs and sources of pressure prescribe it. Elements open to the air
    see the gauge pressure at their node, u - density·g·elevation.
    """

    elevation: Annotated[Quantity, Role("length", "m")] | None = optional(
        "height of the node; 0 m if other nodes have one"
    )
    start: AnyEffort | None = optional(
        "piezometric pressure or voltage in the steady state of a part that nothing else determines, such "
        "as a pocket behind shut valves or check valves"
    )
    position: Place | None = optional("coordinates on a map, in any unit")


SAME_DENSITY = 1e-9  # relative; smaller differences between densities are ignored
LISTED = 4  # names


class Height(NamedTuple):
    """Height of a place in a liquid."""

    elevation: float = 0.0  # above the zero of heights, m
    highest: float = 0.0  # elevation of the highest node that lines or links connect it with, m
    per_metre: float = float("nan")  # density·g, Pa/m; nan if the density is not known

    @property
    def weight(self) -> float:
        """Density·g·elevation, Pa: the piezometric pressure less the gauge pressure."""
        return self.per_metre * self.elevation if self.elevation else 0.0

    @property
    def level(self) -> float:
        """Piezometric pressure of the liquid at rest, filled up to the highest node, Pa."""
        return self.per_metre * self.highest if self.highest else 0.0

    @property
    def above_level(self) -> float:
        """Weight less level, Pa: minus the gauge pressure of the liquid at rest."""
        drop = self.elevation - self.highest
        return self.per_metre * drop if drop else 0.0

    def below(self, pressure: float) -> float:
        """Piezometric pressure less the level, Pa; zero if the difference is rounding."""
        return below(pressure, self.level)


NO_HEIGHT = Height()


def below(pressure: float, level: float) -> float:
    """Difference of pressure and level; zero if it is rounding."""
    difference = float(pressure) - level
    return difference if abs(difference) > 1e-15 * abs(level) else 0.0


def heights_of(scene: Scene) -> dict[str, Height]:
    """Height of every node that lines or links connect with one of given elevation; none without elevations.

    A node without an elevation of its own counts as one at 0 m.
    """
    known = _elevations(scene)
    found: dict[str, Height] = {}
    for nodes, lines in _components(scene) if known else ():
        if known.keys().isdisjoint(nodes):
            continue
        density = next(iter(_densities(scene, lines).values()), float("nan"))
        elevations = [known.get(node, 0.0) for node in nodes]
        highest = max(elevations)
        found |= {node: Height(z, highest, density * GRAVITY) for node, z in zip(nodes, elevations, strict=True)}
    return found


def height_mistakes(scene: Scene) -> Iterator[InputError]:
    """Find elevations in a liquid whose density is unknown or not uniform."""
    known = _elevations(scene)
    for nodes, lines in _components(scene) if known else ():
        high = next((node for node in nodes if node in known), None)
        if high is None:
            continue
        densities = _densities(scene, lines)
        if not densities:
            where, expected = place("nodes", high, "elevation"), "none, or the density of a pipe"
            yield InputError(where, "the weight of the liquid does not follow", expected)
        for (one, density), (other, another) in pairwise(densities.items()):
            if abs(density - another) > SAME_DENSITY * density:
                problem = f"not that of {place('lines', one)}, with which it is connected: heights need one liquid"
                expected = f"{density:.9g} kg/m^3"
                yield InputError(place("lines", other, "density"), problem, expected, f"{another:.9g} kg/m^3")
                break


def words(scene: Scene, effort: str = "piezometric pressure") -> Medium:
    """Words and units of a scene's medium; with elevations the effort is named after its kind of pressure."""
    medium = readable(scene)
    return medium._replace(effort=effort) if scene.heights else medium


def weight_at(scene: Scene) -> dict[str, float]:
    """Density·g·elevation of nodes whose elevation is given, Pa: the piezometric pressure less the gauge pressure."""
    return {name: scene.heights[name].weight for name in _elevations(scene)}


def taken_as_zero(scene: Scene) -> list[str]:
    """Note, if any, on nodes without an elevation at which it matters, in a scene with elevations."""
    known = _elevations(scene)
    if not known:
        return []
    indifferent = {"closed", "open", "reservoir"}
    at = [load.at for load in scene.loads.values() if load.kind not in indifferent]
    at += [source.at for source in scene.sources.values() if source.at is not None and not source.is_effort]
    for probe in scene.probes.values():
        at += [probe.at] if probe.at is not None else scene.lines[probe.line or ""].nodes
    grounded = (link for link in scene.links.values() if isinstance(link, Multiport) and link.is_grounded)
    at += [node for link in grounded for node in link.nodes]
    missing = list(dict.fromkeys(node for node in at if node not in known))
    named = first_of([*map(repr, missing)], LISTED)
    return [f"nodes: no elevation is given at {named}, but at other nodes: taken as 0 m"] if missing else []


def _elevations(scene: Scene) -> dict[str, float]:
    return {name: float(site.elevation) for name, site in scene.nodes.items() if site.elevation is not None}


def _densities(scene: Scene, lines: list[str]) -> dict[str, float]:
    """Densities by line, where they are known."""
    each = ((name, _density(scene, name)) for name in lines)
    return {name: float(density) for name, density in each if density is not None}


def _density(scene: Scene, line: str) -> float | None:
    from tline.scene.pipe_table import PipeTable

    if isinstance(scene.lines, PipeTable):
        return scene.lines.density(line)
    return getattr(scene.lines[line].parameters, "density", None)


def _components(scene: Scene) -> list[tuple[list[str], list[str]]]:
    """Nodes and lines of each connected component."""
    joined = Joined()
    lines: dict[str, list[str]] = {name: [] for name in scene.lines}
    for node, names in scene.lines_at.items():
        for name in names:
            lines[name].append(node)
    for nodes in (*lines.values(), *(nodes for _, nodes in scene.between)):
        joined.join(*nodes)
    found: dict[str, tuple[list[str], list[str]]] = {}
    for node in joined:
        found.setdefault(joined.root(node), ([], []))[0].append(node)
    for name, nodes in lines.items():
        found[joined.root(nodes[0])][1].append(name)
    return list(found.values())
