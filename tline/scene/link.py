"""Links: what stands between two nodes without a delay of its own."""

from collections.abc import Mapping
from itertools import combinations
from typing import Annotated

from pydantic import Field

from tline.scene.characteristic import CurveLink, DiodeLink
from tline.scene.measured_multiport import MeasuredMultiport
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.own import OwnLink, or_own
from tline.scene.pump import Pump
from tline.scene.valve import CheckValveLink, OrificeLink, ReliefValveLink

Link = Annotated[
    OrificeLink | CheckValveLink | ReliefValveLink | Pump | DiodeLink | CurveLink
    | Transformer | Gyrator | ControlledSource | CoupledInductors | Junction | MeasuredMultiport,
    Field(discriminator="kind"), *or_own(OwnLink),
]  # fmt: skip


def linked_pairs(links: Mapping[str, Link]) -> list[tuple[str, str]]:
    """Any two nodes that a link joins."""
    return [pair for link in links.values() for pair in combinations(link.nodes, 2)]
