"""Sweeps: a scene is run with many values, in this process or on any executor."""

from tline.sweeps.runs import InterruptedWarning, sweep
from tline.sweeps.table import Sweep

__all__ = ["InterruptedWarning", "Sweep", "sweep"]
