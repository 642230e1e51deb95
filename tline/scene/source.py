"""Sources: a prescribed effort or flow behind an internal resistance."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.element import AtNode
from tline.scene.medium import MEDIA
from tline.scene.quantity import Resistance
from tline.scene.waveform import Constant, Shape, Waveform
from tline.units import to_si


def _number_is_constant(value: Any) -> Any:
    if isinstance(value, dict | Shape):
        return value
    return {"shape": "constant", "level": value}


class Source(AtNode):
    """An effort in series with its resistance, or a flow with the resistance beside it.

    Parameters
    ----------
    at : str
        Node.
    kind : str
        "pressure" or "flow" in a hydraulic scene, "voltage" or "current" in an electrical one.
    value : number, text or waveform
        What is prescribed; a flow is counted into the node.
    resistance : number or text
        Internal resistance; without it an effort has none, and a flow an infinite one.

    Examples
    --------
    >>> Source(at="near", kind="voltage", value="1 V", resistance="50 ohm").resistance
    50.0
    """

    kind: Literal["pressure", "flow", "voltage", "current"]
    value: Annotated[Waveform, BeforeValidator(_number_is_constant, json_schema_input_type=Waveform | float | str)]
    resistance: Resistance | None = None

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

    @model_validator(mode="after")
    def _units_agree(self, info: ValidationInfo):
        medium = MEDIA.get((info.context or {}).get("medium", ""))
        if medium is None:
            return self
        if self.kind not in (medium.effort, medium.flow):
            raise InputError("kind", f"no {self.kind} in a {medium.name} scene", f"{medium.effort} or {medium.flow}")
        unit = medium.units["effort" if self.is_effort else "flow"]
        for name, typed in _levels(self.value):
            to_si(typed, unit, f"value.{name}" if name else "value")
        return self


def _levels(waveform: Shape) -> Iterator[tuple[str, float | str]]:
    """The numbers of a waveform that are efforts or flows, with their keys."""
    if isinstance(waveform, Constant):
        yield "", waveform.level.typed
        return
    table = waveform.table()
    for name in ("from", "to", "low", "high", "amplitude", "offset", "peak"):
        if name in table:
            yield name, table[name]
    for k, (_, level) in enumerate(table.get("points", [])):
        yield f"points[{k}]", level
