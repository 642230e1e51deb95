"""The table of what a probe shows: names, units, from what, and whose error; all that shows results reads it.

`u` is the effort of the waves everywhere: a voltage, or the piezometric pressure, which is the gauge pressure where
the scene has no elevations.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import NDArray

from tline.solver.description.given import Scene, readable

if TYPE_CHECKING:
    from tline.solver.result.result import ProbeResult, Samples


class Bounds(NamedTuple):
    """Errors of effort and flow at a probe, Pa or V, and m³/s or A, and what others follow from them with."""

    u: float
    y: float
    z0: float  # of the line that the probe is on
    per_metre: float  # density·g, Pa/m
    largest_u: float = 0.0  # sizes of effort and flow
    largest_y: float = 0.0


class Quantity(NamedTuple):
    """What a probe shows."""

    key: str  # its name in Python, arrays and files of arrays
    word: str  # its name for people; empty if the medium has one
    unit: str  # SI unit, or whose unit of the medium it has: "effort" or "flow"
    of: "Callable[[Samples], NDArray]"  # from samples to values
    error: Callable[[Bounds], float]  # from bounds of effort and flow to that of the quantity
    flows: bool = False  # whether it takes a line's flow
    # whether only scenes with elevations have it (True), or people read it only in scenes without (False)
    heights: bool | None = None
    in_tables: bool = True  # whether tables, plots and sweeps show it, and not files alone

    def named(self, scene: Scene) -> str:
        """What people call it."""
        medium = readable(scene)
        return self.word or (medium.effort if self.unit == "effort" else medium.flow)

    def si(self, scene: Scene) -> str:
        """Its SI unit."""
        return readable(scene).units.get(self.unit, self.unit)

    def shown(self, scene: Scene) -> str:
        """The unit in which people read it."""
        return readable(scene).shown.get(self.unit, self.unit)

    def written(self, scene: Scene) -> tuple[float, str]:
        """Size and name of the unit in which tables in files have it."""
        return readable(scene).unit(self.unit, written=True)

    def seen_by(self, probe: "ProbeResult") -> bool:
        """Whether a probe has it."""
        return probe.has_flow or not self.flows


QUANTITIES = (
    Quantity("u", "", "effort", lambda seen: seen.u, lambda off: off.u, heights=False),
    Quantity(
        "gauge_pressure", "gauge pressure", "effort", lambda seen: seen.gauge_pressure, lambda off: off.u, heights=True
    ),
    Quantity("head", "head", "m", lambda seen: seen.head, lambda off: off.u / off.per_metre, heights=True),
    Quantity("y", "", "flow", lambda seen: seen.y, lambda off: off.y, flows=True),
    Quantity("a", "a", "effort", lambda seen: seen.a, lambda off: off.u + off.z0 * off.y, flows=True, in_tables=False),
    Quantity("b", "b", "effort", lambda seen: seen.b, lambda off: off.u + off.z0 * off.y, flows=True, in_tables=False),
)


def quantity(key: str) -> Quantity:
    """That of a name in Python."""
    return next(each for each in QUANTITIES if each.key == key)


def in_arrays(scene: Scene) -> list[Quantity]:
    """What a scene's results hold, for programs."""
    return [each for each in QUANTITIES if scene.heights or not each.heights]


def in_columns(scene: Scene) -> list[Quantity]:
    """What people read of them: in a scene with elevations gauge pressure and head stand for the effort."""
    return [each for each in QUANTITIES if each.heights in (None, bool(scene.heights))]


def in_tables(scene: Scene) -> list[Quantity]:
    """The same without waves."""
    return [each for each in in_columns(scene) if each.in_tables]


def in_sweeps(scene: Scene) -> list[Quantity]:
    """What sweeps keep at instants."""
    return [each for each in in_arrays(scene) if each.in_tables]
