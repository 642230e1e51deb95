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

SCENES = Path(__file__).parents[1] / "scenes"
TO_COMPILE = {
    "elements and losses": "air_vessel town pipe_friction",
    "fronts, cells, coupled lines": "y_junction lossy_cable coupled_pair",
}


def pytest_configure(config):
    """Run scenes that need between them most of the kernel, some beside each other."""
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        with ThreadPoolExecutor(len(TO_COMPILE)) as pool:
            list(pool.map(_run, TO_COMPILE.values()))


def _run(scenes):
    for scene in scenes.split():
        call = [sys.executable, "-m", "tline", "run", str(SCENES / f"{scene}.toml")]
        subprocess.run(call, check=False, capture_output=True)
