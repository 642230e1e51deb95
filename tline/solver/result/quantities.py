"""Table of the quantities of a probe: names, units, formulas and errors; read by all tables, files and plots.

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
    """Errors of effort (Pa or V) and flow (m³/s or A) at a probe, and parameters for those of other quantities."""

    u: float
    y: float
    z0: float  # of the line that the probe is on
    per_metre: float  # density·g, Pa/m
    largest_u: float = 0.0  # sizes of effort and flow
    largest_y: float = 0.0


class Quantity(NamedTuple):
    """One quantity of a probe."""

    key: str  # name in Python, arrays and files of arrays
    word: str  # name for people; empty if the medium has one
    unit: str  # SI unit, or "effort" or "flow" for that of the medium
    of: "Callable[[Samples], NDArray]"  # from samples to values
    error: Callable[[Bounds], float]  # from bounds of effort and flow to that of the quantity
    flows: bool = False  # whether it needs a line's flow
    # True: only in scenes with elevations; False: in tables for people only in scenes without
    heights: bool | None = None
    in_tables: bool = True  # False: in files only, not in tables, plots and sweeps

    def named(self, scene: Scene) -> str:
        """Name for people."""
        medium = readable(scene)
        return self.word or (medium.effort if self.unit == "effort" else medium.flow)

    def si(self, scene: Scene) -> str:
        """SI unit."""
        return readable(scene).units.get(self.unit, self.unit)

    def shown(self, scene: Scene) -> str:
        """Unit for people."""
        return readable(scene).shown.get(self.unit, self.unit)

    def written(self, scene: Scene) -> tuple[float, str]:
        """Size and name of the unit in tables in files."""
        return readable(scene).unit(self.unit, written=True)

    def seen_by(self, probe: "ProbeResult") -> bool:
        """Whether a probe has this quantity."""
        return probe.has_flow or not self.flows


QUANTITIES = (
    Quantity("u", "", "effort", lambda seen: seen.u, lambda off: off.u, heights=False),
    Quantity(
        "gauge_pressure", "gauge pressure", "effort", lambda at: at.gauge_pressure, lambda off: off.u, heights=True
    ),
    Quantity("head", "head", "m", lambda seen: seen.head, lambda off: off.u / off.per_metre, heights=True),
    Quantity("y", "", "flow", lambda seen: seen.y, lambda off: off.y, flows=True),
    Quantity("a", "a", "effort", lambda seen: seen.a, lambda off: off.u + off.z0 * off.y, flows=True, in_tables=False),
    Quantity("b", "b", "effort", lambda seen: seen.b, lambda off: off.u + off.z0 * off.y, flows=True, in_tables=False),
)


def quantity(key: str) -> Quantity:
    """Return the quantity with a name in Python."""
    return next(each for each in QUANTITIES if each.key == key)


def in_arrays(scene: Scene) -> list[Quantity]:
    """Quantities of a scene's results, for programs."""
    return [each for each in QUANTITIES if scene.heights or not each.heights]


def in_columns(scene: Scene) -> list[Quantity]:
    """Quantities for people: in a scene with elevations gauge pressure and head replace the effort."""
    return [each for each in QUANTITIES if each.heights in (None, bool(scene.heights))]


def in_tables(scene: Scene) -> list[Quantity]:
    """Quantities for people, without waves."""
    return [each for each in in_columns(scene) if each.in_tables]


def in_sweeps(scene: Scene) -> list[Quantity]:
    """Quantities that sweeps keep at instants."""
    return [each for each in in_arrays(scene) if each.in_tables]
