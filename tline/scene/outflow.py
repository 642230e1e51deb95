"""Outflows that depend on the pressure: leaks and demands."""

from math import inf
from typing import Annotated, Literal

import numpy as np
from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import AtNode, optional, required
from tline.scene.factor import ALWAYS, Factor
from tline.scene.law import Bend, ElementLaw, LawKind, OfLiquids
from tline.scene.quantity import ZERO, PositiveFlow, PositivePressure, Pressure, Quantity, Role

Exponent = Annotated[Quantity, Role("exponent", "", at_least=0.1, at_most=4)]
SOME = Quantity("0.5", "")


class Leaking(LawKind):
    """Law of a leak; constants: effort beyond, flow at a pressure, that pressure, exponent, pressure of most flow."""

    name, unit = "leak", "laws.outflow.outflow"
    steep = True  # behind an impedance its flow has no Taylor series where it begins

    def bends(self, c, rho):  # noqa: D102
        yield Bend(c[0])
        if c[4] < inf:
            yield Bend(c[0] + c[4], rho * c[1])

    def holds(self, c, control):  # noqa: D102
        return -inf, c[0] if control else inf

    def flow(self, c):  # noqa: D102
        _, flow, pressure, exponent, most = c
        return lambda d: flow * (np.clip(d, 0.0, most) / pressure) ** exponent


class Demanded(Leaking):
    """Law of a demand, with the constants of a leak; at its pressure it is met in full."""

    name, control = "demand", "pattern"


class Leak(AtNode, OfLiquids):
    """Leak to the open air: flow·(gauge pressure/reference pressure)^exponent out of the node, no inflow."""

    kind: Literal["leak"] = "leak"
    flow: PositiveFlow = required("flow at the reference pressure")
    pressure: PositivePressure = required("reference gauge pressure")
    exponent: Exponent = optional("0.5 for a hole in a stiff wall", SOME)
    opening: Factor = optional("factor of the flow, constant or over time: 0 before it bursts", ALWAYS)

    def law(self) -> ElementLaw:  # noqa: D102
        constants = 0.0, float(self.flow), float(self.pressure), float(self.exponent), inf
        return ElementLaw("leak", constants, self.opening)


class Demand(AtNode, OfLiquids):
    """Demand that is met in full above the required pressure, in part down to the least, and not below.

    The share met is ((p - least)/(required - least))^exponent, p the gauge pressure.

    References
    ----------
    J. M. Wagner, U. Shamir, D. H. Marks: Water distribution reliability: simulation methods. J. Water Resour. Plann.
    Manage. 114 (1988) 276-294, doi:10.1061/(ASCE)0733-9496(1988)114:3(276).
    """

    kind: Literal["demand"] = "demand"
    flow: PositiveFlow = required("flow that is asked for")
    required_pressure: Pressure = required("gauge pressure from which it is met")
    least_pressure: Pressure = optional("gauge pressure below which nothing comes", ZERO)
    exponent: Exponent = optional("of the share met", SOME)
    pattern: Factor = optional("factor of the flow, constant or over time", ALWAYS)

    @model_validator(mode="after")
    def _rises(self):
        if self.required_pressure <= self.least_pressure:
            got, expected = f"{self.required_pressure:g} Pa", f"more than the least, {self.least_pressure:g} Pa"
            raise InputError("required_pressure", "too low", expected, got)
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        band = float(self.required_pressure - self.least_pressure)
        constants = float(self.least_pressure), float(self.flow), band, float(self.exponent), band
        return ElementLaw("demand", constants, self.pattern)
