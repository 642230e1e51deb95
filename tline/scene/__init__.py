"""Scenes as a user describes them: lines, and the elements at nodes and between nodes."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
