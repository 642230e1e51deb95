"""What protects a pipe from surges, and how large it has to be: vessels, closures, relief valves, flywheels."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
