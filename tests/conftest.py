"""Random examples are the same in every run; HYPOTHESIS_PROFILE=explore looks for new ones.

Before several workers start, the kernels are compiled, lest each compiles them for itself.
"""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from hypothesis import settings

settings.register_profile("repeat", derandomize=True)
settings.register_profile("explore")
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeat"))

HERE = Path(__file__).parent
TO_COMPILE = "town", "y_junction lossy_cable"  # elements and losses; nothing, and segments: as long each


def pytest_configure(config):
    """Compile most of the kernel, some of it beside the rest."""
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        with ThreadPoolExecutor(len(TO_COMPILE)) as pool:
            list(pool.map(_compile, TO_COMPILE))


def _compile(scenes):
    paths = [str(HERE.parent / "scenes" / f"{scene}.toml") for scene in scenes.split()]
    subprocess.run([sys.executable, str(HERE / "compile_kernels.py"), *paths], check=False, capture_output=True)
