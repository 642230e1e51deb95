"""Which runs of a sweep are made side by side in compiled code, and which one at a time."""

import numpy as np
import pytest

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.many.runs import many_runs
from tline.solver.result.dense_output import extremes
from tline.solver.simulate import simulate
from tline.sweeps import sweep

Z0 = {"lines.one.z0": [50.0, 60.0]}


def scene(**more):
    data = {
        "medium": "electrical",
        "t_end": 9.0,
        "lines": {
            "one": {"nodes": ["a", "b"], "z0": 50.0, "delay": 1.0},
            "two": {"nodes": ["b", "c"], "z0": 75.0, "delay": 2.0},
        },
        "sources": {"s": {"at": "a", "kind": "voltage", "value": 1.0, "resistance": 25.0}},
        "loads": {"r": {"at": "c", "kind": "resistor", "resistance": 100.0}},
        "probes": {"p": {"at": "c"}},
    }
    for part, tables in more.items():
        data[part] = {**data[part], **tables} if isinstance(data.get(part), dict) else tables
    return Scene(**data)


COIL = {"at": "b", "kind": "series", "inductance": 1.0}
DIODE = {"at": "b", "kind": "diode", "saturation": 1e-9}
SWITCH = {"at": "b", "kind": "switch", "before": 1, "after": 2, "time": 1}
PULSES = {"shape": "pulses", "high": 1.0, "width": 0.1, "rise": 0.01, "fall": 0.01, "period": 0.5}


@pytest.mark.parametrize(
    ("more", "where"),
    [
        ({"start": "steady", "loads": {"x": COIL}}, "loads.x: an inductance in a steady state"),
        ({"loads": {"x": DIODE, "y": COIL}}, "loads.y: keeps a state beside elements with a law"),
        ({"loads": {"x": DIODE, "y": DIODE}}, "loads.y: stands beside another at node 'b'"),
        ({"solver": {"order": 4}}, "solver.order: many runs choose"),
        ({"solver": {"slab": 0.1}}, "solver.slab: many runs choose"),
        ({"links": {"d": {"kind": "diode", "nodes": ["b", "c"], "saturation": 1e-9}}}, "links.d: stands between"),
        (
            {"lines": {"one": {"nodes": ["a", "b"], "z0": 50.0, "delay": 1.0, "length": 1.0, "resistance": 1.0}}},
            "lines.one: has losses",
        ),
        (
            {"loads": {"x": SWITCH}},
            "loads.x: a load of kind",
        ),
        ({"loads": {"x": {"at": "b", "kind": "impedance", "expression": "1 + s"}}}, "loads.x: a load of kind"),
        (
            {"loads": {k: {"at": "b", "kind": "series", "resistance": 1, "capacitance": 1} for k in "xy"}},
            "loads.y: a second L or C",
        ),
        ({"probes": {"p": {"line": "one", "position": "50 %"}}}, "probes.p: inside a line"),
        ({"probes": {"p": {"at": "b"}}}, "probes.p: sees a node's effort alone"),
        ({"t_end": 1e9}, "t_end: a copy takes"),
        ({"lines": {"two": {"nodes": ["b", "c"], "z0": 75.0, "delay": 2**0.5}}}, "no common measure"),
        ({"sources": {"s": {"at": "a", "kind": "voltage", "value": PULSES}}}, "too many jumps and corners"),
    ],
)
def test_scenes_that_copies_do_not_take(more, where):
    with pytest.raises(InputError, match=where):
        many_runs(describe(scene(**more)), {"lines.one.z0": np.array([50.0, 60.0])}, 1e-6)


def test_without_sources_nothing_happens():
    runs = sweep(Scene(**{**scene().table(), "sources": {}}), Z0)
    assert runs.method == "vectorised"
    assert runs["highest"].tolist() == [[0.0], [0.0]]


def test_a_load_too_fast_side_by_side_is_run_one_at_a_time():
    fast = {"x": {"at": "b", "kind": "series", "resistance": 1.0, "capacitance": 1e-10}}
    runs = sweep(scene(loads=fast), {"loads.x.capacitance": [1e-10, 2e-10]}, tol=1e-6)
    assert runs.method.startswith("one at a time: solver.tol: the estimated error is ")


@pytest.mark.parametrize(
    ("vary", "why"),
    [
        ({"lines.one.delay": [1.0, 1.1]}, "the delays of copy 1 are not in the proportion"),
        ({"t_end": [8.0, 9.0]}, "t_end: is no number of lossless lines"),
        ({"loads.r.kind": ["resistor"]}, "loads.r.kind: is no number of lossless lines"),
    ],
)
def test_values_that_are_run_one_at_a_time(vary, why):
    runs = sweep(scene(), vary, tol=1e-3)
    assert why in runs.method
    assert (runs.done.all(), runs.errors) == (True, {})


def test_values_that_follow_from_others_are_run_one_at_a_time():
    """A cable of given length and capacitance: z0 changes its delay as well, which copies would not know."""
    line = {"nodes": ["a", "b"], "z0": 50.0, "length": 1.0, "capacitance": 0.02}
    runs = sweep(scene(lines={"one": line}), Z0, tol=1e-4)
    assert runs.method == "one at a time: what varies has an effect on other numbers"
    for k, z0 in enumerate(Z0["lines.one.z0"]):
        alone = simulate(scene(lines={"one": line | {"z0": z0}}), tol=1e-4).probes["p"]
        (_, _), (highest, _) = extremes(alone, "u")
        assert runs["highest"][k, 0] == pytest.approx(highest, abs=2e-4)


def test_numbers_out_of_range_are_rows_beside_vectorised_ones():
    runs = sweep(scene(), {"lines.one.z0": [50.0, -1.0, 60.0]})
    assert runs.method == "vectorised"
    assert runs.errors == {1: "lines.one.z0: z0 out of range, expected more than 0, got -1.0"}
    np.testing.assert_array_equal(runs["highest"][[0, 2]], sweep(scene(), Z0)["highest"])
    assert np.isnan(runs["highest"][1]).all()
