"""Benchmarks of tline against other programs and methods."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))  # references and judges live with the tests that use them
