"""Numbers with units in a scene: floats in SI that keep the text as typed."""

import re
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from tline.errors import InputError
from tline.units import to_si
from tline.words.wording import shown

# sizes beyond these, in SI, are no physics, and products of a few of them would leave the range of floats
SMALLEST, LARGEST = 1e-100, 1e100
GRAVITY = 9.80665  # m/s², of the earth
LONGEST = 20  # characters of a whole number


class Quantity(float):
    """Value in SI; ``typed`` is the number or text given, ``unit`` the SI unit, None if any is allowed.

    Examples
    --------
    >>> length = Quantity("10 cm", "m")
    >>> float(length), length.typed
    (0.1, '10 cm')
    """

    __slots__ = ("typed", "unit")
    typed: float | str
    unit: str | None

    def __new__(cls, typed: float | str, unit: str | None, where: str = "", *, allow_infinite: bool = False):
        """Parse a number or text; unit None allows any."""
        return _restored(to_si(typed, unit, where, allow_infinite=allow_infinite), typed, unit)

    def __reduce__(self):
        return _restored, (float(self), self.typed, self.unit)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.float_schema()


def _restored(value: float, typed: float | str, unit: str | None) -> Quantity:
    quantity = float.__new__(Quantity, value)
    quantity.unit = unit
    plain = str if isinstance(typed, str) else int if isinstance(typed, int) else float  # a file knows no others
    quantity.typed = plain(typed)
    return quantity


@dataclass(frozen=True)
class Role:
    """Role of a number in a scene: its unit, given or by context, and its range.

    A unit of None is looked up by the role's name among the ``units`` of the validation context; without a context
    (an element outside of a scene) any unit is accepted, and the scene checks again.
    """

    name: str
    unit: str | None = None
    at_least: float | None = None
    above: float | None = None
    at_most: float = LARGEST
    allow_infinite: bool = False
    if_negative: str = ""  # likely alternative for a user who gives a negative value

    def read(self, typed: Any, info: ValidationInfo) -> Quantity:
        """Parse and check one value."""
        return self.parse(typed, self.unit if self.unit is not None else _units(info).get(self.name))

    def parse(self, typed: Any, unit: str | None) -> Quantity:
        """Parse and check one value that has this unit."""
        typed = typed.typed if isinstance(typed, Quantity) else typed
        try:
            value = Quantity(typed, unit, allow_infinite=self.allow_infinite)
        except RecursionError:  # a table in tables in tables
            raise InputError("", "not a number", got=shown(typed)) from None
        if self.above is not None and not value > self.above:
            expected = f"more than {self.above:g}{self._instead(value)}"
        elif self.at_least is not None and not value >= self.at_least:
            expected = f"at least {self.at_least:g}{self._instead(value)}"
        elif abs(value) > self.at_most and "inf" not in str(typed).lower():
            expected = f"at most {self.at_most:g}"
        elif 0 < value < SMALLEST and (self.above, self.at_least) != (None, None):
            expected = f"at least {SMALLEST:g}"
        else:
            return value
        raise InputError("", f"{self.name} out of range", expected, shown(typed))

    def _instead(self, value: float) -> str:
        return f", or {self.if_negative.format(value)}" if value < 0 and self.if_negative else ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        typed = core_schema.plain_serializer_function_ser_schema(lambda value: value.typed)
        return core_schema.with_info_plain_validator_function(self.read, serialization=typed)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        unit = self.unit if self.unit is not None else "by medium"
        limits = {"minimum": self.at_least, "exclusiveMinimum": self.above}
        limits["maximum"] = self.at_most if self.at_most < LARGEST else None
        number = {"type": "number"} | {key: limit for key, limit in limits.items() if limit is not None}
        return {"title": self.name, "unit": unit, "anyOf": [number, {"type": "string"}]}


def _units(info: ValidationInfo) -> dict[str, str]:
    return (info.context or {}).get("units", {})


@dataclass(frozen=True)
class Whole:
    """Whole number within limits as an int of a scene; a text of digits is accepted, a truth value is not."""

    least: int
    most: int = 2**53  # beyond, doubles skip some

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def read(self, typed: Any) -> int:
        """Parse and check one value."""
        digits = typed.strip() if isinstance(typed, str) and len(typed) < LONGEST else ""
        number = int(digits) if re.fullmatch(r"[+-]?[0-9]+", digits) else typed
        if isinstance(number, float) and number.is_integer():
            number = int(number)
        limits = f"from {self.least} to {self.most}" if self.most < 2**53 else f"of at least {self.least}"
        limits = "of at most 2^53" if type(number) is int and number > self.most == 2**53 else limits
        if type(number) is not int or not self.least <= number <= self.most:
            raise InputError("", "not a whole number in range", f"one {limits}", shown(typed))
        return number

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        limits = {"minimum": self.least, "maximum": self.most}
        return {"anyOf": [{"type": "integer"} | limits, {"type": "string"}]}


Time = Annotated[Quantity, Role("time", "s")]
Instant = Annotated[Quantity, Role("time", "s", at_least=0)]
Duration = Annotated[Quantity, Role("duration", "s", above=0)]
Delay = Annotated[Quantity, Role("duration", "s", at_least=0)]
Frequency = Annotated[Quantity, Role("frequency", "Hz", above=0)]
TOLERANCE = Role("tolerance", "", at_least=1e-13, at_most=0.1)
Tolerance = Annotated[Quantity, TOLERANCE]
FIT_TOLERANCE = Role("tolerance", "", at_least=1e-13, at_most=1.0)  # of samples: noise forbids a closer fit
SECONDS = Role("duration", "s", above=0)
Angle = Annotated[Quantity, Role("angle", "rad")]
Position = Annotated[Quantity, Role("position", at_least=0)]  # a length, or a share of the line
Length = Annotated[Quantity, Role("length", "m", above=0)]
Diameter = Annotated[Quantity, Role("diameter", "m", above=0)]
Area = Annotated[Quantity, Role("area", "m^2", above=0)]
PositiveVolume = Annotated[Quantity, Role("volume", "m^3", above=0)]
Density = Annotated[Quantity, Role("density", "kg/m^3", above=0)]
Temperature = Annotated[Quantity, Role("temperature", "K", above=0)]
Inertia = Annotated[Quantity, Role("inertia", "kg m^2", above=0)]
Acceleration = Annotated[Quantity, Role("acceleration", "m/s^2", above=0)]
PositiveShare = Annotated[Quantity, Role("share", "", above=0, at_most=1)]
PositiveFlow = Annotated[Quantity, Role("flow", "m^3/s", above=0)]
Pressure = Annotated[Quantity, Role("pressure", "Pa")]
PositivePressure = Annotated[Quantity, Role("pressure", "Pa", above=0)]
Drop = Annotated[Quantity, Role("pressure", "Pa", at_least=0)]
AnyEffort = Annotated[Quantity, Role("effort")]
Effort = Annotated[Quantity, Role("effort", above=0)]
Resistance = Annotated[Quantity, Role("resistance", at_least=0, allow_infinite=True)]
ACTIVE = "kind = 'impedance' with expression = '{:.9g}', which runs with --active"
LoadResistance = Annotated[Quantity, Role("resistance", at_least=0, allow_infinite=True, if_negative=ACTIVE)]
PositiveResistance = Annotated[Quantity, Role("resistance", above=0, if_negative=ACTIVE)]
ResistancePerMetre = Annotated[Quantity, Role("resistance per metre", "ohm/m", at_least=0)]
PositiveResistancePerMetre = Annotated[Quantity, Role("resistance per metre", "ohm/m", above=0)]
ConductancePerMetre = Annotated[Quantity, Role("conductance per metre", "S/m", at_least=0)]
Inductance = Annotated[Quantity, Role("inductance", above=0)]
Capacitance = Annotated[Quantity, Role("capacitance", above=0)]
Parameter = Annotated[Quantity, Role("parameter")]  # of an expression, which forgets its unit
LEVEL = Role("level")  # of a waveform; its source determines whether it is an effort or a flow
Level = Annotated[Quantity, LEVEL]
ZERO = Quantity(0, None)
