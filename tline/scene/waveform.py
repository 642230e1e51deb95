"""All shapes a waveform may have."""

from typing import Annotated

from pydantic import Field

from tline.scene.points import PiecewiseLinear, Ramp, Table
from tline.scene.pulses import Pulses
from tline.scene.shape import Constant, Shape, Step
from tline.scene.smooth import DoubleExponential, Exponential, Sine

__all__ = [
    "Constant", "DoubleExponential", "Exponential", "PiecewiseLinear", "Pulses", "Ramp", "Shape", "Sine", "Step",
    "Table", "Waveform",
]  # fmt: skip

Waveform = Annotated[
    Constant | Step | Ramp | PiecewiseLinear | Table | Pulses | Sine | Exponential | DoubleExponential,
    Field(discriminator="shape"),
]
