"""The witness takes the result of a scene for right, and that of another scene for wrong."""

import pytest

from tline import Scene, simulate
from tline.solver.description.description import describe
from tline.solver.witness.witness import Witness

PIPE = {"wave_speed": "1000 m/s", "diameter": "0.2 m", "density": "1000 kg/m^3"}
RATED = {"flow": "5 L/s", "pressure_drop": "1 bar"}
WATER = {
    "medium": "hydraulic", "t_end": "1 s", "start": "steady", "probes": {"end": {"at": "c"}, "mid": {"at": "b"}},
    "lines": {
        "p": PIPE | {"nodes": ["a", "b"], "length": "100 m"}, "q": PIPE | {"nodes": ["b", "c"], "length": "87 m"},
    },
    "loads": {
        "lake": {"at": "a", "kind": "reservoir", "pressure": "2 bar"},
        "valve": {"at": "c", "kind": "valve", "before": 1e7, "after": 1e8, "time": "0.2 s"},
        "out": {"at": "c", "kind": "relief valve", "set_pressure": "2.2 bar", "band": "1 bar"} | RATED,
        "tank": {"at": "b", "kind": "surge tank", "tank_diameter": "2 cm", "density": 1000},
    },
}  # fmt: skip
VESSEL = {"at": "b", "kind": "air vessel", "gas_volume": "10 L", "gas_pressure": "2 bar"} | RATED
CABLE = {
    "medium": "electrical", "t_end": "40 ns", "probes": {"far": {"at": "far"}},
    "lines": {"l": {"nodes": ["near", "mid"], "z0": 50, "delay": "3.3 ns"},
              "m": {"nodes": ["mid", "far"], "z0": 70, "delay": "4.5 ns"}},
    "sources": {"s": {"at": "near", "kind": "voltage", "resistance": 30,
                      "value": {"shape": "ramp", "to": 1, "at": "1 ns", "duration": "2 ns"}}},
    "loads": {"c": {"at": "far", "kind": "parallel", "resistance": 100, "capacitance": "20 pF"},
              "d": {"at": "mid", "kind": "diode", "saturation": "1 nA"}},
}  # fmt: skip
SCENES = {"water": WATER, "gas": WATER | {"loads": WATER["loads"] | {"tank": VESSEL}}, "cable": CABLE}
OTHER = (
    ("water", "loads.valve.after", 1.1e8),
    ("water", "loads.valve.time", 0.8),
    ("water", "loads.out.flow", 0.01),
    ("water", "loads.out.set_pressure", 2.0e5),
    ("water", "loads.tank.tank_diameter", 0.021),
    ("water", "loads.lake.pressure", 2.01e5),
    ("water", "lines.q.length", 88),
    ("gas", "loads.tank.flow", 0.002),
    ("cable", "loads.c.capacitance", 21e-12),
    ("cable", "loads.c.resistance", 105),
    ("cable", "loads.d.saturation", 1e-8),
    ("cable", "sources.s.resistance", 31),
    ("cable", "sources.s.value.to", 1.01),
)


@pytest.fixture(scope="module")
def results():
    """With the waves of all lines."""
    return {name: simulate(table, tol=1e-4, record=table["lines"]) for name, table in SCENES.items()}


@pytest.mark.parametrize("name", list(SCENES))
def test_what_is_right_is_taken_for_right(name, results):
    result = results[name]
    assert result.accuracy.met
    assert Witness(describe(result.scene)).heard(result) is result


@pytest.mark.parametrize(("name", "path", "value"), OTHER)
def test_what_is_of_another_scene_is_not(name, path, value, results):
    other = Scene(**SCENES[name]).change({path: value})
    heard = Witness(describe(other)).heard(results[name])
    assert heard.accuracy.limit.startswith("two methods disagree at ")
    assert not heard.accuracy.met
    assert "NOT met" in repr(heard)


def test_lines_that_it_needs_are_not_given_out():
    assert set(simulate(CABLE, tol=1e-4).lines) == {"m"}
