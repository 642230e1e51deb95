"""Many runs in one call: what they refuse, and what they say of their accuracy."""

import numpy as np
import pytest

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.many import many
from tline.solver.simulate import UnresolvedWarning

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


LOSSY = {"nodes": ["a", "b"], "z0": 50.0, "delay": 1.0, "length": 1.0, "resistance": 1.0}
SWITCH = {"at": "b", "kind": "switch", "before": 1, "after": 2, "time": 1}
PULSES = {"shape": "pulses", "high": 1.0, "width": 0.1, "rise": 0.01, "fall": 0.01, "period": 0.5}


@pytest.mark.parametrize(
    ("more", "where"),
    [
        ({"start": "steady"}, "start: many runs begin at rest"),
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
        ({"t_end": 1e9}, "t_end: a copy takes"),
        ({"lines": {"two": {"nodes": ["b", "c"], "z0": 75.0, "delay": 2**0.5}}}, "no common measure"),
        ({"sources": {"s": {"at": "a", "kind": "voltage", "value": PULSES}}}, "too many jumps and corners"),
    ],
)
def test_scenes_that_it_does_not_take(more, where):
    with pytest.raises(InputError, match=where):
        many(scene(**more), Z0)


@pytest.mark.parametrize(
    ("vary", "more", "where"),
    [
        ({}, {}, "vary: not as many numbers of each, .*got none"),
        ({"lines.one.z": [1.0]}, {}, "lines.one.z: no number of the scene that may vary, expected .*lines.one.z0"),
        ({"loads.r.capacitance": [1.0]}, {}, "loads.r.capacitance: no number of the scene"),
        ({**Z0, "lines.two.z0": [1.0]}, {}, "vary: not as many numbers of each, .*got 2 of lines.one.z0, 1 of"),
        ({"lines.one.z0": [50.0, -1.0]}, {}, "lines.one.z0: out of range in copy 1, .*got -1"),
        ({"lines.one.z0": [50.0, np.nan]}, {}, "lines.one.z0: out of range in copy 1, .*got nan"),
        ({"lines.one.z0": [[50.0]]}, {}, "lines.one.z0: not one number for each copy"),
        ({"lines.one.z0": ["fifty"]}, {}, "lines.one.z0: not numbers"),
        ({"lines.one.z0": []}, {}, "vary: not a number of copies"),
        ({"lines.one.delay": [1.0, 1.1]}, {}, "the delays of copy 1 are not in the proportion"),
        (Z0, {"times": [1.0, 10.0]}, "times: not instants of the run, .*got 10 s"),
        (Z0, {"times": [np.nan]}, "times: not instants of the run"),
        (Z0, {"times": ["soon"]}, "times: not numbers"),
        (Z0, {"tol": 1e-12}, "tol: tolerance out of range, expected at least 1e-09"),
    ],
)
def test_numbers_that_it_does_not_take(vary, more, where):
    with pytest.raises(InputError, match=where):
        many(scene(), vary, **more)


def test_without_sources_nothing_happens():
    runs = many(Scene(**{**scene().table(), "sources": {}}), Z0)
    assert (runs.order, runs.slabs, runs.probes["p"].highest.tolist()) == (2, 1, [0.0, 0.0])


def test_a_load_too_fast_is_told():
    fast = {"x": {"at": "b", "kind": "series", "resistance": 1.0, "capacitance": 1e-10}}
    with pytest.warns(UnresolvedWarning, match="too fast for many runs"):
        runs = many(scene(loads=fast), {"loads.x.capacitance": [1e-10, 2e-10]}, tol=1e-9)
    assert runs.estimate > 1e-9
