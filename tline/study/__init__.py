"""Study of numerical methods: charts, baseline methods, reference solutions, other programs."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
