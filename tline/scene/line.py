"""Lines of a scene: two nodes and any sufficient set of the line's quantities."""

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, create_model, model_validator

from tline.errors import InputError
from tline.line import ElectricalLine, HydraulicLine
from tline.line.electrical import QUANTITIES as ELECTRICAL
from tline.line.fluids import FLUIDS
from tline.line.hydraulic import QUANTITIES as HYDRAULIC
from tline.line.parameters import Quantity as LineQuantity
from tline.line.relations import listed
from tline.line.walls import WALLS
from tline.scene.element import Element, Name
from tline.scene.mistakes import shown
from tline.scene.quantity import LARGEST, SMALLEST, Quantity, Role

MATERIALS = {
    "fluid": f"gives density and bulk modulus: {listed(FLUIDS, 'or')}",
    "wall": f"gives Young's modulus: {listed(WALLS, 'or')}",
}


def two_nodes(nodes: Any) -> Any:
    """A pair of nodes as read, if it is a pair."""
    if not isinstance(nodes, list | tuple) or len(nodes) != 2:
        raise InputError("", "not two nodes", 'two names such as ["a", "b"]', shown(nodes))
    return nodes


class SceneLine(Element):
    """A line from its end 1 (the first node) to its end 2 (the second)."""

    nodes: Annotated[tuple[Name, Name], BeforeValidator(two_nodes)] = Field(description="node at end 1, node at end 2")
    _parameters: HydraulicLine | ElectricalLine = PrivateAttr()

    @property
    def parameters(self) -> HydraulicLine | ElectricalLine:
        """All quantities of the line."""
        return self._parameters

    @property
    def shortest(self) -> float:
        """Its delay, s."""
        return self._parameters.delay or 0.0

    def steady_drop(self, y: float) -> tuple[float, float]:
        """Fall of the effort from end 1 to end 2 in steady flow y, and its slope over y."""
        return 0.0, 0.0

    def _settle(self, kind: type[HydraulicLine] | type[ElectricalLine]):
        given = {name: getattr(value, "typed", value) for name, value in self if name != "nodes" and value is not None}
        self._parameters = kind(**given)
        if self._parameters.delay is None:
            raise InputError("", "its delay does not follow", "length (with wave_speed), or delay")
        for name in ("z0", "delay"):
            value = getattr(self._parameters, name)
            if not SMALLEST <= value <= LARGEST:
                raise InputError("", f"its {name} is out of range", f"{SMALLEST:g} to {LARGEST:g}", f"{value:g}")
        return self


class _Pipe(SceneLine):
    """A pipe: any sufficient set of quantities."""

    @model_validator(mode="after")
    def _determine(self):
        return self._settle(HydraulicLine)


class _Cable(SceneLine):
    """A cable: any sufficient set of quantities."""

    @model_validator(mode="after")
    def _determine(self):
        return self._settle(ElectricalLine)


def _optional(role: Role) -> Any:
    quantity: Any = Annotated[Quantity, role]
    return quantity | None


def _model(name: str, base: type[SceneLine], quantities: Iterable[LineQuantity], **others: Any) -> type[SceneLine]:
    """A table with a key for each quantity a line can be built from, and for what names a material."""
    fields: dict[str, Any] = {
        q.name: (_optional(Role(q.name, q.unit, above=0)), Field(default=None, description=q.help)) for q in quantities
    }
    return create_model(  # pyright: ignore[reportCallIssue]
        name, __base__=base, __doc__=base.__doc__, __module__=__name__, **fields, **others
    )


Pipe = _model(
    "Pipe",
    _Pipe,
    HYDRAULIC,
    **{word: (str | None, Field(default=None, description=text)) for word, text in MATERIALS.items()},
    temperature=(
        _optional(Role("temperature", "K", above=0)),
        Field(default=None, description="of the water, 20 degC if not given"),
    ),
)
Cable = _model("Cable", _Cable, ELECTRICAL)
