"""Ctrl-C goes to every process of a terminal at once: one sentence, exit status 130, and what was done is there."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from tline.workers import Workers, interrupts_deferred

ROOT = Path(__file__).parents[2]
BIRTH = """
import os, signal, sys
if "--multiprocessing-fork" in sys.orig_argv:
    try:
        os.close(os.open(os.environ["ONCE"], os.O_CREAT | os.O_EXCL))
        os.killpg(0, signal.SIGINT)
    except FileExistsError:
        pass
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="process groups are those of POSIX")
def test_ctrl_c_to_all_processes_as_a_worker_is_born(tmp_path):
    """The first worker interrupts the whole group before it has done anything: once, whatever the time is."""
    (tmp_path / "sitecustomize.py").write_text(BIRTH)
    own = os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}", "ONCE": str(tmp_path / "once")}
    call = [sys.executable, "-m", "tline", "sweep", str(ROOT / "scenes" / "diode_clamp.toml")]
    call += ["--vary", "t_end=10ns:11ns:300", "--workers", "2", "--tol", "1e-3"]
    call += ["--resume", "runs.npz", "--csv", "runs.csv"]
    done = subprocess.run(
        call, cwd=tmp_path, env=own, capture_output=True, text=True, check=False, start_new_session=True
    )
    assert (tmp_path / "once").exists()
    assert done.returncode == 130
    assert done.stderr.startswith("note: interrupted: ")
    assert done.stderr.count("\n") == 1
    with np.load(tmp_path / "runs.npz") as saved:
        made = saved["done"]
    assert 1 <= made.sum() < 300
    rows = (tmp_path / "runs.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert [not row.endswith("not run") for row in rows] == made.tolist()


def test_what_is_deferred_comes_at_the_end():
    reached = []

    def whole():
        with interrupts_deferred():
            signal.raise_signal(signal.SIGINT)
            reached.append("whole")
        reached.append("more")

    with pytest.raises(KeyboardInterrupt):
        whole()
    assert reached == ["whole"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with interrupts_deferred():
        pass
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_nothing_is_left_of_workers_that_have_been_ended():
    """Neither the one that sleeps nor the thread that waits for it, which would write into a closed pipe at exit."""
    before = threading.active_count()
    pool = Workers(1)
    future = pool.submit(time.sleep, 3600)
    (process,) = pool._processes.values()
    pool.end()
    assert future.done()
    assert not process.is_alive()
    assert threading.active_count() == before
