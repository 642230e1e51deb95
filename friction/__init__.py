"""Friction models on a testbench, exact where they can be, and predictions of where methods fail."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
