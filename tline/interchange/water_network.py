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
    """A node where pipes meet.

    Parameters
    ----------
    elevation, head : float
        m
    position : pair of float
        Coordinates on a map, in whatever unit this has.
    demand : float
        Flow drawn, m³/s, without that of the emitter; negative where something flows in.
    emitter : float
        Flow of the emitter over (pressure head in m)^exponent.
    """

    elevation: float
    head: float
    position: Position
    demand: float
    emitter: float


@dataclass(frozen=True)
class Basin:
    """A reservoir, or a tank at its level.

    Parameters
    ----------
    kind : str
        "reservoir" or "tank"
    elevation, head : float
        Of its bottom, or of the water for a reservoir; and of the water; m.
    position : pair of float
        Coordinates on a map.
    diameter : float
        Of a tank with upright walls; else 0; m.
    lowest, highest : float
        Levels between which a tank is used, m above its bottom.
    """

    kind: str
    elevation: float
    head: float
    position: Position
    diameter: float = 0.0
    lowest: float = 0.0
    highest: float = 0.0


@dataclass(frozen=True)
class Friction:
    """What a pipe loses.

    Parameters
    ----------
    formula : str
        H-W, D-W or C-M: Hazen and Williams, Darcy and Weisbach, Chezy and Manning.
    roughness : float
        C, the height of the roughness in m, or Manning's n.
    length : float
        Over which it acts, m.
    minor : float
        K of local losses.
    """

    formula: str
    roughness: float
    length: float
    minor: float


@dataclass(frozen=True)
class Pipe:
    """A pipe.

    Parameters
    ----------
    nodes : pair of str
    length, diameter : float
        m
    flow : float
        From the first node to the second, m³/s.
    friction : Friction
        What it loses.
    one_way : bool
        Whether a check valve lets water through toward the second node alone.
    vertices : tuple of pair of float
        Places on the map between its nodes.
    """

    nodes: tuple[str, str]
    length: float
    diameter: float
    flow: float
    friction: Friction
    one_way: bool
    vertices: tuple[Position, ...]


@dataclass(frozen=True)
class WaterPump:
    """A pump that runs.

    Parameters
    ----------
    nodes : pair of str
        Suction, delivery.
    curve : PowerLaw, Polyline or None
        Head over flow at rated speed; None if the power is given.
    power : float or None
        Of the water, W.
    speed : float
        Relative to the rated one.
    flow : float
        m³/s
    """

    nodes: tuple[str, str]
    curve: PowerLaw | Polyline | None
    power: float | None
    speed: float
    flow: float


@dataclass(frozen=True)
class Valve:
    """A valve.

    Parameters
    ----------
    nodes : pair of str
    kind : str
        PRV, PSV, PBV, FCV, TCV or GPV.
    diameter : float
        m
    flow : float
        m³/s; none where it is shut.
    drop : float
        Head lost from the first node to the second, m.
    active : bool
        Whether it keeps the pressure or the flow that it is set to.
    """

    nodes: tuple[str, str]
    kind: str
    diameter: float
    flow: float
    drop: float
    active: bool = False


@dataclass(frozen=True)
class WaterNetwork:
    """All that is open at an instant, and notes on what is not.

    Parameters
    ----------
    title : str
    density : float
        kg/m³
    viscosity : float
        Kinematic, m²/s.
    exponent : float
        Of all emitters.
    junctions, basins, pipes, pumps, valves : mapping
        By name; nodes and links each have names of their own.
    sound : bool
        Whether flows balance at all nodes, and no demand was left out.
    notes : tuple of str
        What was left out, and what is held.
    controls : tuple of WaterControl
        What the file has done after the operating point.
    """

    title: str
    density: float
    viscosity: float
    exponent: float
    junctions: Mapping[str, WaterJunction]
    basins: Mapping[str, Basin]
    pipes: Mapping[str, Pipe]
    pumps: Mapping[str, WaterPump]
    valves: Mapping[str, Valve]
    sound: bool
    notes: tuple[str, ...]
    controls: tuple[WaterControl, ...] = ()

    @property
    def nodes(self) -> dict[str, WaterJunction | Basin]:
        """All nodes."""
        return {**self.junctions, **self.basins}
