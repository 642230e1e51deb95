"""A water network at its operating point, as programs for steady flow know it; in SI, with heads in metres."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from tline.interchange.pump_curve import Polyline, PowerLaw
from tline.interchange.water_controls import WaterControl

Position = tuple[float, float]
STILL = 1e-9  # m³/s; a demand below it is none
TRICKLE = 1e-6  # m³/s; what EPANET lets pass a valve that holds tight, or into a part that takes nothing
LEAST_DROP = 1e-3  # m; less is none
WIDE_OPEN = 1e-7  # m, lost in a valve of which a file says that it loses nothing
LISTED = 6


def listed(names: Collection[str]) -> str:
    """Names for a note: the first ones in their order, and how many more there are.

    Examples
    --------
    >>> listed({"b", "a"})
    "'a', 'b'"
    """
    return ", ".join(map(repr, sorted(names)[:LISTED])) + f" and {len(names) - LISTED} more" * (len(names) > LISTED)


@dataclass(frozen=True)
class WaterJunction:
    """A node where pipes meet."""

    elevation: float  # elevation, head: m
    head: float
    position: Position  # coordinates on a map, in whatever unit this has
    demand: float  # flow drawn, m³/s, without that of the emitter; negative where something flows in
    emitter: float  # flow of the emitter over (pressure head in m)^exponent


@dataclass(frozen=True)
class Basin:
    """A reservoir, or a tank at its level."""

    kind: str  # "reservoir" or "tank"
    elevation: float  # elevation, head: of its bottom, or of the water for a reservoir; and of the water; m
    head: float
    position: Position  # coordinates on a map
    diameter: float = 0.0  # of a tank with upright walls; else 0; m
    lowest: float = 0.0  # lowest, highest: levels between which a tank is used, m above its bottom
    highest: float = 0.0


@dataclass(frozen=True)
class Friction:
    """What a pipe loses."""

    formula: str  # H-W, D-W or C-M: Hazen and Williams, Darcy and Weisbach, Chezy and Manning
    roughness: float  # C, the height of the roughness in m, or Manning's n
    length: float  # over which it acts, m
    minor: float  # K of local losses


@dataclass(frozen=True)
class Pipe:
    """A pipe."""

    nodes: tuple[str, str]
    length: float  # length, diameter: m
    diameter: float
    flow: float  # from the first node to the second, m³/s
    friction: Friction  # what it loses
    one_way: bool  # whether a check valve lets water through toward the second node alone
    vertices: tuple[Position, ...]  # places on the map between its nodes


@dataclass(frozen=True)
class WaterPump:
    """A pump that runs."""

    nodes: tuple[str, str]  # suction, delivery
    curve: PowerLaw | Polyline | None  # head over flow at rated speed; None if the power is given
    power: float | None  # of the water, W
    speed: float  # relative to the rated one
    flow: float  # m³/s


@dataclass(frozen=True)
class Valve:
    """A valve."""

    nodes: tuple[str, str]
    kind: str  # PRV, PSV, PBV, FCV, TCV or GPV
    diameter: float  # m
    flow: float  # m³/s; none where it is shut
    drop: float  # head lost from the first node to the second, m
    active: bool = False  # whether it keeps the pressure or the flow that it is set to


@dataclass(frozen=True)
class WaterNetwork:
    """All that is open at an instant, and notes on what is not."""

    title: str
    density: float  # kg/m³
    viscosity: float  # kinematic, m²/s
    exponent: float  # of all emitters
    # junctions, basins, pipes, pumps, valves: by name; nodes and links each have names of their own
    junctions: Mapping[str, WaterJunction]
    basins: Mapping[str, Basin]
    pipes: Mapping[str, Pipe]
    pumps: Mapping[str, WaterPump]
    valves: Mapping[str, Valve]
    sound: bool  # whether flows balance at all nodes, and no demand was left out
    notes: tuple[str, ...]  # what was left out, and what is held
    units: str = "SI"  # those of the file, as scenes name them
    controls: tuple[WaterControl, ...] = ()  # what the file has done after the operating point

    @property
    def nodes(self) -> dict[str, WaterJunction | Basin]:
        """All nodes."""
        return {**self.junctions, **self.basins}
