"""Proofs that impedances are positive real and reflections bounded real; knows nothing of lines."""

import tline.exact_numbers  # noqa: F401 (verdicts hold them, and are sent to other processes)
from tline.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
