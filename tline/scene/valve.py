"""Valves: flow = opening·C·sqrt(pressure drop), in both directions or in one."""

from math import inf
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    ValidatorFunctionWrapHandler,
    WrapSerializer,
    WrapValidator,
    model_validator,
)

from tline.errors import InputError
from tline.scene.between import Between
from tline.scene.element import AtNode, Element
from tline.scene.factor import ALWAYS, Characterised, Factor
from tline.scene.law import ElementLaw, OfLiquids
from tline.scene.quantity import ZERO, Pressure, Quantity, Role
from tline.scene.rating import Rated
from tline.scene.shape import Shape
from tline.scene.travel import ADDED, Kind, shares
from tline.wording import shown

Share = Annotated[Quantity, Role("share", "", at_least=0, at_most=1)]
Back = Annotated[Quantity, Role("pressure", "Pa")]


def _pair(point: Any) -> Any:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise InputError("", "not a point", "a pair [opening, share of the capacity]", shown(point))
    return point


def _named_or_points(value: Any, points: ValidatorFunctionWrapHandler) -> Any:
    if not isinstance(value, str):
        return points(value)
    if value not in ADDED:
        raise InputError("", "not a kind of valve", f"{' or '.join(map(repr, ADDED))}, or points", shown(value))
    return value


def _as_typed(value: Any, points: SerializerFunctionWrapHandler) -> Any:
    return value if isinstance(value, str) else points(value)


Points = list[Annotated[tuple[Share, Share], BeforeValidator(_pair)]]
Characteristic = Annotated[
    Points, WrapValidator(_named_or_points, json_schema_input_type=Points | Kind), WrapSerializer(_as_typed)
]


class _Orifice(Rated, OfLiquids):
    opening: Factor = Field(default=ALWAYS, description="0 (shut) to 1 (wide open), constant or over time")
    characteristic: Characteristic | None = Field(
        default=None,
        description="points [opening, share of the capacity] with straight lines between, or 'gate', 'globe', 'ball' "
        "or 'butterfly' for what such a valve of that diameter loses on its way; without it both are equal",
    )
    _share: Characterised | None = PrivateAttr(default=None)

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

    @property
    def share(self) -> Shape:
        """Share of the capacity over time."""
        if self.characteristic is None:
            return self.opening
        if self._share is None:
            if isinstance(self.characteristic, str):
                points = shares(self.characteristic, self.loss)
            else:
                points = tuple((float(x), float(y)) for x, y in self.characteristic)
            self._share = Characterised.model_construct(opening=self.opening, shares=points)
        return self._share

    def law(self) -> ElementLaw:
        return ElementLaw("quadratic", (_behind(self), self.capacity or inf, 0.0), self.share)


class _CheckValve(Rated, OfLiquids):
    cracking_pressure: Annotated[Quantity, Role("pressure", "Pa", at_least=0)] = Field(
        default=ZERO, description="drop at which it begins to open"
    )

    @property
    def _may_lack_a_loss(self) -> bool:
        return True

    def law(self) -> ElementLaw:
        return ElementLaw("quadratic", (self.cracking_pressure + _behind(self), self.capacity or inf, 1.0))


class _ReliefValve(Rated, OfLiquids):
    set_pressure: Annotated[Quantity, Role("pressure", "Pa", at_least=0)] = Field(
        description="drop at which it begins to open"
    )
    band: Annotated[Quantity, Role("pressure", "Pa", above=0)] = Field(
        description="further drop over which it opens in proportion, up to its full capacity"
    )

    def law(self) -> ElementLaw:
        constants = (_behind(self), self.capacity or inf, float(self.set_pressure), float(self.band))
        return ElementLaw("relief", constants)


class _Behind(AtNode):
    back_pressure: Pressure = Field(default=ZERO, description="gauge pressure on the other side; 0 is the open air")


def _behind(element: Element) -> float:
    return float(getattr(element, "back_pressure", 0.0))


class Orifice(_Orifice, _Behind):
    """An orifice or control valve to the outside: flow = share·C·sqrt(drop), in both directions."""

    kind: Literal["orifice"] = "orifice"


class OrificeLink(_Orifice, Between):
    """An orifice, a minor loss or a control valve between two nodes: flow = share·C·sqrt(drop), in both directions."""

    kind: Literal["orifice"] = "orifice"


class CheckValve(_CheckValve, _Behind):
    """A valve to the outside that lets nothing in."""

    kind: Literal["check valve"] = "check valve"


class CheckValveLink(_CheckValve, Between):
    """A valve that lets flow pass from the first node to the second only; without a capacity it has no loss."""

    kind: Literal["check valve"] = "check valve"


class ReliefValve(_ReliefValve, _Behind):
    """A relief valve to the outside: shut up to the set pressure, wide open a band above it."""

    kind: Literal["relief valve"] = "relief valve"


class ReliefValveLink(_ReliefValve, Between):
    """A relief valve from the first node to the second: shut up to the set pressure, wide open a band above it."""

    kind: Literal["relief valve"] = "relief valve"
