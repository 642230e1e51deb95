"""Links: what stands between two nodes without a delay of its own."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Annotated, Any

from tline.scene import elements
from tline.scene.characteristic import Curve, Diode
from tline.scene.choice import OneOf
from tline.scene.measured_multiport import MeasuredMultiport
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.pump import Pump
from tline.scene.rational import Capacitor, Impedance, Inductor, Parallel, Resistor, Series
from tline.scene.regulating import RegulatingValve
from tline.scene.switch import Switch
from tline.scene.user_defined import UserLink, or_user_defined
from tline.scene.valve import CheckValve, Orifice, ReliefValve

if TYPE_CHECKING:
    from tline.scene.scene import Scene

LINKS = (
    Resistor.link, Inductor.link, Capacitor.link, Series.link, Parallel.link, Impedance.link, Switch.link,
    Orifice.link, CheckValve.link, ReliefValve.link, RegulatingValve, Pump, Diode.link, Curve.link,
    Transformer, Gyrator, ControlledSource, CoupledInductors, Junction, MeasuredMultiport, *elements.links(),
)  # fmt: skip
Link = Annotated[Any, OneOf(LINKS, "kind"), *or_user_defined(UserLink)]


def linked_pairs(scene: Scene) -> list[tuple[str, str]]:
    """Any two nodes that a link or a source joins."""
    return [pair for _, nodes in scene.between for pair in combinations(dict.fromkeys(nodes), 2)]
