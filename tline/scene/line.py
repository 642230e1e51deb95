"""Lines of a scene: two nodes and any sufficient set of the line's quantities."""

from collections.abc import Iterable
from typing import Any

from pydantic import Field, PrivateAttr, create_model, model_validator

from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine
from tline.line.electrical import QUANTITIES as ELECTRICAL
from tline.line.hydraulic import QUANTITIES as HYDRAULIC
from tline.line.relations import Quantity
from tline.scene.element import Element


class SceneLine(Element):
    """A line from its end 1 (the first node) to its end 2 (the second)."""

    nodes: tuple[str, str]
    _parameters: HydraulicLine | ElectricalLine = PrivateAttr()

    @property
    def parameters(self) -> HydraulicLine | ElectricalLine:
        """All quantities of the line."""
        return self._parameters

    def _settle(self, kind: type[HydraulicLine] | type[ElectricalLine]):
        given = {name: value for name, value in self if name != "nodes" and value is not None}
        self._parameters = kind(**given)
        if self._parameters.delay is None:
            raise InputError("", "its delay does not follow", "length (with wave_speed), or delay")
        return self


class _Pipe(SceneLine):
    @model_validator(mode="after")
    def _determine(self):
        return self._settle(HydraulicLine)


class _Cable(SceneLine):
    @model_validator(mode="after")
    def _determine(self):
        return self._settle(ElectricalLine)


def _model(name: str, base: type[SceneLine], quantities: Iterable[Quantity], words: Iterable[str]) -> type[SceneLine]:
    """A table with a key for each quantity a line can be built from, and for what names a material."""
    fields: dict[str, Any] = {
        q.name: (float | str | None, Field(default=None, description=q.help, json_schema_extra={"unit": q.unit}))
        for q in quantities
    }
    fields |= {word: (float | str | None, Field(default=None)) for word in words}
    return create_model(name, __base__=base, **fields)  # pyright: ignore[reportCallIssue, reportArgumentType]


Pipe = _model("Pipe", _Pipe, HYDRAULIC, ("fluid", "temperature", "wall"))
Cable = _model("Cable", _Cable, ELECTRICAL, ())
