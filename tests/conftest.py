"""Random examples are the same in every run; HYPOTHESIS_PROFILE=explore looks for new ones.

Before several workers start, the kernels are compiled, lest each compiles them for itself; and each works on one core.
Ctrl-C is heard even where a shell has started all this in the background and shut it off.
"""

import gc
import os
import signal
import subprocess
import sys

from hypothesis import settings

settings.register_profile("repeat", derandomize=True)
settings.register_profile("explore")
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeat"))


def pytest_configure(config):
    """Compile all units ahead; threads of BLAS in each worker would only wait for one another."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        os.environ["OPENBLAS_NUM_THREADS"] = "1"
        subprocess.run([sys.executable, "-m", "tline", "warm-up"], check=False, capture_output=True)


def pytest_collection_finish():
    """What is collected stays to the end: garbage is not looked for in it."""
    gc.freeze()
