"""Runs with other values on a pair of orders are those of the changed scene, within what they tell."""

import numpy as np
import pytest

import tline as tl
from tline.solver.plan import Pair, Plan, planned
from tline.solver.prepared import prepare

TOL, CLOSE, ROUNDING = 1e-6, 1e-10, 1e-11
VARIED = [
    ("valve_closure", "loads.valve.opening.duration", [0.91, 1.7]),  # corners inside slabs
    ("valve_closure", "loads.valve.kv", [150, 260]),  # another steady state
    ("diode_clamp", "sources.driver.resistance", [12.0]),
    ("diode_clamp", "links.clamp.saturation", [2e-12]),  # between nodes
]


@pytest.mark.parametrize(("name", "path", "values"), VARIED)
def test_a_run_on_a_pair_is_within_what_it_tells(name, path, values):
    scene = tl.examples[name]
    prepared = prepare(scene).fix()
    for value in values:
        result = prepared.run({path: value}, tol=TOL)
        assert isinstance(prepared._plans[TOL], Pair)
        assert not isinstance(prepared._plans[TOL], Plan)
        assert len(result.accuracy.attempts) == 2
        assert result.accuracy.met
        exact = tl.simulate(scene.change({path: value}), tol=CLOSE)
        t = np.sort(np.random.default_rng(0).uniform(0, result.t[-1], 500))
        for probe, seen in result.probes.items():
            for letter in "uy":
                found, right = (getattr(each.at(t), letter) for each in (seen, exact.probes[probe]))
                error = np.abs(found - right).max() / np.abs(right).max()
                assert error <= result.accuracy.worst + ROUNDING


@pytest.mark.parametrize("name", ["town", "column_separation"])
def test_what_needs_a_search_has_no_pair(name):
    scene = tl.examples[name]
    assert scene.solver.slab or planned(prepare(scene).description, TOL) is None
