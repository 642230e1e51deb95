"""What one measures on a scene: reflections in time, eyes, load lines."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
