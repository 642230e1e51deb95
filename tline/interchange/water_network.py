"""A water network at its operating point, as programs for steady flow know it; in SI, with heads in metres."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.water_controls import WaterControl
from tline.scene.friction import FOOT
from tline.scene.heights import GRAVITY
from tline.words.wording import first_of

SQUARE, STEPS = 2.0, 10  # parts of other power laws
AT_OPERATING_POINT = 0.25  # of a step: closer to the operating point than that no other is needed
Points = list[tuple[float, float]]
STILL = 1e-9  # m³/s; a demand below it is none
TRICKLE = 1e-6  # m³/s; what EPANET lets pass a valve that holds tight, or into a part that takes nothing
LEAST_DROP = 1e-3  # m; less is none
WIDE_OPEN = 1e-7  # m, lost in a valve of which a file says that it loses nothing
LISTED = 6
EPANETS = 32.2 * FOOT  # m/s², its g
MANNING = 1.49**2 * FOOT ** (2 - 1.333)  # of its formula in m and s: n²·v²/(this·R^1.333)


@dataclass(frozen=True)
class PowerLaw:
    """head = a - b·flow^c, in m and m³/s."""

    a: float
    b: float
    c: float

    def head(self, flow: float) -> float:
        """Head, m."""
        return self.a - self.b * flow**self.c

    @property
    def last(self) -> float:
        """Flow without head, m³/s."""
        return (self.a / self.b) ** (1 / self.c)

    def points(self, at: float) -> Points:
        """Points (flow, head), the one at a flow among them; two of a square law."""
        if self.c == SQUARE:
            return [(0.0, self.a), (self.last, 0.0)]
        step = max(self.last, 1.2 * at) / STEPS
        flows = {k * step for k in range(STEPS + 1) if abs(k * step - at) > AT_OPERATING_POINT * step} | {at}
        return [(flow, self.head(flow)) for flow in sorted(flows)]


@dataclass(frozen=True)
class Polyline:
    """Straight lines between points of rising flow, m³/s, and falling head, m; the outer ones go on."""

    flows: tuple[float, ...]
    heads: tuple[float, ...]

    def head(self, flow: float) -> float:
        """Head, m."""
        k = int(np.clip(np.searchsorted(self.flows, flow) - 1, 0, len(self.flows) - 2))
        slope = (self.heads[k + 1] - self.heads[k]) / (self.flows[k + 1] - self.flows[k])
        return self.heads[k] + slope * (flow - self.flows[k])

    @property
    def last(self) -> float:
        """Largest flow, m³/s."""
        return self.flows[-1]

    def points(self, at: float) -> Points:
        """Points (flow, head): those of the curve, rest, middles between them, and the one at a flow."""
        own = sorted({0.0, *self.flows, max(self.last, 1.2 * at)})
        inner = [(one + two) / 2 for one, two in pairwise(own)]
        least = AT_OPERATING_POINT * min(two - one for one, two in pairwise(own))
        flows = {flow for flow in (*own, *inner) if abs(flow - at) > least} | {at}
        return [(flow, self.head(flow)) for flow in sorted(flows)]


def pump_curve(points: Sequence[tuple[float, float]]) -> PowerLaw | Polyline:
    """The curve through points (flow, head) in m³/s and m.

    One point (q, h) gives the law 4/3·h - h/3·(flow/q)²; three, the first without flow, give a - b·flow^c;
    others are joined by straight lines.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1, pumps.
    """
    points = sorted((float(q), float(h)) for q, h in points)
    flows, heads = tuple(q for q, _ in points), tuple(h for _, h in points)
    level = [one for one, two in pairwise(points) if two[0] <= one[0] or two[1] >= one[1]]
    if not points or level or flows[0] < 0 or heads[-1] < 0 or points == [(0.0, heads[0])]:
        got = ", ".join(f"({q:g}, {h:g})" for q, h in points[:8]) or "no points"
        raise InputError("", "its curve does not fall", "heads that fall as the flow rises", got)
    if len(points) == 1:
        q, h = points[0]
        return PowerLaw(4 / 3 * h, h / 3 / q**2, SQUARE)
    if len(points) == 3 and flows[0] == 0:
        a, one, two = heads
        c = log((a - two) / (a - one)) / log(flows[2] / flows[1])
        return PowerLaw(a, (a - one) / flows[1] ** c, c)
    return Polyline(flows, heads)


Position = tuple[float, float]
Travel = tuple[tuple[float, float], ...]  # openings and shares of the capacity, both from 0 to 1


def listed(names: Collection[str]) -> str:
    """Names for a note: the first ones in their order, and how many more there are.

    Examples
    --------
    >>> listed({"b", "a"})
    "'a', 'b'"
    """
    return first_of([*map(repr, sorted(names))], LISTED)


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
    """Head loss of a pipe."""

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
    friction: Friction  # its head loss
    one_way: bool  # whether a check valve lets water through toward the second node alone
    vertices: tuple[Position, ...]  # places on the map between its nodes
    shut: bool = False  # whether it is closed, and to be opened


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
    loss: float = 0.0  # loss, share, travel, of a positional valve: K wide open, and how far it is open
    share: float = 1.0
    travel: Travel = ()


@dataclass(frozen=True)
class WaterNetwork:
    """Open elements at an instant, and notes on those that are closed."""

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
    notes: tuple[str, ...]  # on omissions, and on levels that are held
    units: str = "SI"  # those of the file, as scenes name them
    controls: tuple[WaterControl, ...] = ()  # what the file has done after the operating point

    @property
    def nodes(self) -> dict[str, WaterJunction | Basin]:
        """All nodes."""
        return {**self.junctions, **self.basins}


def friction_of(pipe: Pipe, density: float, viscosity: float) -> dict[str, Any]:
    """The table of friction of a pipe, which loses the same head at any flow; kg/m³ and, kinematic, m²/s.

    Where EPANET's constants are not those of the scene, friction acts over a slightly different length.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1.
    """
    friction, ratio = pipe.friction, GRAVITY / EPANETS
    if friction.formula == "H-W":
        table, along = {"kind": "hazen-williams", "coefficient": friction.roughness}, 1.0
    elif friction.formula == "C-M":
        table = {"kind": "manning", "coefficient": friction.roughness}
        along = (pipe.diameter / 4) ** (4 / 3 - 1.333) / MANNING
    else:
        table = {"kind": "swamee-jain", "roughness": friction.roughness, "viscosity": density * viscosity}
        along = ratio
    if along * friction.length != pipe.length:
        table["length"] = along * friction.length
    return table | ({"minor_loss": ratio * friction.minor} if friction.minor else {})
