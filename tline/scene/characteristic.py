"""Laws of both media: diodes, and tables of effort and flow."""

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from tline.errors import InputError
from tline.scene.between import Between
from tline.scene.element import AtNode
from tline.scene.law import ElementLaw, NonLinear
from tline.scene.quantity import Quantity, Role
from tline.wording import shown

BOLTZMANN, CHARGE = 1.380649e-23, 1.602176634e-19  # J/K, C; exact in the SI
Saturation = Annotated[Quantity, Role("flow", at_least=1e-30, at_most=1e3)]
Emission = Annotated[Quantity, Role("emission", "", at_least=0.1, at_most=100)]
COLDEST, HOTTEST = 1.0, 5000.0  # K


class _Diode(NonLinear):
    saturation: Saturation = Field(description="current that flows backwards, Is")
    emission: Emission = Field(default=Quantity(1, ""), description="n")
    temperature: Annotated[Quantity, Role("temperature", "K", at_least=COLDEST, at_most=HOTTEST)] = Field(
        default=Quantity("300.15 K", "K"), description="of the junction"
    )

    def law(self) -> ElementLaw:
        thermal = self.emission * BOLTZMANN * self.temperature / CHARGE
        return ElementLaw(
            "diode", (0.0, float(self.saturation), float(thermal)), reverse=getattr(self, "reverse", False)
        )


class Diode(_Diode, AtNode):
    """A diode from the node to the reference: i = Is·(exp(u/(n·k·T/q)) - 1) (W. Shockley 1949)."""

    kind: Literal["diode"] = "diode"
    reverse: bool = Field(default=False, description="whether it points from the reference to the node")


class DiodeLink(_Diode, Between):
    """A diode from the first node to the second: i = Is·(exp(u/(n·k·T/q)) - 1) (W. Shockley 1949)."""

    kind: Literal["diode"] = "diode"


def _pair(point: Any) -> Any:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise InputError("", "not a point", "a pair [effort, flow]", shown(point))
    return point


Point = Annotated[tuple[Annotated[Quantity, Role("effort")], Annotated[Quantity, Role("flow")]], BeforeValidator(_pair)]


class _Curve(NonLinear):
    points: list[Point] = Field(
        min_length=2, max_length=1000, description="pairs [effort, flow], neither of which may fall"
    )

    @model_validator(mode="after")
    def _rises(self):
        for k, ((u, i), (v, j)) in enumerate(pairwise(self.points), 2):
            if v < u or j < i or (u, i) == (v, j):
                got = f"({v:g}, {j:g}) after ({u:g}, {i:g})"
                raise InputError(f"points[{k - 1}]", "the curve falls or stands still", "points that rise", got)
        return self

    def law(self) -> ElementLaw:
        efforts, flows = zip(*self.points, strict=True)
        return ElementLaw("table", (0.0, float(len(efforts)), *map(float, efforts), *map(float, flows)))


class Curve(_Curve, AtNode):
    """Flow from the node to the reference over effort: straight lines between points, continued beyond the last."""

    kind: Literal["table"] = "table"


class CurveLink(_Curve, Between):
    """Flow from node to node over the difference of efforts: straight lines between points, continued beyond."""

    kind: Literal["table"] = "table"
