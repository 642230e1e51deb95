"""Links: what stands between two nodes without a delay of its own."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Annotated

from tline.scene.characteristic import CurveLink, DiodeLink
from tline.scene.choice import OneOf
from tline.scene.measured_multiport import MeasuredMultiport
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.pump import Pump
from tline.scene.rational_link import (
    CapacitorLink,
    ImpedanceLink,
    InductorLink,
    ParallelLink,
    ResistorLink,
    SeriesLink,
)
from tline.scene.regulating import RegulatingValve
from tline.scene.switch import SwitchLink
from tline.scene.user_defined import UserLink, or_user_defined
from tline.scene.valve import CheckValveLink, OrificeLink, ReliefValveLink

if TYPE_CHECKING:
    from tline.scene.scene import Scene

_Any = (
    ResistorLink | InductorLink | CapacitorLink | SeriesLink | ParallelLink | ImpedanceLink | SwitchLink
    | OrificeLink | CheckValveLink | ReliefValveLink | RegulatingValve | Pump | DiodeLink | CurveLink
    | Transformer | Gyrator | ControlledSource | CoupledInductors | Junction | MeasuredMultiport
)  # fmt: skip
Link = Annotated[_Any, OneOf(_Any, "kind"), *or_user_defined(UserLink)]


def linked_pairs(scene: Scene) -> list[tuple[str, str]]:
    """Any two nodes that a link or a source joins."""
    return [pair for _, nodes in scene.between for pair in combinations(dict.fromkeys(nodes), 2)]
