"""Pictures of runs, of scenes and of measured channels."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
