"""Open tanks of finite height, which run dry at the bottom and overflow at the rim."""

from math import inf, sqrt
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import AtNode, optional, required
from tline.scene.law import Bend, ElementLaw, LawKind, OfLiquids, Shown
from tline.scene.quantity import GRAVITY, Acceleration, Area, Density, Quantity, Role
from tline.scene.rating import WATER
from tline.scene.vessel import Height

Loss = Annotated[Quantity, Role("loss coefficient", "", at_least=0)]


class Ended(LawKind):
    """Law of an open tank; constants: effort beyond, capacities of the loss inwards and outwards, capacitance, efforts
    at the bottom, at the rim and before the run (nan if the state at rest determines it). State: the effort inside.
    """

    name, unit = "open tank", "stores.open_tank.open_tank"
    states = 1
    returns = steep = breaks = True

    def at_rest(self, c, effort, control):  # noqa: D102
        return (float(np.clip(effort - c[0] if np.isnan(c[6]) else c[6], c[4], c[5])),)

    def capacity(self, c, effort):
        """Capacity between bottom and rim."""
        return c[3]

    def bends(self, c, rho):
        """Kink where the flow changes its sign."""
        if min(c[1], c[2]) < inf:
            yield Bend(0.0)


class OpenTank(AtNode, OfLiquids):
    """Open tank that overflows at its rim and runs dry at its bottom.

    Liquid passes its connection with a loss for each direction, as through a differential orifice; a one-way tank has
    no inflow. Inflow beyond the rim is spilled, without a rise of the level. An empty tank supplies nothing: the air
    that would enter the pipe is not computed. Levels are above the node.
    """

    kind: Literal["open tank"] = "open tank"
    tank_area: Area = required("surface of the liquid")
    level: Height | None = optional("of the surface before the run; if not given, that at which nothing flows")
    lowest_level: Height = optional("of the bottom", Quantity("0 m", "m"))
    highest_level: Annotated[Quantity, Role("height", "m", at_least=0)] | None = optional(
        "of the rim; without it none is reached"
    )
    bore: Area | None = optional("section of the connection, which losses refer to")
    loss_in: Loss = optional("K of the connection where it fills", Quantity(0, ""))
    loss_out: Loss = optional("K of the connection where it empties", Quantity(0, ""))
    one_way: bool = optional("whether a check valve lets nothing in", False)
    density: Density = optional("of the liquid", Quantity(WATER, "kg/m^3"))
    gravity: Acceleration = optional("of the earth", Quantity(GRAVITY, "m/s^2"))
    shows = (
        Shown("level", "m", lambda tank, y, i: y / tank.weight),
        Shown("inflow", "m^3/s", lambda tank, y, i: i),
        Shown("overflow", "m^3/s", lambda tank, y, i: np.where(y >= tank.weight * tank.rim, np.maximum(i, 0.0), 0.0)),
    )
    example: ClassVar[str] = """\
kind = "open tank"
tank_area = 3.0           # m^2
level = "4 m"
highest_level = "5 m"
bore = "0.07 m^2"
loss_in = 2.5
loss_out = 1.0
"""

    @property
    def weight(self) -> float:
        """Pressure per metre of liquid, Pa/m."""
        return float(self.density * self.gravity)

    @property
    def rim(self) -> float:
        """Level at which the tank overflows, m."""
        return inf if self.highest_level is None else float(self.highest_level)

    @model_validator(mode="after")
    def _is_within(self):
        if self.lowest_level >= self.rim:
            got = f"{self.rim:g} m"
            raise InputError("highest_level", "too low", f"more than the lowest, {self.lowest_level:g} m", got)
        if self.level is not None and not self.lowest_level <= self.level <= self.rim:
            raise InputError("level", "out of range", "from lowest_level to highest_level", f"{self.level:g} m")
        if self.bore is None and (self.loss_in or self.loss_out):
            raise InputError("bore", "is missing", "the section that loss_in and loss_out refer to")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        both = (
            float(self.bore) * sqrt(2 / (loss * self.density)) if self.bore is not None and loss else inf
            for loss in (self.loss_in, self.loss_out)
        )
        inwards, outwards = both
        start = np.nan if self.level is None else self.weight * float(self.level)
        low, high = self.weight * float(self.lowest_level), self.weight * self.rim
        per_effort = float(self.tank_area) / self.weight
        return ElementLaw("open tank", (0.0, 0.0 if self.one_way else inwards, outwards, per_effort, low, high, start))
