"""Waves on pipes and cables: lines carry waves, nodes scatter them, and no passive scene creates energy."""

from tline.line import ElectricalLine, HydraulicLine

__all__ = ["ElectricalLine", "HydraulicLine"]
