"""What a user describes: lines, and what stands at and between the nodes where they meet."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
