"""Waves on pipes and cables: lines carry waves, nodes scatter them, and no passive scene creates energy."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tline.line import ElectricalLine, HydraulicLine

__all__ = ["ElectricalLine", "HydraulicLine"]


def __getattr__(name: str) -> Any:
    """Import a public name when it is used: errors and units, on which other packages stand, load nothing else."""
    if name not in __all__:
        raise AttributeError(f"module 'tline' has no attribute '{name}'")
    return getattr(import_module("tline.line"), name)
