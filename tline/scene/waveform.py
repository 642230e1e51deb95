"""All shapes a waveform may have."""

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any

from pydantic import TypeAdapter, ValidationInfo

from tline.scene.choice import OneOf
from tline.scene.points import PiecewiseLinear, Pulses, Ramp, Table
from tline.scene.quantity import LEVEL
from tline.scene.shape import Constant, Shape, Step
from tline.scene.smooth import DoubleExponential, Exponential, ModulatedSine, Sine

__all__ = [
    "Constant", "DoubleExponential", "Exponential", "ModulatedSine", "PiecewiseLinear", "Pulses", "Ramp", "Shape",
    "Sine", "Step", "Table", "Waveform", "read_waveform",
]  # fmt: skip

_Any = (
    Constant | Step | Ramp | PiecewiseLinear | Table | Pulses | Sine | ModulatedSine | Exponential
    | DoubleExponential
)  # fmt: skip
Waveform = Annotated[_Any, OneOf(_Any, "shape")]


def read_waveform(value: Any, unit: str | None, info: ValidationInfo) -> Shape:
    """A waveform whose levels have that unit; a number or text is a constant."""
    if not isinstance(value, Mapping | Shape):
        return Constant(level=LEVEL.parse(value, unit))
    units = {} if unit is None else {LEVEL.name: unit}
    return _waveforms().validate_python(value, context={**(info.context or {}), "units": units})


@cache
def _waveforms() -> TypeAdapter[Shape]:
    return TypeAdapter(Waveform)
