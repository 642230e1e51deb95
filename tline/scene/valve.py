"""Valves: flow = opening·C·sqrt(pressure drop), in both directions or in one."""

from collections.abc import Sequence
from itertools import pairwise
from math import inf, log10, sqrt
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.element import NAMED, AtNode, Between, Element, Placed, named, optional, pair, required
from tline.scene.factor import ALWAYS, Characterised, Factor
from tline.scene.law import ANY_DROP, Bend, ElementLaw, Governor, LawKind, OfLiquids
from tline.scene.quantity import ZERO, Drop, Length, PositivePressure, Pressure, Quantity, Role
from tline.scene.rating import Rated
from tline.scene.shape import Shape

Kind = Literal["gate", "globe", "ball", "butterfly"]
QUARTER = 90.0  # degrees from open to shut
STEEL = 0.0018 * 0.0254  # m, roughness of the pipe in Crane's equivalent lengths

# K over the share of the stroke, or of the quarter turn, less that of the open valve
ADDED: dict[str, tuple[tuple[float, float], ...]] = {
    "gate": tuple((x, k - 0.17) for x, k in ((0.25, 24.0), (0.5, 4.5), (0.75, 0.9))),
    "globe": tuple((x, k - 9.0) for x, k in ((0.25, 112.0), (0.5, 36.0), (0.75, 13.0))),
    "ball": tuple((1 - a / QUARTER, k) for a, k in ((60, 206.0), (40, 17.3), (20, 1.56), (10, 0.29), (5, 0.05))),
    "butterfly": tuple((1 - a / QUARTER, k) for a, k in ((60, 118.0), (40, 10.8), (20, 1.54), (10, 0.52), (5, 0.24))),
}
DIAMETERS = {"gate": 8.0, "globe": 340.0, "ball": 3.0}  # equivalent length of the open valve in diameters of pipe
BUTTERFLIES = ((0.229, 45.0), (0.381, 35.0), (float("inf"), 25.0))  # equivalent length up to a bore in m
PRESSURE_BEHIND = "has a pressure behind it, which is a source"


def shares(kind: str, loss: float) -> tuple[tuple[float, float], ...]:
    """Share of its capacity that a valve has, over its opening; both from 0 to 1.

    K at an opening is that of the open valve plus the value of the table; between the points of the table the share
    is interpolated linearly.

    References
    ----------
    R. H. Perry, D. W. Green: Perry's Chemical Engineers' Handbook, 7th edition (1997), table 6-4.
    """
    return (0.0, 0.0), *((x, 1 / sqrt(1 + added / loss)) for x, added in ADDED[kind]), (1.0, 1.0)


def open_loss(kind: str, diameter: float) -> float:
    """Coefficient K of an open valve of a bore in m.

    References
    ----------
    Crane Co.: Flow of Fluids through Valves, Fittings and Pipe, Technical Paper 410, appendix A.
    """
    friction = 0.25 / log10(3.7 * diameter / STEEL) ** 2
    lengths = DIAMETERS.get(kind) or next(length for most, length in BUTTERFLIES if diameter <= most)
    return lengths * friction


def opening_of(points: Sequence[tuple[float, float]], share: float) -> float:
    """Opening with that share of the capacity, 0 to 1."""
    for (x, y), (after, above) in pairwise(points):
        if share <= above:
            return x + (after - x) * (share - y) / (above - y)
    return 1.0


Share = Annotated[Quantity, Role("share", "", at_least=0, at_most=1)]


Points = list[Annotated[tuple[Share, Share], pair("opening, share of the capacity")]]
Characteristic = Annotated[Points, named("valve", ADDED, Points | Kind), NAMED]


def rooted(drop: NDArray, capacity: float) -> NDArray:
    """Flow through an orifice."""
    return capacity * np.sign(drop) * np.sqrt(np.abs(drop))


class Root(LawKind):
    """Law of an orifice; constants: effort beyond the element, capacity, whether flow passes one way only."""

    name, unit = "quadratic", "laws.quadratic.quadratic"

    def bends(self, c, rho):  # noqa: D102
        yield Bend(c[0], layer=(rho * c[1] / 2) ** 2 if c[1] < inf else 0.0)

    def holds(self, c, control):  # noqa: D102
        if c[1] * control == 0:
            return ANY_DROP
        return (-inf, c[0]) if c[2] else (0.0, 0.0)

    def tightness(self, c, control, largest):  # noqa: D102
        return sqrt(largest) / (c[1] * control) if c[1] * control > 0 else 0.0

    def source(self, c):  # noqa: D102
        behind = c[0] < 0 or (c[0] > 0 and not c[2])
        return PRESSURE_BEHIND if behind else ""

    def flow(self, c):  # noqa: D102
        _, capacity, one_way = c
        if capacity == inf:
            return None
        return lambda d: rooted(np.maximum(d, 0.0) if one_way else d, capacity)


class Relieving(LawKind):
    """Law of a relief valve; constants: effort beyond, capacity, drop at which it opens, further drop to wide open."""

    name, unit = "relief", "laws.relief.relief"

    def bends(self, c, rho):  # noqa: D102
        yield Bend(c[0] + c[2])
        yield Bend(c[0] + c[2] + c[3], rho * c[1] * sqrt(c[2] + c[3]))

    def holds(self, c, control):  # noqa: D102
        return -inf, c[0] + c[2] if control else inf

    def source(self, c):  # noqa: D102
        return PRESSURE_BEHIND if c[0] + c[2] < 0 else ""

    def flow(self, c):  # noqa: D102
        _, capacity, opens, band = c
        if capacity == inf:
            return None
        return lambda d: rooted(np.maximum(d, 0.0), capacity) * np.clip((d - opens) / band, 0.0, 1.0)


class CharacterisedValve(Rated, OfLiquids):
    """Valve with a share of its capacity at each opening."""

    characteristic: Characteristic | None = optional(
        "points [opening, share of the capacity] with straight lines between, or 'gate', 'globe', 'ball' "
        "or 'butterfly' for what such a valve of that diameter loses on its way; without it both are equal"
    )

    @property
    def _points(self) -> tuple[tuple[float, float], ...]:
        """Openings and shares of the capacity; empty if both are equal."""
        if self.characteristic is None:
            return ()
        if isinstance(self.characteristic, str):
            return shares(self.characteristic, self.loss)
        return tuple((float(x), float(y)) for x, y in self.characteristic)

    @property
    def _may_have_a_bore(self) -> bool:
        return isinstance(self.characteristic, str)

    @model_validator(mode="after")
    def _rises(self):
        points = self.characteristic
        if isinstance(points, str) and self.bore is None:
            raise InputError("diameter", "is missing", f"the bore of the {points} valve")
        if points is None or isinstance(points, str):
            return self
        x = [opening for opening, _ in points]
        if len(x) < 2 or x[0] != 0 or x[-1] != 1 or sorted(set(x)) != x:
            raise InputError("characteristic", "does not cover all openings once", "openings that rise from 0 to 1")
        return self


class Behind(AtNode):
    """Element that leads to the outside."""

    back_pressure: Pressure = optional("gauge pressure on the other side; 0 is the open air", ZERO)


def _behind(element: Element) -> float:
    return float(getattr(element, "back_pressure", 0.0))


class Orifice(CharacterisedValve, Placed, load=Behind):
    """Orifice, minor loss or control valve: flow = share·C·sqrt(drop), in both directions."""

    kind: Literal["orifice"] = "orifice"
    opening: Factor = optional("0 (shut) to 1 (wide open), constant or over time", ALWAYS)
    _share: Characterised | None = PrivateAttr(default=None)

    @property
    def share(self) -> Shape:
        """Share of the capacity over time."""
        if self.characteristic is None:
            return self.opening
        if self._share is None:
            self._share = Characterised.model_construct(opening=self.opening, shares=self._points)
        return self._share

    def law(self) -> ElementLaw:  # noqa: D102
        return ElementLaw("quadratic", (_behind(self), self.capacity or inf, 0.0), self.share)


class WithDisc(Between):
    """Link that may have a disc with a mass."""

    disc_mass: Annotated[Quantity, Role("mass", "kg", above=0)] | None = optional(
        "of all that moves; without it the valve shuts as soon as the flow turns"
    )
    travel: Length | None = optional("of the disc from shut to open; needed with disc_mass")
    open_pressure: Drop | None = optional("drop that holds the disc wide open; cracking_pressure if not given")
    damping: Annotated[Quantity, Role("damping", "N s/m", at_least=0)] | None = optional(
        "force on the disc over its speed; none if not given"
    )


class CheckValve(Rated, OfLiquids, Placed, load=Behind, link=WithDisc):
    """Valve that lets flow pass out of its node, or from the first node to the second, only.

    Without a capacity it has no loss. Between nodes, with a disc_mass, it shuts late, and slams:
    disc_mass·travel·x'' = area·(drop - closing pressure) - damping·travel·x', with x from 0 (shut) to 1, to which the
    capacity is in proportion. The closing pressure rises from the cracking_pressure at x = 0 to the open_pressure at
    x = 1, by a spring or a weight. Of a disc that swings the mass is its moment of inertia over the square of its arm,
    that of the liquid that moves with it included.

    References
    ----------
    A. R. D. Thorley: Fluid Transients in Pipeline Systems, 2nd edition, Professional Engineering Publishing (2004).
    """

    kind: Literal["check valve"] = "check valve"
    cracking_pressure: Drop = optional("drop at which it begins to open", ZERO)

    @property
    def _may_lack_a_loss(self) -> bool:
        return True

    @property
    def _may_have_a_bore(self) -> bool:
        return isinstance(self, WithDisc) and self.disc_mass is not None

    @model_validator(mode="after")
    def _moves(self):
        if not isinstance(self, WithDisc):
            return self
        of_discs = "travel", "open_pressure", "damping"
        given = [key for key in of_discs if getattr(self, key) is not None]
        if self.disc_mass is None:
            if given:
                raise InputError(given[0], "is of a disc that moves", "disc_mass beside it")
            return self
        if self.travel is None:
            raise InputError("travel", "is missing", "that of the disc, with disc_mass")
        if self.capacity is None or self.bore is None:
            raise InputError("diameter", "is missing", "a capacity and the bore, with disc_mass")
        if self.open_pressure is not None and self.open_pressure < self.cracking_pressure:
            got = f"{self.open_pressure:g} Pa"
            raise InputError("open_pressure", "too low", f"at least the {self.cracking_pressure:g} Pa at the seat", got)
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        if not isinstance(self, WithDisc) or self.disc_mass is None or self.travel is None:
            return ElementLaw("quadratic", (self.cracking_pressure + _behind(self), self.capacity or inf, 1.0))
        length_over_area = float(self.travel / (self.bore or inf))
        cracking, opened = float(self.cracking_pressure), float(self.open_pressure or self.cracking_pressure)
        disc = Governor(
            here=(1.0, cracking),
            there=(-1.0, 0.0),
            own=opened - cracking,
            inertia=float(self.disc_mass) * length_over_area,
            damping=float(self.damping or 0.0) * length_over_area,
            area=float(self.bore or 0.0),
        )
        return ElementLaw("quadratic", (0.0, self.capacity or inf, 0.0), governor=disc)


class ReliefValve(Rated, OfLiquids, Placed, load=Behind):
    """Relief valve: shut up to the set pressure, wide open a band above it."""

    kind: Literal["relief valve"] = "relief valve"
    set_pressure: Drop = required("drop at which it begins to open")
    band: PositivePressure = required("further drop over which it opens in proportion, up to its full capacity")

    def law(self) -> ElementLaw:  # noqa: D102
        constants = (_behind(self), self.capacity or inf, float(self.set_pressure), float(self.band))
        return ElementLaw("relief", constants)
