"""Numbers with units inside a scene: floats in SI that remember what was typed."""

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from tline.errors import InputError
from tline.scene.medium import MEDIA
from tline.units import to_si


class Quantity(float):
    """A value in SI; ``typed`` is the number or text it was given as.

    Examples
    --------
    >>> length = Quantity("10 cm", "m")
    >>> float(length), length.typed
    (0.1, '10 cm')
    """

    typed: float | str

    def __new__(cls, typed: float | str, unit: str | None, where: str = "", *, allow_infinite: bool = False):
        """Parse what was typed; unit None takes any."""
        value = super().__new__(cls, to_si(typed, unit, where, allow_infinite=allow_infinite))
        value.typed = typed
        return value

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.float_schema()


@dataclass(frozen=True)
class Role:
    """What a number in a scene stands for: its unit, given or by medium, and its range.

    The medium is taken from the validation context; without one (an element that is in no scene yet) a role whose unit
    depends on the medium takes any unit, and the scene looks again.
    """

    name: str
    unit: str | None = None
    at_least: float | None = None
    above: float | None = None
    allow_infinite: bool = False

    def read(self, typed: Any, info: ValidationInfo) -> Quantity:
        """Parse and check one value."""
        medium = MEDIA.get((info.context or {}).get("medium", ""))
        unit = self.unit if self.unit is not None else medium.units.get(self.name) if medium else None
        typed = typed.typed if isinstance(typed, Quantity) else typed
        value = Quantity(typed, unit, allow_infinite=self.allow_infinite)
        if self.above is not None and not value > self.above:
            raise InputError("", f"{self.name} out of range", f"more than {self.above:g}", repr(typed))
        if self.at_least is not None and not value >= self.at_least:
            raise InputError("", f"{self.name} out of range", f"at least {self.at_least:g}", repr(typed))
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        typed = core_schema.plain_serializer_function_ser_schema(lambda value: value.typed)
        return core_schema.with_info_plain_validator_function(self.read, serialization=typed)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        unit = self.unit if self.unit is not None else "by medium"
        limits = {"minimum": self.at_least, "exclusiveMinimum": self.above}
        number = {"type": "number"} | {key: limit for key, limit in limits.items() if limit is not None}
        return {"title": self.name, "unit": unit, "anyOf": [number, {"type": "string"}]}


Time = Annotated[Quantity, Role("time", "s")]
Duration = Annotated[Quantity, Role("duration", "s", above=0)]
Frequency = Annotated[Quantity, Role("frequency", "Hz", above=0)]
Angle = Annotated[Quantity, Role("angle", "rad")]
Position = Annotated[Quantity, Role("position", at_least=0)]  # a length, or a share of the line
Effort = Annotated[Quantity, Role("effort")]
Resistance = Annotated[Quantity, Role("resistance", at_least=0, allow_infinite=True)]
PositiveResistance = Annotated[Quantity, Role("resistance", above=0)]
Inductance = Annotated[Quantity, Role("inductance", above=0)]
Capacitance = Annotated[Quantity, Role("capacitance", above=0)]
Level = Annotated[Quantity, Role("level")]  # of a waveform; its source knows whether it is an effort or a flow
ZERO = Quantity(0, None)
