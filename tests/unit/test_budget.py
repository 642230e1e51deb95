"""Runs end in time with the best so far, and say what they expect to take."""

import time

import pytest
from lossy_scenes import cable

from tline.errors import InputError
from tline.solver.description import slab
from tline.solver.result.accuracy import Attempt
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.solver.tolerance import ladder as budgets
from tline.solver.tolerance.ladder import Budget


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
