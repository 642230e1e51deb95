"""Regulating valves: self-acting valves that maintain a pressure or a flow."""

from math import inf, nan
from typing import Literal

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import Between, optional, required
from tline.scene.law import ElementLaw, Governor
from tline.scene.quantity import Duration, PositiveFlow, PositivePressure, Pressure, Quantity
from tline.scene.valve import CharacterisedValve, Share

ONE_WAY = {"downstream", "upstream"}


class RegulatingValve(CharacterisedValve, Between):
    """Self-acting valve: pressure reducing, pressure sustaining, flow control, or float valve.

    The opening x moves at a rate (set - value)/(band·time_constant) for a flow or the pressure downstream, and with the
    opposite sign for the pressure upstream. In a float valve, with the tank downstream, x moves towards
    (set - value)/band, within 0 and 1: it is shut at the set pressure, and wide open a band below.

    References
    ----------
    S. L. Prescott, B. Ulanicki: Dynamic modeling of pressure reducing valves, J. Hydraul. Eng. 129 (2003) 804-812,
    doi:10.1061/(ASCE)0733-9429(2003)129:10(804), whose valves move at a rate in proportion to the error.
    """

    kind: Literal["regulating valve"] = "regulating valve"
    keeps: Literal["downstream", "upstream", "flow", "level"] = required(
        "the pressure at its second node or at its first one, the flow, or the level behind it as a float"
    )
    set_pressure: Pressure | None = optional("gauge pressure that it keeps; that of the steady start if not given")
    set_flow: PositiveFlow | None = optional("flow that it keeps; that of the steady start if not given")
    band: PositivePressure = optional(
        "error of a pressure at which it would open fully in a time constant; depth of a float's stroke",
        Quantity("1 bar", "Pa"),
    )
    flow_band: PositiveFlow | None = optional("the same of a flow; set_flow if not given")
    time_constant: Duration = optional("of its motion", Quantity("5 s", "s"))
    stroke_time: Duration | None = optional("the least time from shut to open")
    opening: Share | None = optional(
        "at the start; if not given, the one at which nothing moves, or 1 if all is at rest"
    )

    @property
    def has_set(self) -> bool:
        """Whether the set value is given."""
        return (self.set_flow if self.keeps == "flow" else self.set_pressure) is not None

    @property
    def mistake_at_rest(self) -> InputError | None:
        """Mistake if the run starts at rest, not in a steady state."""
        key = "set_flow" if self.keeps == "flow" else "set_pressure"
        return None if self.has_set else InputError(key, "is missing", "a value, or start = 'steady'")

    @model_validator(mode="after")
    def _keeps_one(self):
        other = "set_pressure" if self.keeps == "flow" else "set_flow"
        if getattr(self, other) is not None:
            raise InputError(other, "is not what it keeps", f"none with keeps = '{self.keeps}'")
        if self.keeps != "flow" and self.flow_band is not None:
            raise InputError("flow_band", "is for a flow", f"band with keeps = '{self.keeps}'")
        if self.keeps == "flow" and self.set_flow is None and self.flow_band is None:
            raise InputError("flow_band", "is missing", "it, or set_flow")
        if not self.has_set and self.opening is None:
            raise InputError("opening", "is missing", "a set value, or the opening that the start has")
        if self.keeps == "level" and self.set_pressure is None:
            raise InputError("set_pressure", "is missing", "the pressure at the tank's node at which it is shut")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        way = float(self.keeps in ONE_WAY)
        return ElementLaw("quadratic", (0.0, self.capacity or inf, way), governor=self._governor())

    def _governor(self) -> Governor:
        T, fastest = float(self.time_constant), 1 / self.stroke_time if self.stroke_time is not None else inf
        start = None if self.opening is None else float(self.opening)
        governor = Governor(rates=(-fastest, fastest), shares=self._points, start=start)
        if self.keeps == "flow":
            flow = nan if self.set_flow is None else float(self.set_flow)
            return governor._replace(through=(-1 / (float(self.flow_band or flow) * T), flow))
        pressure, gain = nan if self.set_pressure is None else float(self.set_pressure), 1 / (float(self.band) * T)
        if self.keeps == "upstream":
            return governor._replace(here=(gain, pressure))
        return governor._replace(there=(-gain, pressure), own=1 / T if self.keeps == "level" else 0.0)
