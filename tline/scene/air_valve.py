"""Air valves: they admit air below atmospheric pressure and release it above."""

from math import inf, pi, sqrt
from typing import Annotated, Literal

import numpy as np
from pydantic import model_validator

from tline.errors import InputError
from tline.scene.cavities import ATMOSPHERE
from tline.scene.element import AtNode, optional, required
from tline.scene.law import AIR_VOLUME, ElementLaw, LawKind, OfLiquids, Shown
from tline.scene.quantity import (
    ZERO,
    Density,
    Diameter,
    Duration,
    PositivePressure,
    Pressure,
    Quantity,
    Role,
    Temperature,
)
from tline.scene.rating import WATER

GAS_CONSTANT = 287.05  # of air, J/(kg K)


class Air(LawKind):
    """Law of an air valve; constants: effort outside, pressure outside, areas of inlet, outlet and smaller outlet times
    speed, excess pressure from which the smaller one is open, closing rate of the outlet, and its capacity for liquid.
    States: the volume of the air, the volume it would have outside, and the opening of a slow outlet."""

    name, unit = "air", "stores.air.air"
    states = 3
    breaks = True

    def at_rest(self, c, effort, control):  # noqa: D102
        if effort < c[0]:
            raise InputError("", "no state at rest: it draws air")
        return 0.0, 0.0, 0.0


class AirValve(AtNode, OfLiquids):
    """An air valve: air comes in below the outside pressure and leaves above it; without air the valve is shut.

    Without an outlet it is a vacuum breaker. With a third stage (non-slam) air leaves through a smaller orifice where
    its pressure is above one that switches, within half of that. With a closing time the outlet shuts evenly from when
    air first leaves it, and lets liquid out as far as it is open when the air is gone; else liquid never passes. The
    air keeps its temperature, so that p·V is in proportion to its mass; it passes orifices without heat and chokes.

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), on air-inlet valves.
    """

    kind: Literal["air valve"] = "air valve"
    inlet_diameter: Diameter = required("of the orifice through which air comes in")
    outlet_diameter: Annotated[Quantity, Role("diameter", "m", at_least=0)] = required(
        "of the orifice through which it leaves, often smaller; 0 for a vacuum breaker"
    )
    switch_pressure: PositivePressure | None = optional(
        "above the pressure outside, from which the third stage shuts the outlet"
    )
    switched_diameter: Diameter | None = optional("of the orifice through which air leaves then")
    closing_time: Duration | None = optional("in which the outlet shuts; without it as soon as the air is gone")
    density: Density = optional("of the liquid that then leaves", Quantity(WATER, "kg/m^3"))
    discharge_coefficient: Annotated[Quantity, Role("coefficient", "", above=0, at_most=1)] = optional(
        "of both", Quantity(0.6, "")
    )
    temperature: Temperature = optional("of the air", Quantity("20 degC", "K"))
    atmosphere: PositivePressure = optional("absolute pressure of the air outside", ATMOSPHERE)
    back_pressure: Pressure = optional("gauge pressure outside; 0 is the open air", ZERO)

    shows = (
        Shown(AIR_VOLUME, "m^3", lambda valve, y, i: y),
        Shown("opening", "", lambda valve, y, i: valve.closing_time and np.minimum(y, 1.0), last=True),
    )

    @model_validator(mode="after")
    def _has_all_of_a_stage(self):
        if (self.switch_pressure is None) != (self.switched_diameter is None):
            raise InputError("switch_pressure", "half a third stage", "switch_pressure and switched_diameter together")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        speed = sqrt(GAS_CONSTANT * self.temperature)
        both = self.outlet_diameter, self.switched_diameter or self.outlet_diameter
        areas = [float(self.discharge_coefficient * pi / 4 * d**2 * speed) for d in (self.inlet_diameter, *both)]
        switch = inf if self.switch_pressure is None else float(self.switch_pressure / self.atmosphere)
        rate = 0.0 if self.closing_time is None else float(1 / self.closing_time)
        liquid = areas[1] / speed * sqrt(2 / self.density)
        return ElementLaw("air", (float(self.back_pressure), float(self.atmosphere), *areas, switch, rate, liquid))
