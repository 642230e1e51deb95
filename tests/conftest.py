"""Random examples are the same in every run; HYPOTHESIS_PROFILE=explore looks for new ones.

Before several workers start, the kernels are compiled, lest each compiles them for itself; and each works on one core.
Ctrl-C is heard even where a shell has started all this in the background and shut it off.
Tests that slow.txt names take seconds beside quicker ones of the same: `make test-slow` runs them.
"""

import gc
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

BUSY = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}  # a computer that is busy is no failure
settings.register_profile("repeat", derandomize=True, max_examples=50, **BUSY)
settings.register_profile("explore", **BUSY)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeat"))


def pytest_configure(config):
    """Compile all units ahead; threads of BLAS in each worker would only wait for one another."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        os.environ["OPENBLAS_NUM_THREADS"] = "1"
        subprocess.run([sys.executable, "-m", "tline", "warm-up"], check=False, capture_output=True)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the slow ones, before those that are marked are left out."""
    slow = {f"tests/{line}" for line in (Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").splitlines()}
    for item in items:
        if item.nodeid in slow:
            item.add_marker("slow")


@pytest.fixture(autouse=True, scope="module")
def unadjusted_pictures(request):
    """Without a layout, which doubles the time of a picture and more, but where pictures themselves are looked at."""
    with pytest.MonkeyPatch.context() as patch:
        if "picture" not in request.path.name:
            patch.setattr("matplotlib.figure.Figure.get_layout_engine", lambda _: None)
        yield


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Empty folder in which the test runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def pytest_collection_finish():
    """What is collected stays to the end: garbage is not looked for in it."""
    gc.freeze()
