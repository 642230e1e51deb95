"""Scenes from and for other programs."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
