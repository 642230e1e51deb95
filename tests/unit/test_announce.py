"""What is said of work that takes long."""

import io
import subprocess
import sys
from types import SimpleNamespace

import pytest

from tline.compiled import announce
from tline.compiled.announce import announced
from tline.words import progress
from tline.words.progress import Progress


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
    assert terminal.getvalue().splitlines()[1:] == ["compiling for fronts, once, some 10 s"]


def test_what_is_short_is_not_said_but_adds_up(monkeypatch: pytest.MonkeyPatch, clock: Clock):
    monkeypatch.setattr("sys.stderr", terminal := Terminal())
    with announced("tline.solver.kernel.laws.pump"):
        clock.go_on(0.6)
    clock.go_on(2.0)
    assert terminal.getvalue() == ""
    with announced("tline.solver.kernel.laws.table"):
        clock.go_on(0.6)
    assert terminal.getvalue() == "compiling for non-linear elements, once, some 5 s\n"


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
