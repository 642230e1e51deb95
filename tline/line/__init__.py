"""Line parameters: what a pipe or a cable is, from whichever quantities are known."""

from tline.line.electrical import ElectricalLine
from tline.line.hydraulic import HydraulicLine

__all__ = ["ElectricalLine", "HydraulicLine"]
