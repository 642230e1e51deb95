"""A vessel that a constant flow empties, by its volume over the flow."""

import pytest

import tline as tl
from tline.errors import InputError
from tline.surge.worst import EMPTIES, worst

GAS, TOTAL, FLOW = 0.2, 0.3, 0.05


def scene(total: float) -> tl.Scene:
    vessel = {"at": "far", "kind": "air vessel", "gas_pressure": "4 bar", "gas_volume": GAS, "total_volume": total}
    pipe = {"length": "20 m", "diameter": "30 cm", "wave_speed": 1000, "density": 1000}
    drawn = {"at": "near", "kind": "flow", "value": {"shape": "ramp", "to": -FLOW, "at": "0.5 s", "duration": "0.5 s"}}
    return tl.Scene(
        medium="hydraulic",
        t_end="4 s",
        start="steady",
        lines={"pipe": {"nodes": ["near", "far"], **pipe}},
        sources={"drawn": drawn},
        loads={"vessel": vessel},
        probes={"far": {"at": "far"}},
        nodes={"near": {"start": "4 bar"}},
    )


def test_the_instant_is_told_and_no_class_is_named():
    result = tl.simulate(scene(TOTAL), tol=1e-4, envelope=True)
    (note,) = (note for note in result.notes if "it is empty" in note)
    told = float(note.partition("after ")[2].partition(" s")[0])
    # half of the ramp, 20 ms for the wave, and a swing of the vessel on the pipe that averages out
    assert told == pytest.approx(0.77 + (TOTAL - GAS) / FLOW, abs=0.02)
    assert "its 0.3 m^3 are gas, which would enter the pipe" in note
    assert worst(result).untold == EMPTIES


def test_a_larger_one_does_not():
    result = tl.simulate(scene(2.0), tol=1e-4, envelope=True)
    assert not any("it is empty" in note for note in result.notes)
    assert worst(result).untold != EMPTIES


def test_without_room_for_liquid_it_is_refused():
    with pytest.raises(InputError, match=r"total_volume: no room for liquid, expected more than the gas, 0\.2 m\^3"):
        scene(0.1)
