"""Links: what stands between two nodes without a delay of its own."""

from typing import Annotated

from pydantic import Field

from tline.scene.characteristic import CurveLink, DiodeLink
from tline.scene.measured_multiport import MeasuredMultiport
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Junction, Transformer
from tline.scene.pump import Pump
from tline.scene.valve import CheckValveLink, OrificeLink, ReliefValveLink

Link = Annotated[
    OrificeLink | CheckValveLink | ReliefValveLink | Pump | DiodeLink | CurveLink
    | Transformer | Gyrator | ControlledSource | CoupledInductors | Junction | MeasuredMultiport,
    Field(discriminator="kind"),
]  # fmt: skip
