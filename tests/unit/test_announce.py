"""What is said of work that takes long, ends in time, or is interrupted."""

import io
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from lossy_scenes import cable

from tline.compiled import announce
from tline.compiled.announce import announced
from tline.errors import InputError
from tline.solver.description import slab
from tline.solver.result.accuracy import Attempt
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.solver.tolerance import ladder as budgets
from tline.solver.tolerance.ladder import Budget
from tline.words import progress
from tline.words.progress import Progress
from tline.workers import Workers, interrupts_deferred


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    """A clock that goes on when it is told to, with the timers that ring then."""

    def __init__(self):
        self.now, self.timers = 0.0, []

    def timer(self, delay, function, arguments):
        waiting = [self.now + delay, function, arguments]
        return SimpleNamespace(start=lambda: self.timers.append(waiting), cancel=lambda: self.timers.remove(waiting))

    def go_on(self, seconds: float) -> None:
        self.now += seconds
        for due, function, arguments in self.timers:
            if due <= self.now:
                function(*arguments)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Of a process that has compiled nothing."""
    clock = Clock()
    monkeypatch.setattr(announce, "_spent", {})
    monkeypatch.setattr(announce, "_said", set())
    monkeypatch.setattr(announce, "Timer", clock.timer)
    monkeypatch.setattr(announce, "time", SimpleNamespace(perf_counter=lambda: clock.now))
    return clock


def test_what_takes_long_is_said_once_while_it_compiles(monkeypatch: pytest.MonkeyPatch, clock: Clock):
    monkeypatch.setattr("sys.stderr", terminal := Terminal())
    for _ in range(2):
        with announced("tline.solver.kernel.diamonds.cells"):
            clock.go_on(1.1)
            assert terminal.getvalue() == "compiling for losses, once, some 3 s\n"
    with announced("tline.solver.kernel.fronts.advance"):
        clock.go_on(1.1)
    assert terminal.getvalue().splitlines()[1:] == ["compiling for fronts, once, some 5 s"]


def test_what_is_short_is_not_said_but_adds_up(monkeypatch: pytest.MonkeyPatch, clock: Clock):
    monkeypatch.setattr("sys.stderr", terminal := Terminal())
    with announced("tline.solver.kernel.laws.pump"):
        clock.go_on(0.6)
    clock.go_on(2.0)
    assert terminal.getvalue() == ""
    with announced("tline.solver.kernel.laws.table"):
        clock.go_on(0.6)
    assert terminal.getvalue() == "compiling for non-linear elements, once, some 3 s\n"


def test_nothing_is_said_where_nobody_looks(monkeypatch: pytest.MonkeyPatch, clock: Clock):
    monkeypatch.setattr("sys.stderr", pipe := io.StringIO())
    with announced("tline.solver.kernel.diamonds.cells"):
        clock.go_on(2.0)
    assert pipe.getvalue() == ""


def test_short_work_shows_no_bar_and_does_not_import_one():
    code = (
        "import sys; from tline.words.progress import Progress\n"
        "with Progress(3, 'slab', True) as bar: bar.update(); bar.update(2)\n"
        "print('tqdm' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("False\n", "")


def test_long_work_shows_all_that_is_done(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(progress, "DELAY", 0.0)
    with Progress(3, "slab", True, "stepping") as bar:
        bar.update()
        bar.update(2)
    out, err = capsys.readouterr()
    assert out == ""
    assert "stepping: 100%" in err
    assert "3/3" in err


def test_no_bar_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(progress, "DELAY", 0.0)
    with Progress(3, "slab", False) as bar:
        bar.update(3)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("losses", "tol"), [({"resistance": 20}, 1e-13), ({"skin": {"resistance": 60, "frequency": "10 GHz"}}, 1e-8)]
)
def test_two_runs_and_what_they_differ_by_are_left_where_there_is_no_time(losses, tol):
    scene = cable(**losses, t_end="20 ns").table()
    scene["loads"]["d"] = {"at": "b", "kind": "diode", "saturation": 1e-9}
    result = simulate(scene, tol=tol, seconds=1e-6)
    accuracy = result.accuracy
    assert not accuracy.met
    assert tol < accuracy.worst < 1
    assert "beyond 1e-06 s" in accuracy.limit or "inside slabs" in accuracy.limit
    close = simulate(scene, tol=1e-4)
    t = result.t[1:]
    for name, told in accuracy.inside.items():
        u = close.probes[name].at(t).u
        assert abs(result.probes[name].at(t).u - u).max() <= (3 * told.u + 1e-4) * abs(u).max()


def test_time_is_asked_in_seconds():
    with pytest.raises(InputError, match="seconds: duration out of range"):
        simulate(cable(t_end="2 ns"), seconds=-1)


def test_what_is_expected_is_said_once_after_two_seconds(monkeypatch, capsys):
    now = [0.0]
    monkeypatch.setattr(time, "process_time", lambda: now[0])
    budget = Budget(100, shown=True)
    runs = [Attempt(5, 0.1, None, 1000, 1.0), Attempt(5, 0.05, 1e-3, 2000, 2.0)]
    for passed in (1.0, 3.0, 4.0):
        now[0] = passed
        assert not budget.limit(runs, 1e-4)
    said = "some 60 s more are expected\n"  # 2 s times 2, 4, 8 and 16, at half an error a run
    assert capsys.readouterr().err == said
    now[0] = 60.0
    assert budget.limit(runs, 1e-4) == "a finer run would take the total beyond 100 s"


def test_what_compiling_takes_does_not_count_and_a_search_leaves_what_others_need(monkeypatch):
    now, compiling = [0.0], [0.0]
    monkeypatch.setattr(time, "process_time", lambda: now[0])
    monkeypatch.setattr(budgets, "compiling_seconds", lambda: compiling[0])
    budget = Budget(20)
    now[0] = 32.0
    compiling[0] = 30.0
    assert budget.left == 18
    search = budget.keeping(lambda boils: 10.0 if boils else 0.0)
    now[0] = 35.0
    runs = [Attempt(1, 0.1, None, 1000, 1.0), Attempt(1, 0.05, 1e-1, 2000, 2.0)]
    assert not search.limit(runs, 1e-2, best=False)  # 5 s, and twice the 2 s of the last run: less than 20 s
    now[0] = 37.0
    assert search.limit(runs, 1e-2, best=True) == "a finer run would take the total beyond 10 s"
    assert not search.limit(runs, 1e-2, best=False)


def test_an_oscillation_that_no_affordable_run_follows_ends_a_search_at_once(monkeypatch):
    """An LC section rings a hundred million times until the end."""
    monkeypatch.setattr(slab, "CHEAP", 1e4)
    scene = {
        "medium": "electrical", "t_end": "1 ms", "probes": {"p": {"at": "c"}},
        "lines": {"line": {"nodes": ["a", "b"], "z0": 50, "delay": "10 us"}},
        "sources": {"s": {"at": "a", "kind": "voltage", "resistance": 50,
                          "value": {"shape": "sine", "amplitude": 1, "frequency": "5 kHz"}}},
        "links": {"l": {"kind": "inductor", "nodes": ["b", "c"], "inductance": "1 nH"}},
        "loads": {"c": {"at": "c", "kind": "capacitor", "capacitance": "0.4 pF"}},
    }  # fmt: skip
    with pytest.warns(UnresolvedWarning, match="damped, not resolved"):
        accuracy = simulate(scene, tol=1e-4, seconds=5).accuracy
    assert accuracy.limit == "a run in which no oscillation passes unseen would take the total beyond 5 s"
    assert len(accuracy.attempts) == 2


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
