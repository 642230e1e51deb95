"""Links: what stands between two nodes without a delay of its own."""

from collections.abc import Mapping
from itertools import combinations
from typing import Annotated

from tline.scene.characteristic import CurveLink, DiodeLink
from tline.scene.choice import OneOf
from tline.scene.measured_multiport import MeasuredMultiport
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.pump import Pump
from tline.scene.user_defined import UserLink, or_user_defined
from tline.scene.valve import CheckValveLink, OrificeLink, ReliefValveLink

_Any = (
    OrificeLink | CheckValveLink | ReliefValveLink | Pump | DiodeLink | CurveLink
    | Transformer | Gyrator | ControlledSource | CoupledInductors | Junction | MeasuredMultiport
)  # fmt: skip
Link = Annotated[_Any, OneOf(_Any, "kind"), *or_user_defined(UserLink)]


def linked_pairs(links: Mapping[str, Link]) -> list[tuple[str, str]]:
    """Any two nodes that a link joins."""
    return [pair for link in links.values() for pair in combinations(link.nodes, 2)]
