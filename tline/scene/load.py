"""Loads at a node and links between two nodes, without a delay; switches are both."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ValidationInfo, field_validator

from tline.scene import elements
from tline.scene.air_valve import AirValve
from tline.scene.characteristic import Curve, Diode
from tline.scene.element import AtNode, OneMedium, Placed, required
from tline.scene.ibis.element import Ibis
from tline.scene.ibis.series import IbisSeries
from tline.scene.medium import check_word
from tline.scene.mistakes import OneOf
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.outflow import Demand, Leak
from tline.scene.pump import Pump
from tline.scene.quantity import Pressure, Resistance, Time
from tline.scene.rational import Capacitor, Impedance, Inductor, Parallel, Resistor, Series
from tline.scene.regulating import RegulatingValve
from tline.scene.touchstone import MeasuredMultiport, Touchstone
from tline.scene.user_defined import UserLink, UserLoad, or_user_defined
from tline.scene.valve import CheckValve, Orifice, ReliefValve
from tline.scene.vessel import AirVessel, Cavity, SurgeTank, VapourCavity

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


LOADS = (
    NoFlow, Short, Reservoir, Matched, Resistor.load, Inductor.load, Capacitor.load, Series.load, Parallel.load,
    Impedance.load, Touchstone, Ibis, Switch.load, Orifice.load, CheckValve.load, ReliefValve.load, Leak, Demand,
    Diode.load, Curve.load, AirVessel, SurgeTank, Cavity, VapourCavity, AirValve, *elements.loads(),
)  # fmt: skip
Load = Annotated[Any, OneOf(LOADS, "kind"), *or_user_defined(UserLoad)]


LINKS = (
    Resistor.link, Inductor.link, Capacitor.link, Series.link, Parallel.link, Impedance.link, Switch.link,
    Orifice.link, CheckValve.link, ReliefValve.link, RegulatingValve, Pump, Diode.link, Curve.link, IbisSeries,
    Transformer, Gyrator, ControlledSource, CoupledInductors, Junction, MeasuredMultiport, *elements.links(),
)  # fmt: skip
Link = Annotated[Any, OneOf(LINKS, "kind"), *or_user_defined(UserLink)]


def linked_pairs(scene: Scene) -> list[tuple[str, str]]:
    """All pairs of nodes connected by a link or a source."""
    return [pair for _, nodes in scene.between for pair in combinations(dict.fromkeys(nodes), 2)]
