"""Sweeps: a scene is run with many values, in this process or on any executor."""

from tline.solver.sweep.runs import InterruptedWarning, sweep
from tline.solver.sweep.table import Sweep

__all__ = ["InterruptedWarning", "Sweep", "sweep"]
