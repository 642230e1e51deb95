"""Capacity of a valve or orifice, in the forms found on data sheets."""

from math import pi, sqrt
from typing import Annotated

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import Element, optional
from tline.scene.quantity import Area, Density, Diameter, PositiveFlow, Quantity, Role

BAR, PSI = 1e5, 6894.757293168361  # Pa
WATER = 1000.0  # kg/m³, reference of Kv and Cv
HOUR, MINUTE, GALLON = 3600.0, 60.0, 3.785411784e-3  # s, s, m³
WAYS = (
    ({"loss_coefficient"}, {"area"}),
    ({"loss_coefficient"}, {"diameter"}),
    ({"kv"}, set()),
    ({"cv"}, set()),
    ({"flow"}, {"pressure_drop"}),
)
EXPECTED = "kv, cv, flow with pressure_drop, or loss_coefficient with diameter or area"


class Rated(Element):
    """Element with flow = C·sqrt(pressure drop), C given in one of the usual ways."""

    loss_coefficient: Annotated[Quantity, Role("loss coefficient", "", above=0)] | None = optional(
        "K: pressure drop over the dynamic pressure, with diameter or area"
    )
    diameter: Diameter | None = optional("of the section that K refers to")
    area: Area | None = optional("of the section that K refers to")
    kv: Annotated[Quantity, Role("kv", "", above=0)] | None = optional("m³/h of water at a drop of 1 bar")
    cv: Annotated[Quantity, Role("cv", "", above=0)] | None = optional(
        "US gallons of water a minute at a drop of 1 psi"
    )
    flow: PositiveFlow | None = optional("flow at the pressure drop")
    pressure_drop: Annotated[Quantity, Role("pressure drop", "Pa", above=0)] | None = optional("drop at that flow")
    density: Density = optional("of the liquid; used with K, kv and cv", Quantity(WATER, "kg/m^3"))

    @property
    def capacity(self) -> float | None:
        """Capacity C in m³/s per sqrt(Pa), wide open; None if it is not given."""
        area = self.bore
        if self.loss_coefficient is not None and area is not None:
            return area * sqrt(2 / (self.loss_coefficient * self.density))
        if self.kv is not None:
            return self.kv / HOUR / sqrt(BAR * self.density / WATER)
        if self.cv is not None:
            return self.cv * GALLON / MINUTE / sqrt(PSI * self.density / WATER)
        if self.flow is not None and self.pressure_drop is not None:
            return self.flow / sqrt(self.pressure_drop)
        return None

    @property
    def bore(self) -> float | None:
        """Area to which K refers, m²; None if it is not given."""
        return pi / 4 * self.diameter**2 if self.diameter is not None else self.area

    @property
    def loss(self) -> float:
        """Loss coefficient K, wide open, for a given capacity and section."""
        assert self.capacity is not None
        assert self.bore is not None
        return 2 * (self.bore / self.capacity) ** 2 / self.density

    @property
    def _may_lack_a_loss(self) -> bool:
        return False

    @property
    def _may_have_a_bore(self) -> bool:
        return False

    @model_validator(mode="after")
    def _said_once(self):
        given = {key for either in WAYS for part in either for key in part if getattr(self, key) is not None}
        if self._may_have_a_bore and self.loss_coefficient is None and len(given & {"diameter", "area"}) == 1:
            given -= {"diameter", "area"}
        if any(given == first | second for first, second in WAYS) or (not given and self._may_lack_a_loss):
            return self
        problem = "its capacity is not given once" if given else "its capacity is not given"
        raise InputError("", problem, EXPECTED, ", ".join(sorted(given)))
