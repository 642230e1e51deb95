"""Line parameters of a pipe or a cable, from any sufficient set of quantities."""

from tline.line.electrical import ElectricalLine
from tline.line.hydraulic import HydraulicLine

__all__ = ["ElectricalLine", "HydraulicLine"]
