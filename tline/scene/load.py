"""Loads at a node and links between two nodes, without a delay; switches are both."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ValidationInfo, field_validator

from tline.scene.element import AtNode, OneMedium, Placed, required
from tline.scene.medium import check_word
from tline.scene.mistakes import OfKind
from tline.scene.quantity import Pressure, Resistance, Time
from tline.scene.user_defined import UserLink, UserLoad, or_user_defined

if TYPE_CHECKING:
    from tline.scene.scene import Scene


class NoFlow(AtNode):
    """End without flow: a closed pipe, an open cable."""

    kind: Literal["closed", "open"]

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "no_flow")


class Short(AtNode):
    """End held at zero effort; of a pipe at zero gauge pressure, open to the air."""

    kind: Literal["short"] = "short"


class Reservoir(OneMedium, AtNode):
    """Node held at constant pressure."""

    medium, instead = "hydraulic", "a voltage source, or 'short'"
    kind: Literal["reservoir"] = "reservoir"
    pressure: Pressure = required("pressure at the node; piezometric, density·g·head, if nodes have elevations")


class Matched(AtNode):
    """Resistor equal to z0 of the only line at its node: no reflection."""

    kind: Literal["matched"] = "matched"


class Switch(Placed):
    """A valve or switch whose resistance changes from one value to another at an instant."""

    kind: Literal["switch", "valve"]
    before: Resistance = required("resistance before the instant")
    after: Resistance = required("resistance from the instant on")
    time: Time = required("the instant")

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "switch")


LOADS = {
    "closed": "load:NoFlow", "open": "load:NoFlow", "short": "load:Short", "reservoir": "load:Reservoir",
    "matched": "load:Matched", "resistor": "rational:Resistor.load", "inductor": "rational:Inductor.load",
    "capacitor": "rational:Capacitor.load", "series": "rational:Series.load", "parallel": "rational:Parallel.load",
    "impedance": "rational:Impedance.load", "touchstone": "touchstone:Touchstone", "ibis": "ibis.element:Ibis",
    "switch": "load:Switch.load", "valve": "load:Switch.load", "orifice": "valve:Orifice.load",
    "check valve": "valve:CheckValve.load", "relief valve": "valve:ReliefValve.load", "leak": "outflow:Leak",
    "demand": "outflow:Demand", "diode": "characteristic:Diode.load", "table": "characteristic:Curve.load",
    "air vessel": "vessel:AirVessel", "surge tank": "vessel:SurgeTank", "cavity": "vessel:Cavity",
    "vapour cavity": "vessel:VapourCavity", "air valve": "air_valve:AirValve",
}  # fmt: skip
LINKS = {
    "resistor": "rational:Resistor.link", "inductor": "rational:Inductor.link", "capacitor": "rational:Capacitor.link",
    "series": "rational:Series.link", "parallel": "rational:Parallel.link", "impedance": "rational:Impedance.link",
    "switch": "load:Switch.link", "valve": "load:Switch.link", "orifice": "valve:Orifice.link",
    "check valve": "valve:CheckValve.link", "relief valve": "valve:ReliefValve.link",
    "regulating valve": "regulating:RegulatingValve", "pump": "pump:Pump", "diode": "characteristic:Diode.link",
    "table": "characteristic:Curve.link", "ibis": "ibis.series:IbisSeries", "transformer": "multiport:Transformer",
    "gyrator": "multiport:Gyrator", "controlled source": "multiport:ControlledSource",
    "coupled inductors": "multiport:CoupledInductors", "junction": "multiport:Junction",
    "touchstone": "touchstone:MeasuredMultiport",
}  # fmt: skip
Load = Annotated[Any, OfKind(LOADS, "elements:loads"), *or_user_defined(UserLoad)]
Link = Annotated[Any, OfKind(LINKS, "elements:links"), *or_user_defined(UserLink)]


def linked_pairs(scene: Scene) -> list[tuple[str, str]]:
    """All pairs of nodes connected by a link or a source."""
    return [pair for _, nodes in scene.between for pair in combinations(dict.fromkeys(nodes), 2)]
