"""Functions that sweeps of the tests keep: where processes can import them."""

import os
import signal
import time
from pathlib import Path

FLAG = "TLINE_TEST_FLAG"  # names a file that is there once a process was killed


def last(result):
    return result.probes["far"].u[-1]


def waves(result):
    return result.probes["far"].u[:3]


def slow(result):
    time.sleep(0.05)
    return last(result)


def kills_once(result):
    flag = Path(os.environ[FLAG])
    if not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return last(result)


def kills_at_60(result):
    if float(result.scene.lines["cable"].z0) == 60.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return last(result)
