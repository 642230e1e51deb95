"""What is valid in a scene and yet probably not meant."""

import pytest

from tline import InputError, Scene
from tline.scene.load import Parallel
from tline.scene.plausible import plausibility_notes

PIPE = {"nodes": ["tank", "valve"], "length": "300 m", "radius": "10 cm", "fluid": "water"}


def scene(**changes) -> Scene:
    table = {
        "medium": "hydraulic",
        "t_end": "2 s",
        "lines": {"pipe": PIPE},
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": "3 bar"}},
        "probes": {"valve": {"at": "valve"}},
    }
    return Scene(**table | changes)


def valve(time) -> dict:
    return {"v": {"at": "valve", "kind": "valve", "before": "90 bar/(m^3/s)", "after": "inf", "time": time}}


def source(**waveform) -> dict:
    return {"s": {"at": "tank", "kind": "pressure", "value": {"to": "3 bar", "shape": "step"} | waveform}}


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"loads": valve("5 s")}, "loads.v (5 s): nothing changes there before the run ends at 2 s"),
        ({"loads": valve("2 s")}, "loads.v (2 s): nothing changes there before the run ends at 2 s"),
        ({"loads": valve("-1 s")}, "loads.v (-1 s): moved before the run begins"),
        (
            {"loads": {}, "sources": source(at="3 s")},
            "sources.s (3 s): nothing changes there before the run ends at 2 s",
        ),
        (
            {"lines": {"ring": PIPE | {"nodes": ["tank", "tank"]}}, "probes": {"tank": {"at": "tank"}}},
            "lines.ring: both ends are at one node",
        ),
        (
            {"lines": {name: PIPE | {"density": "1 kg/L", "nodes": ["tank", name]} for name in ("valve", "b")}},
            "lines.valve, lines.b: density: 1000 kg/m^3 as given, instead of 998.207 kg/m^3 of the fluid",
        ),
        (
            {
                "lines": {"pipe": PIPE | {"length": "300", "radius": "0.1"}},
                "loads": {},
                "sources": source(to="3", at="1"),
            },
            "taken as SI for want of a unit: lines.pipe.radius = '0.1' (m), lines.pipe.length = '300' (m), "
            "sources.s.value.to = '3' (Pa) and 1 more",
        ),
    ],
)
def test_what_is_probably_not_meant_is_said_in_one_sentence(changes: dict, note: str) -> None:
    assert plausibility_notes(scene(**changes)) == [note]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"loads": valve("0.1 s")},
        {"loads": {}, "sources": source(at="-1 s")},
        {"lines": {"pipe": PIPE | {"length": 300}}, "t_end": 2.0},  # a number needs no unit
    ],
)
def test_nothing_is_said_of_what_is_plain(changes: dict) -> None:
    assert plausibility_notes(scene(**changes)) == []


def test_ohms_and_volts_need_no_unit() -> None:
    cable = {"nodes": ["near", "far"], "z0": "50", "delay": "1 ns"}
    drive = {"at": "near", "kind": "voltage", "value": "1", "resistance": "20"}
    end = {"at": "far", "kind": "resistor", "resistance": "75"}
    lines, sources, loads, probes = {"cable": cable}, {"s": drive}, {"end": end}, {"far": {"at": "far"}}
    plain = Scene(medium="electrical", t_end="1 us", lines=lines, sources=sources, loads=loads, probes=probes)
    assert plausibility_notes(plain) == []


def test_a_negative_resistance_leads_to_an_active_impedance() -> None:
    with pytest.raises(InputError, match=r"kind = 'impedance' with expression = '-30', which runs with --active, got"):
        scene(loads={"r": {"at": "valve", "kind": "resistor", "resistance": "-30 Pa s/m^3"}})
    with pytest.raises(InputError, match=r"more than 0, or kind = 'impedance' with expression = '-5'"):
        Parallel(at="valve", resistance=-5)
    with pytest.raises(InputError, match=r"more than 0, got 0$"):
        Parallel(at="valve", resistance=0)
