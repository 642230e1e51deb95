"""Runs by a plan are those of the changed scene, within what they tell; what it cannot follow is run without one."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from one_line import one_line
from random_scenes import random_scene

from tline import ActiveError, Prepared, Result, Scene, prepare, simulate

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
TOL, CLOSE, ROUNDING = 1e-6, 1e-11, 1e-11


def on_a_grid(seed: int) -> Scene:
    """A random linear scene whose delays are quarters of a second."""
    scene = random_scene(seed, switches=False, sources=True)
    return scene.change({f"lines.{name}.delay": round(4 * line.delay) / 4 for name, line in scene.lines.items()})


def numbers(scene: Scene) -> list[str]:
    """Paths of what loads and sources are made of."""
    loads = [
        f"loads.{name}.{key}"
        for name, load in scene.loads.items()
        for key in ("resistance", "inductance", "capacitance")
        if getattr(load, key, None)
    ]
    return [*loads, "sources.s.resistance", "sources.s.value.amplitude"]


def value_at(scene: Scene, path: str) -> float:
    found = scene.table()
    for key in path.split("."):
        found = found[key]
    return float(found)


def planned(prepared: Prepared, values: dict) -> Result | None:
    return prepared.fix()._planned(prepared.description.changed(values), TOL)


def error(result: Result, exact: Result) -> float:
    """Largest error at random instants, of the amplitude of each quantity."""
    t, worst = np.sort(np.random.default_rng(0).uniform(0, result.slabs.end, 800)), 0.0
    for name, probe in result.probes.items():
        for key in "uy":
            seen, right = (getattr(each.at(t), key) for each in (probe, exact.probes[name]))
            if np.abs(right).max() > ROUNDING:
                worst = max(worst, np.abs(seen - right).max() / np.abs(right).max())
    return worst


@pytest.mark.parametrize("seed", range(12))
def test_a_run_by_a_plan_is_within_what_it_tells(seed):
    scene, rng = on_a_grid(seed), np.random.default_rng(seed)
    prepared = prepare(scene)
    for path in rng.permutation(numbers(scene))[:4]:
        values = {path: value_at(scene, path) * float(rng.uniform(0.7, 1.4))}
        result = planned(prepared, values)
        if result is not None:
            exact = simulate(scene.change(values), tol=CLOSE)
            assert result.scene == exact.scene
            assert result.accuracy.met
            assert error(result, exact) <= result.accuracy.worst + ROUNDING


def test_most_of_them_have_a_plan():
    """So that the test above is one."""
    found = [planned(prepare(scene), {"sources.s.resistance": 1.1}) for scene in map(on_a_grid, range(24))]
    assert sum(each is not None for each in found) >= 12


def cable(**load) -> Scene:
    loads = {"c": {"at": "far", "kind": "parallel", "resistance": 100, **load}}
    return one_line("40 ns", {"z0": 50, "delay": "5 ns"}, 1, 20, loads=loads)


@pytest.mark.parametrize(
    "values",
    [
        {"loads.c.capacitance": 1e-14},  # faster than slabs
        {"loads.c.capacitance": None},  # no state any more
        {"loads.c.inductance": "3 nH"},  # one more
        {"sources.s.value": {"shape": "step", "to": 1, "at": "1.234567 ns"}},  # a front inside a slab
        {"sources.s.resistance": 0},  # nothing of the lines' waves passes
        {"sources.s.value": {"shape": "sine", "amplitude": 1, "frequency": "40 GHz"}},
    ],
)
def test_what_makes_it_another_scene_is_run_as_that(values):
    scene, path = cable(capacitance="10 pF"), "loads.c.capacitance"
    prepared = prepare(scene)
    for farad in (11e-12, 12e-12):
        prepared.run({path: farad})
    result = prepared.run(values)
    assert error(result, simulate(scene.change(values), tol=1e-9)) <= 2 * TOL
    again, exact = prepared.run({path: 12e-12}), simulate(scene.change({path: 12e-12}), tol=CLOSE)
    assert error(again, exact) <= again.accuracy.worst


@pytest.mark.parametrize(
    "change", [{"solver": {"order": 3}}, {"solver": {"slab": "1 ns"}}, {"t_end": "1 ms"}, {"lines.line.delay": "1 ps"}]
)
def test_what_is_fixed_by_hand_or_long_has_no_plan(change):
    assert planned(prepare(cable(capacitance="10 pF").change(change)), {"loads.c.capacitance": 11e-12}) is None


def test_an_active_load_is_refused_by_a_plan_too():
    load = {"at": "far", "kind": "impedance", "numerator": [1, 300], "denominator": [1, 1]}
    prepared = prepare(cable(capacitance="10 pF").change({"loads.z": load}))
    values = {"sources.s.resistance": 30}
    prepared.run(values)
    prepared.run(values)
    with pytest.raises(ActiveError):
        prepared.run({"loads.z.numerator": [1, -300]})


def test_runs_by_a_plan_do_not_depend_on_those_before_nor_on_threads():
    scene, path = cable(capacitance="10 pF"), "loads.c.capacitance"
    values = [{path: 1e-12 * (8 + k % 5)} for k in range(40)]
    one, other = prepare(scene), prepare(scene)
    for prepared in (one, other):
        prepared.run({path: 9e-12})
        prepared.fix()
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(one.run, values))
    for given, result in reversed([*zip(values, found, strict=True)]):
        assert (result.probes["far"].u == other.run(given).probes["far"].u).all()


def test_a_result_stays_as_it_was_when_the_plan_runs_again():
    prepared = prepare(cable(capacitance="10 pF"))
    first = planned(prepared, {"loads.c.capacitance": 9e-12})
    seen = first.lines["line"].a2.values.copy()
    planned(prepared, {"loads.c.capacitance": 12e-12})
    assert (first.lines["line"].a2.values == seen).all()
