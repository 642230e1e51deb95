"""Sizing of surge protection for pipes: vessels, closures, relief valves, flywheels."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
