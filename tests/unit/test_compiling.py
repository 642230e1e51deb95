import io
import time

import pytest

from tline import compiling
from tline.compiling import announced


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def patient(monkeypatch: pytest.MonkeyPatch, stream: io.StringIO) -> io.StringIO:
    """A stream in place of stderr, and a shorter patience, in a process that has compiled nothing."""
    monkeypatch.setattr("sys.stderr", stream)
    monkeypatch.setattr(compiling, "_spent", {})
    monkeypatch.setattr(compiling, "_said", set())
    monkeypatch.setattr(compiling, "PATIENCE", 0.1)
    return stream


def test_what_takes_long_is_said_once_while_it_compiles(monkeypatch: pytest.MonkeyPatch):
    terminal = patient(monkeypatch, Terminal())
    for _ in range(2):
        with announced("tline.solver.kernel.losses.memory"):
            time.sleep(0.4)
            said = terminal.getvalue()
        assert said == "compiling for losses, once, some 3 s\n"
    with announced("tline.solver.kernel.fronts.advance"):
        time.sleep(0.4)
    assert terminal.getvalue().splitlines()[1:] == ["compiling for fronts, once, some 10 s"]


def test_what_is_short_is_not_said_but_adds_up(monkeypatch: pytest.MonkeyPatch):
    terminal = patient(monkeypatch, Terminal())
    with announced("tline.solver.kernel.laws.pump"):
        pass
    time.sleep(0.2)
    assert terminal.getvalue() == ""
    with announced("tline.solver.kernel.laws.pump"):
        time.sleep(0.08)
    with announced("tline.solver.kernel.laws.table"):
        time.sleep(0.08)
    assert terminal.getvalue() == "compiling for non-linear elements, once, some 5 s\n"


def test_nothing_is_said_where_nobody_looks(monkeypatch: pytest.MonkeyPatch):
    pipe = patient(monkeypatch, io.StringIO())
    with announced("tline.solver.kernel.losses.memory"):
        time.sleep(0.2)
    assert pipe.getvalue() == ""
