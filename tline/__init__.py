"""Waves on pipes and cables: lines carry waves, nodes scatter them, and no passive scene creates energy."""

from tline.lazy import lazy

__version__ = "0.1.0"
__getattr__, __dir__ = lazy(__name__)
