"""A scene that is simulated again is run once, as its search ended, and gives the same to the last bit."""

import numpy as np
import pytest

import tline as tl
from tline.solver.tolerance import search

INSTANTS = 501


@pytest.mark.parametrize("name", ["cable_rc", "valve_closure", "loop", "vessel_valve"])
def test_the_second_result_is_the_first(name):
    scene = tl.examples[name]
    first, second = tl.simulate(scene), tl.simulate(scene)
    assert second.accuracy == first.accuracy
    assert second.notes == first.notes
    assert second.resolution == first.resolution
    for probe, seen in first.probes.items():
        t = np.linspace(0.0, seen.t[-1], INSTANTS)
        assert np.array_equal(second.probes[probe].at(t).u, seen.at(t).u)


def test_nothing_is_searched_again_but_for_another_tolerance_or_line(monkeypatch):
    scene = tl.examples["cable_rc"]
    tl.simulate(scene)
    searches = []
    refined = search.refined
    monkeypatch.setattr(search, "refined", lambda *given: searches.append(given) or refined(*given))
    tl.simulate(scene)
    assert not searches
    finer = tl.simulate(scene, tol=1e-8)
    assert len(searches) == 1
    assert finer.accuracy is not None
    assert finer.accuracy.tol == 1e-8
    tl.simulate(scene.change({"loads.receiver.capacitance": "5 pF"}))
    assert len(searches) == 2


def test_a_result_shares_no_array_with_the_next():
    scene = tl.examples["cable_rc"]
    first, second = tl.simulate(scene), tl.simulate(scene)
    before = second.probes["far"].u.copy()
    first.lines["cable"].a2.values[:] = 0.0
    assert np.array_equal(second.probes["far"].u, before)
    assert np.array_equal(tl.simulate(scene).probes["far"].u, before)
