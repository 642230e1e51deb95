"""A prepared run is that of the changed scene; what does not fit is told by its path."""

import copy
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

import numpy as np
import pytest

from tline.errors import InputError
from tline.scene.changed import changed, parts_of
from tline.scene.file import read_scene
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.solver.prepared import prepare
from tline.solver.result.result import ProbeResult, Result
from tline.solver.simulate import simulate

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
SCENES = Path(__file__).parents[2] / "scenes"
ALL = sorted(path.stem for path in SCENES.glob("*.toml"))
# seconds each
SLOW = {"coax_fault", "column_separation", "hydraulic_hose", "lossy_cable", "stripline_eye", "tabulated_cable", "town"}
ROUNDING = 1e-11
TOL = 1e-4


def quantities(scene: Scene) -> list[tuple[str, float]]:
    """Paths of quantities that were given as numbers or texts, and their values in SI."""
    return [
        (f'{section}."{name}".{key}', float(value))
        for section in ("lines", "sources", "loads", "links")
        for name, element in getattr(scene, section).items()
        if (section, name) not in scene.parts and (section != "lines" or name not in scene.delay_lines)
        for key in element.table()
        if isinstance(value := getattr(element, key, None), Quantity) and 0 < value < np.inf
    ]


def drawn(scene: Scene, rng: Random) -> dict[str, float]:
    chosen = rng.sample(known := quantities(scene), min(2, len(known)))
    return {path: value * rng.uniform(0.8, 1.25) for path, value in chosen}


def written(scene: Scene, values: dict) -> Scene:
    """The scene as a file with these values would give it."""
    table = copy.deepcopy(scene.table())
    for path, value in values.items():
        section, name, key = parts_of(path)
        table[section][name][key] = value
    return scene.with_changes(**table)


@pytest.mark.parametrize("name", ALL)
def test_a_changed_scene_is_the_one_that_a_file_with_these_values_gives(name):
    scene, rng, kept = read_scene(SCENES / f"{name}.toml"), Random(name), 0
    for _ in range(6):
        values = drawn(scene, rng)
        try:
            expected = written(scene, values)
        except InputError:
            with pytest.raises(InputError):
                changed(scene, values)
            continue
        kept += 1
        found = changed(scene, values)
        assert found == expected
        assert found.heights == expected.heights
        assert [line.parameters.delay for line in found.single_lines.values()] == [
            line.parameters.delay for line in expected.single_lines.values()
        ]
    assert kept or not quantities(scene)


@pytest.mark.parametrize("name", [name for name in ALL if name not in SLOW | {"ten_drop_bus"}])
def test_a_prepared_run_is_that_of_the_changed_scene(name):
    scene, rng = read_scene(SCENES / f"{name}.toml"), Random(name)
    prepared = prepare(scene)
    assert same(prepared.run(tol=TOL), simulate(scene, tol=TOL))
    values = drawn(scene, rng)
    expected = outcome(lambda: simulate(written(scene, values), tol=TOL))
    found = outcome(lambda: prepared.run(values, tol=TOL))
    if isinstance(expected, InputError):
        assert isinstance(found, InputError)
        assert found.problem.rpartition(": ")[2] in str(expected)
        return
    assert isinstance(found, Result)
    assert found.scene == expected.scene
    assert found.accuracy is not None
    assert expected.accuracy is not None
    assert found.accuracy.met >= expected.accuracy.met
    assert same(found, expected)


def outcome(make: Callable[[], Result]) -> Result | InputError:
    try:
        return make()
    except InputError as error:
        return error


def same(found: Result, expected: Result) -> bool:
    """Whether two results agree to rounding, or within their errors if they were found in other ways."""
    one, other = ([(each.order, each.slab) for each in result.accuracy.attempts] for result in (found, expected))
    alike = one == other
    return all(
        close(probe, expected.probes[name], alike, sum(told(each, name) for each in (found, expected)))
        for name, probe in found.probes.items()
    )


def told(result: Result, name: str) -> float:
    assert result.accuracy is not None
    return result.accuracy.inside[name].worst


def close(one: ProbeResult, other: ProbeResult, alike: bool, error: float) -> bool:
    t = other.t if alike else other.t[other.t <= one.t[-1]]
    for letter in "uy":
        a, b = (getattr(each.at(t), letter) for each in (one, other))
        scale = max(np.abs(b).max(), 1e-9 * np.abs(other.u).max() / (1.0 if letter == "u" else other.record.z0))
        if np.abs(a - b).max() > (ROUNDING if alike else 2 * error) * scale:
            return False
    return True


@pytest.fixture(scope="module")
def prepared():
    return prepare(read_scene(SCENES / "cable_rc.toml"))


def test_values_of_an_earlier_run_do_not_stay(prepared):
    first = prepared.run(tol=1e-6)
    prepared.run({"loads.receiver.capacitance": "40 pF", "t_end": "5 ns"}, tol=1e-6)
    again = prepared.run(tol=1e-6)
    assert again.t[-1] == first.t[-1]
    assert same(again, first)


@pytest.mark.parametrize(
    ("name", "path", "values"),
    [
        ("diode_clamp", "lines.cable.z0", (48.0, 51.0, 49.0, 60.0)),
        ("valve_closure", "lines.pipe.density", (980.0, 990.0, 970.0, 900.0)),
        ("valve_closure", "lines.pipe.diameter", (0.29, 0.31, 0.3, 0.35)),
        ("valve_closure", "t_end", (5.0, 5.1, 5.2, 7.3)),
    ],
)
def test_values_of_lines_and_times_are_those_of_the_last_run(name, path, values):
    """On a plan, too: the impedance of a line is not an element's, and weighs at both of its nodes."""
    scene = read_scene(SCENES / f"{name}.toml")
    ready = prepare(scene)
    for value in values:
        seen = ready.run({path: value}, tol=1e-6)
    truth = simulate(changed(scene, {path: values[-1]}), tol=1e-9)
    assert seen.slabs.end == truth.slabs.end
    t = np.linspace(0.0, truth.slabs.end, 200)
    for probe, expected in truth.probes.items():
        for letter in "uy":
            ours, theirs = (getattr(each.at(t), letter) for each in (seen.probes[probe], expected))
            np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-6 * np.abs(theirs).max())


def test_texts_have_units_and_numbers_are_in_si(prepared):
    one, other = (prepared.run({"loads.receiver.capacitance": value}, tol=1e-6) for value in ("5 pF", 5e-12))
    assert same(one, other)
    assert one.scene.loads["receiver"].capacitance == 5e-12


def test_a_search_begins_where_the_last_one_ended(prepared):
    orders = []
    for capacitance in ("100 pF", "101 pF", "102 pF"):  # driven hard, so that the first order is too low
        values = {"loads.receiver.capacitance": capacitance, "sources.driver.resistance": 1}
        attempts = prepared.run(values, tol=1e-5).accuracy.attempts
        orders.append([attempt.order for attempt in attempts])
    assert len(orders[1]) == len(orders[2]) == 2 < len(orders[0])
    assert orders[1][0] == orders[0][-2]


def test_threads_and_errors_change_no_results(prepared):
    asked = [None if k % 3 == 0 else {"loads.receiver.capacitance": (3 + k / 5) * 1e-12} for k in range(12)]
    asked.insert(5, {"loads.receiver.resistance": -3})
    expected = [outcome(lambda values=values: prepared.run(values, tol=1e-6)) for values in asked]
    with ThreadPoolExecutor(2) as threads:
        found = list(threads.map(lambda values: outcome(lambda: prepared.run(values, tol=1e-6)), asked))
    assert isinstance(expected[5], InputError)
    assert str(found.pop(5)) == str(expected.pop(5))
    for one, other in zip(found, expected, strict=True):
        assert isinstance(one, Result)
        assert isinstance(other, Result)
        assert same(one, other)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"loads.receiver.capacitance": "5 m"}, "loads.receiver.capacitance: this unit measures something else"),
        ({"loads.receiver.capacity": 1}, "loads.receiver.capacity: unknown key"),
        ({"loads.reciever.capacitance": 1}, "loads.reciever.capacitance: no such element, expected 'receiver'"),
        ({"load.receiver.capacitance": 1}, "load.receiver.capacitance: no such key"),
        ({"loads.receiver": 1}, "loads.receiver: "),
        ({"loads": 1}, "loads: not a value"),
        ({"loads..capacitance": 1}, "loads..capacitance: not a path"),
        ({"loads.receiver.capacitance.x": 1}, "loads.receiver.capacitance.x: not a table"),
        ({"t_end": -1}, "t_end: duration out of range"),
        ({"solver.slab": "1 s"}, "solver.slab: longer than the shortest delay"),
        ({"sources.driver.resistance": 0, "loads.receiver.resistance": -3}, "loads.receiver.resistance: "),
        ({"probes.far.at": "nowhere"}, "probes.far.at: no line ends at this node"),
    ],
)
def test_what_does_not_fit_is_told_in_one_sentence(prepared, values, said):
    with pytest.raises(InputError) as told:
        prepared.run(values, tol=1e-3)
    assert str(told.value).startswith(said)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", [name for name in ALL if name not in SLOW | {"pipe_friction", "summit", "ddr_ibis"}])
def test_a_rough_tolerance_takes_fewer_samples_than_a_fine_one(name):
    scene = read_scene(SCENES / f"{name}.toml")
    results = [simulate(scene, tol=tol).accuracy for tol in (1e-3, 1e-6)]
    taken = [sum(attempt.samples for attempt in accuracy.attempts) for accuracy in results if accuracy]
    assert taken[0] < taken[1] or scene.solver.slab


@pytest.mark.parametrize(
    ("impedance", "name", "said"),
    [("R + 1/(s*C)", "R", "its impedance vanishes at high frequency"), ("s*C", "C", "is already held by")],
)
def test_a_value_that_lets_elements_exclude_each_other_is_refused(impedance, name, said):
    parameters = {name: 1e-12 for name in "RC" if name in impedance}
    tables = {
        "lines": {"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}},
        "sources": {"driver": {"at": "near", "kind": "voltage", "value": 1}},
        "loads": {"x": {"at": "near", "kind": "impedance", "expression": impedance, "parameters": parameters}},
        "probes": {"far": {"at": "far"}},
    }
    ready = prepare(Scene(medium="electrical", t_end="4 ns", **tables))
    ready.run({f"loads.x.parameters.{name}": 2e-12})
    with pytest.raises(InputError, match=said):
        ready.run({f"loads.x.parameters.{name}": 0})
