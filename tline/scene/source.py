"""Sources: a prescribed effort or flow behind an internal resistance."""

from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tline.errors import InputError
from tline.scene.choice import Read
from tline.scene.element import AtNode
from tline.scene.medium import MEDIA
from tline.scene.quantity import Resistance
from tline.scene.waveform import Shape, Waveform, read_waveform

UNITS = {word: m.units[role] for m in MEDIA.values() for word, role in ((m.effort, "effort"), (m.flow, "flow"))}


def _waveform(value: Any, info: ValidationInfo) -> Shape:
    """A waveform whose levels have the unit of the source's kind."""
    return read_waveform(value, UNITS.get(info.data.get("kind", "")), info)


class Source(AtNode):
    """An effort in series with its resistance, or a flow with the resistance beside it.

    Parameters
    ----------
    at : str
        Node.
    kind : str
        "pressure" or "flow" in a hydraulic scene, "voltage" or "current" in an electrical one.
    value : number, text or waveform
        What is prescribed; a flow is counted into the node. A pressure is piezometric if nodes have elevations.
    resistance : number or text
        Internal resistance; without it an effort has none, and a flow an infinite one.

    Examples
    --------
    >>> Source(at="near", kind="voltage", value="1 V", resistance="50 ohm").resistance
    50.0
    """

    kind: Literal["pressure", "flow", "voltage", "current"] = Field(
        description="what is prescribed: pressure or flow in a hydraulic scene, voltage or current in an electrical one"
    )
    value: Annotated[Shape, Read(_waveform, Waveform | float | str)] = Field(
        description="how much, constant or over time; a flow counts into the node; a pressure is piezometric, "
        "density·g·head, if nodes have elevations"
    )
    resistance: Resistance | None = Field(
        default=None, description="internal resistance; without it the source is ideal"
    )

    @property
    def is_effort(self) -> bool:
        """Whether an effort is prescribed; otherwise a flow is."""
        return self.kind in ("pressure", "voltage")

    @property
    def conductance(self) -> float:
        """1/resistance; infinite for an ideal effort, zero for an ideal flow."""
        if self.resistance is None:
            return float("inf") if self.is_effort else 0.0
        return float("inf") if self.resistance == 0 else 1 / self.resistance

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        medium = MEDIA.get((info.context or {}).get("medium", ""))
        if medium is not None and kind not in (medium.effort, medium.flow):
            problem = f"not a word of {medium.name} scenes"
            raise InputError("", problem, f"'{medium.effort}' or '{medium.flow}'", f"'{kind}'")
        return kind

    @model_validator(mode="after")
    def _drives(self):
        if not self.is_effort and self.resistance == 0:
            problem = f"beside the {self.kind} it takes all of it"
            raise InputError("resistance", problem, "none for an ideal source", "0")
        return self
