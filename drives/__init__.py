"""Two spools, a belt and a spring-loaded pulley: exact models, simulation and control; knows nothing of lines."""

import tline.exact_numbers  # noqa: F401 (models hold them, and are sent to other processes)
from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
