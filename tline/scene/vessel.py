"""Vessels at a node: gas above liquid, enclosed or open to the air."""

from math import inf, pi
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tline.errors import InputError
from tline.scene.cavities import ATMOSPHERE, Boiling
from tline.scene.element import AtNode, optional, required
from tline.scene.law import GAS_VOLUME, Bend, ElementLaw, LawKind, OfLiquids, Shown, Volume
from tline.scene.quantity import (
    GRAVITY,
    ZERO,
    Acceleration,
    Area,
    Diameter,
    PositivePressure,
    PositiveVolume,
    Pressure,
    Quantity,
    Role,
)
from tline.scene.rating import Rated

Height = Annotated[Quantity, Role("height", "m")]


class Gas(LawKind):
    """Law of a gas; constants: effort beyond, orifice's capacity, outside pressure, volume at zero effort, exponent n.

    The state is ln(V / volume at zero effort).
    """

    name, unit = "gas", "stores.gas.gas"
    states = 1
    returns = steep = True

    def at_rest(self, c, effort, control):  # noqa: D102
        above, outside, n = effort - c[0], c[2], c[4]
        if above <= -outside:
            raise InputError("", "no state at rest: the pressure is below vacuum")
        return (float(-np.log1p(above / outside) / n),)

    def capacity(self, c, effort):
        """Capacity, at lower pressures that at pressure 0."""
        back, _, outside, at_zero, n = c
        compressed = 1 + max(effort - back, 0.0) / outside
        return at_zero / (n * outside) * compressed ** (-1 / n - 1)

    def bends(self, c, rho):  # noqa: D102
        if c[1] < inf:  # its flow turns in the orifice
            yield Bend(0.0)

    def volume(self, c):
        """Volume of liquid up to a constant: minus that of the gas."""
        beyond, capacity, outside, at_zero, exponent = c

        def held(p: NDArray) -> NDArray:
            absolute = np.maximum(1.0 + (p - beyond) / outside, 1e-12)
            return -at_zero * absolute ** (-1.0 / exponent)

        return Volume(held, capacity)


class Bladder(Gas):
    """Law of a bladder; constants: those of gas, and the state at which the bladder fills the vessel and shuts it."""

    name, unit = "bladder", "stores.bladder.bladder"
    breaks = True

    def at_rest(self, c, effort, control):  # noqa: D102
        (y,) = super().at_rest(c, effort, control)
        return (min(y, c[5]),)

    def capacity(self, c, effort):  # noqa: D102
        return super().capacity(c[:5], effort)

    def volume(self, c):  # noqa: D102
        gas = super().volume(c[:5])
        return gas._replace(held=lambda p: np.maximum(gas.held(p), -c[3] * np.exp(c[5])))


class Tank(LawKind):
    """Law of a tank; constants: effort beyond, capacity of the orifice, capacitance. State: the effort inside."""

    name, unit = "tank", "stores.tank.tank"
    states = 1
    returns = steep = True

    def at_rest(self, c, effort, control):  # noqa: D102
        return (effort - c[0],)

    def capacity(self, c, effort):  # noqa: D102
        return c[2]

    def bends(self, c, rho):  # noqa: D102
        if c[1] < inf:
            yield Bend(0.0)

    def volume(self, c):  # noqa: D102
        beyond, capacity, per_effort = c
        return Volume(lambda p: per_effort * (p - beyond), capacity)


class Vapour(LawKind):
    """Law of a vapour cavity; constant: effort at which the liquid boils. State: the vapour's volume."""

    name, unit = "vapour", "stores.vapour.vapour"
    states = 1
    breaks = True

    def at_rest(self, c, effort, control):  # noqa: D102
        if effort < c[0]:
            raise InputError("", "no state at rest: the liquid boils")
        return (0.0,)


class _Vessel(Rated, AtNode, OfLiquids):
    @property
    def _may_lack_a_loss(self) -> bool:
        return True


class AirVessel(_Vessel):
    """Air vessel: gas with p·V^n constant, p absolute, behind a loss if its capacity is given."""

    kind: Literal["air vessel"] = "air vessel"
    gas_volume: PositiveVolume = required("volume of the gas")
    gas_pressure: Pressure = required("gauge pressure at which it has that volume")
    exponent: Annotated[Quantity, Role("exponent", "", at_least=1, at_most=2)] = optional(
        "n: 1 if the gas stays at one temperature, 1.4 if it has no time to", Quantity("1.2", "")
    )
    atmosphere: PositivePressure = optional("absolute pressure of the air outside", ATMOSPHERE)
    total_volume: PositiveVolume | None = optional(
        "of gas and liquid; a run says when the gas fills it, and would enter the pipe"
    )
    bladder: bool = optional("whether a bladder holds the gas, and shuts the vessel once it fills it", False)
    shows = (
        Shown(GAS_VOLUME, "m^3", lambda vessel, y, i: vessel.law().constants[3] * np.exp(y)),
        Shown("gas pressure", "Pa", lambda vessel, y, i: vessel.atmosphere * np.expm1(-vessel.exponent * y)),
        Shown("inflow", "m^3/s", lambda vessel, y, i: i),
    )

    @model_validator(mode="after")
    def _has_gas(self):
        if self.gas_pressure <= -self.atmosphere:
            got = f"{self.gas_pressure:g} Pa"
            raise InputError("gas_pressure", "below vacuum", f"more than {-self.atmosphere:g} Pa", got)
        if self.total_volume is not None and self.total_volume <= self.gas_volume:
            got = f"{self.total_volume:g} m^3"
            raise InputError("total_volume", "no room for liquid", f"more than the gas, {self.gas_volume:g} m^3", got)
        if self.bladder and self.total_volume is None:
            raise InputError("total_volume", "is missing", "the volume that the bladder may fill")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        n, outside = float(self.exponent), float(self.atmosphere)
        at_zero = self.gas_volume * ((self.gas_pressure + outside) / outside) ** (1 / n)
        constants = 0.0, self.capacity or inf, outside, at_zero, n
        if self.bladder:
            return ElementLaw("bladder", (*constants, float(np.log(float(self.total_volume or inf) / at_zero))))
        return ElementLaw("gas", constants)


class _BoilingAtNode(Boiling, AtNode, OfLiquids):
    back_pressure: Pressure = optional("gauge pressure outside; 0 is the open air", ZERO)


class Cavity(_BoilingAtNode):
    """Column separation at a node: free gas at one temperature and vapour (DGCM).

    (p - vapour pressure)·V is constant, p absolute.

    References
    ----------
    E. B. Wylie: Simulation of vaporous and gaseous cavitation. J. Fluids Eng. 106 (1984) 307-311,
    doi:10.1115/1.3243120.
    """

    kind: Literal["cavity"] = "cavity"
    gas_volume: PositiveVolume = required(
        "volume of the free gas at the atmosphere's pressure: often 1e-7 of the liquid's nearby"
    )
    shows = (Shown("cavity", "m^3", lambda cavity, y, i: cavity.gas_volume * np.exp(y)),)

    def law(self) -> ElementLaw:  # noqa: D102
        above_vapour, back = float(self.atmosphere - self.vapour_pressure), float(self.back_pressure)
        return ElementLaw("gas", (back, inf, above_vapour, float(self.gas_volume), 1.0))


class VapourCavity(_BoilingAtNode):
    """Column separation at a node: vapour alone, at vapour pressure while there is any (DVCM).

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapter 8.
    A. Bergant, A. R. Simpson, A. S. Tijsseling: Water hammer with column separation. J. Fluids Struct. 22 (2006)
    135-171, doi:10.1016/j.jfluidstructs.2005.08.008.
    """

    kind: Literal["vapour cavity"] = "vapour cavity"
    shows = (Shown("cavity", "m^3", lambda cavity, y, i: y),)

    def law(self) -> ElementLaw:  # noqa: D102
        return ElementLaw("vapour", (float(self.vapour_pressure - self.atmosphere + self.back_pressure),))


class SurgeTank(_Vessel):
    """Tank open to the air; its level above the node is p/(density·gravity), p the gauge pressure there.

    It starts at the level of the steady state; a level given is held at the start, after which the tank fills or
    empties. It has no rim and no bottom: the notes of a run report overflow and emptiness.
    """

    kind: Literal["surge tank"] = "surge tank"
    tank_diameter: Diameter | None = optional("inner diameter of the tank")
    tank_area: Area | None = optional("surface of the liquid")
    gravity: Acceleration = optional("of the earth", Quantity(GRAVITY, "m/s^2"))
    level: Height | None = optional("of the surface above the node at a steady start")
    lowest_level: Height | None = optional("above the node, at which it is empty")
    highest_level: Height | None = optional("above the node, at which it overflows")
    shows = (
        Shown("level", "m", lambda tank, y, i: y / tank.weight),
        Shown("inflow", "m^3/s", lambda tank, y, i: i),
    )

    @property
    def start(self) -> float | None:
        """Gauge pressure at the node at the start, Pa; None if that follows from the state at rest."""
        return None if self.level is None else self.weight * self.level

    @property
    def mistake_at_rest(self) -> InputError | None:
        """Mistake if the run starts at rest, not in a steady state."""
        return None if self.level is None else InputError("level", "is that of a steady start", "start = 'steady'")

    @property
    def weight(self) -> float:
        """Pressure per metre of liquid, Pa/m."""
        return float(self.density * self.gravity)

    @model_validator(mode="after")
    def _is_within(self):
        low, high = self.lowest_level, self.highest_level
        if low is not None and high is not None and low >= high:
            raise InputError("highest_level", "too low", f"more than the lowest, {low:g} m", f"{high:g} m")
        if self.level is not None and not (-inf if low is None else low) <= self.level <= (
            inf if high is None else high
        ):
            raise InputError("level", "out of range", "from lowest_level to highest_level", f"{self.level:g} m")
        if self.level is not None and self.capacity is not None:
            raise InputError("level", "cannot be held behind a loss", "no capacity of an inlet beside it")
        return self

    @model_validator(mode="after")
    def _has_a_surface(self):
        if (self.tank_diameter is None) == (self.tank_area is None):
            raise InputError("", "its surface is not given once", "either tank_diameter or tank_area")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        area = pi / 4 * self.tank_diameter**2 if self.tank_diameter is not None else (self.tank_area or ZERO)
        return ElementLaw("tank", (0.0, self.capacity or inf, float(area / (self.density * self.gravity))))
