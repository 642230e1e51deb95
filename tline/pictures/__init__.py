"""Pictures of runs, scenes and what is measured on them."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
