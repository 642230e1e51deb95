"""Measurements on a scene: time-domain reflections, eyes, load lines."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
