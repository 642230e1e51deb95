"""Sources: a prescribed effort or flow behind an internal resistance."""

from typing import Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tline.errors import InputError
from tline.scene.element import Element, Name, TwoNodes, optional, required, words_are_required
from tline.scene.medium import MEDIA, check_word
from tline.scene.mistakes import Read
from tline.scene.quantity import Resistance
from tline.scene.waveform import Shape, Waveform, read_waveform
from tline.words.wording import shown

UNITS = {word: m.units[role] for m in MEDIA.values() for word, role in ((m.effort, "effort"), (m.flow, "flow"))}


def _waveform(value: Any, info: ValidationInfo) -> Shape:
    """Read a waveform whose levels have the unit of the source's kind."""
    return read_waveform(value, UNITS.get(info.data.get("kind", "")), info)


def _placed_once(schema: dict[str, Any]) -> None:
    words_are_required(schema)
    schema["oneOf"] = [{"required": ["at"]}, {"required": ["nodes"]}]


class Source(Element):
    """Effort in series with its resistance, or flow with the resistance in parallel.

    Parameters
    ----------
    at : str
        Node of a source against the reference.
    nodes : pair of str
        Instead of `at`, plus and minus of a source between two nodes: the effort is that of the first less
        that of the second, and a flow is driven out of the second into the first.
    kind : str
        "pressure" or "flow" in a hydraulic scene, "voltage" or "current" in an electrical one.
    value : number, text or waveform
        Prescribed value; a flow is counted into the (first) node. A pressure is piezometric if nodes have elevations.
    resistance : number or text
        Internal resistance; without it an effort has none, and a flow an infinite one.

    Examples
    --------
    >>> Source(at="near", kind="voltage", value="1 V", resistance="50 ohm").resistance
    50.0
    """

    model_config = ConfigDict(json_schema_extra=_placed_once)

    at: Name | None = optional("node of a source against the reference")
    nodes: TwoNodes | None = optional(
        "instead of `at`, plus and minus of a source between two nodes: an effort is that of the first "
        "less that of the second, and a flow is driven out of the second into the first"
    )
    kind: Literal["pressure", "flow", "voltage", "current"] = required(
        "what is prescribed: pressure or flow in a hydraulic scene, voltage or current in an electrical one"
    )
    value: Annotated[Shape, Read(_waveform, Waveform | float | str)] = required(
        "how much, constant or over time; a flow counts into the (first) node; a pressure is piezometric, "
        "density·g·head, if nodes have elevations"
    )
    resistance: Resistance | None = optional("internal resistance; without it the source is ideal")

    @property
    def terminals(self) -> tuple[str, str | None]:
        """Plus and minus of the source; None for the reference."""
        return (self.at or "", None) if self.nodes is None else self.nodes

    @property
    def is_effort(self) -> bool:
        """Whether an effort is prescribed; otherwise a flow is."""
        return self.kind in ("pressure", "voltage")

    @property
    def conductance(self) -> float:
        """Conductance 1/resistance; infinite for an ideal effort, zero for an ideal flow."""
        if self.resistance is None:
            return float("inf") if self.is_effort else 0.0
        return float("inf") if self.resistance == 0 else 1 / self.resistance

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "effort", "flow")

    @model_validator(mode="after")
    def _at_or_nodes(self):
        if self.at is None and self.nodes is None:
            raise InputError("at", "is missing", 'a node, or two as nodes = ["plus", "minus"]')
        if self.nodes is not None:
            if self.at is not None:
                raise InputError("", "its place is not given once", "either at or nodes", "both")
            if self.nodes[0] == self.nodes[1]:
                raise InputError("nodes", "both ends are at one node", "two different nodes", shown(self.nodes[0]))
        return self

    @model_validator(mode="after")
    def _drives(self):
        if not self.is_effort and self.resistance == 0:
            problem = f"beside the {self.kind} it takes all of it"
            raise InputError("resistance", problem, "none for an ideal source", "0")
        return self
