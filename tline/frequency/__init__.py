"""Linear scenes in the frequency domain: transfer functions, impedances, S-parameters, natural oscillations."""

from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
