"""What is operated, and what is told of its surges."""

import pytest

from tline import InputError, Scene, simulate
from tline.surge.event import read_event


def test_a_second_stage_begins_where_the_first_one_ends():
    event = read_event("close", "V1@1s+2s:25%+8s")
    assert event.control(0.8, 0.0)["points"] == [[1.0, 0.8], [3.0, 0.2], [11.0, 0.0]]


def test_a_course_follows_its_file(tmp_path):
    file = tmp_path / "shut.csv"
    file.write_text("s,opening\n0,1\n2,0.3\n9,0\n")
    points = read_event("close", f"V1@1s:{file}").control(1.0, 0.0)["points"]
    assert points == [[1.0, 1.0], [3.0, 0.3], [10.0, 0.0]]
    assert read_event("close", f"V1@1s:{file}").control(0.5, 0.0)["points"][:2] == [[1.0, 0.5], [1.0, 1.0]]


def test_a_pump_goes_to_a_speed_or_along_a_course(tmp_path):
    file = tmp_path / "speed.csv"
    file.write_text("0,1\n2,1.1\n9,0.6\n")
    ramp = read_event("speed", "P1:80%@1s+4s").control(1.0, 0.8)
    assert ramp == {"shape": "ramp", "duration": 4.0, "from": 1.0, "to": 0.8, "at": 1.0}
    assert read_event("speed", f"P1@1s:{file}").control(1.0, 0.0)["points"] == [[1.0, 1.0], [3.0, 1.1], [10.0, 0.6]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("V1@1s:20%+8s", "close: no second stage, expected such as V1@1s"),
        ("V1@1s+2s:120%+8s", "close: a stage out of range"),
        ("V1@1s:nowhere.csv", "close: 'nowhere.csv' cannot be read"),
        ("V1@1s+2s:x.csv", "cannot be read"),
    ],
)
def test_a_closure_that_is_none(text, said):
    with pytest.raises(InputError, match=said):
        read_event("close", text)


@pytest.mark.parametrize(
    ("kind", "text", "said"),
    [
        ("close", "V1@2+1s", "close: a number without a unit, expected one with a unit, such as '2 s'"),
        ("close", "V1@2s+1", "close: a number without a unit, expected one with a unit, such as '1 s'"),
        ("burst", "J:20@1s", "burst: a number without a unit, expected one with a unit, such as '20 m"),
        ("stop", "P@1s:20%+8s", "stop: stages and courses are for close and open"),
        ("speed", "P@1s", "speed: not one speed to go to, or a course, expected PUMP:SHARE@TIME"),
        ("speed", "P:3@1s", "speed: out of range, expected 0 to 2 times the rated speed"),
    ],
)
def test_words_that_would_be_misread(kind, text, said):
    with pytest.raises(InputError, match=said):
        read_event(kind, text)


PIPE = {"length": "1000 m", "diameter": "0.5 m", "wave_speed": "1000 m/s", "density": 1000}
ROUGH = {"friction": {"kind": "darcy", "factor": 0.1}}
SHUT = {"shape": "ramp", "from": "-0.1 m^3/s", "to": 0, "duration": "0.1 s"}
JOUKOWSKY = 1000 * 1000 * 0.1 / (3.14159265 / 4 * 0.25)


def scene(lines: dict, **more) -> Scene:
    parts = {
        "medium": "hydraulic",
        "t_end": 20,
        "start": "steady",
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": "40 bar"}},
        "sources": {"draw": {"at": "far", "kind": "flow", "value": SHUT}},
        "probes": {"end": {"at": "far"}},
    }
    return Scene(**parts | {"lines": {name: PIPE | line for name, line in lines.items()}} | more)


def told(given: Scene) -> list[str]:
    return [note for note in simulate(given, tol=1e-3).notes if "Joukowsky" in note]


@pytest.mark.parametrize("friction", [{}, ROUGH])
def test_one_pipe_is_within_joukowsky_and_packing(friction):
    given = scene({"pipe": {"nodes": ["tank", "far"]} | friction})
    (probe,) = simulate(given, tol=1e-3).probes.values()
    assert probe.u.max() - probe.u[0] > JOUKOWSKY * 0.99
    assert not told(given)


def test_a_narrow_dead_end_is_told_with_what_was_operated():
    side = {"nodes": ["far", "side"], "length": "300 m", "diameter": "0.2 m"}
    given = scene({"pipe": {"nodes": ["tank", "far"]}, "side": side}, probes={"side": {"at": "side"}})
    (note,) = told(given)
    assert note.startswith("probes.side: the pressure rises by ")
    assert "above Joukowsky's 5.093 bar and the line packing of 0 bar" in note
    assert note.endswith("waves of sources.draw add up")


def test_columns_that_collapse_are_among_the_causes():
    gap, tank = {"at": "far", "kind": "vapour cavity"}, {"at": "tank", "kind": "reservoir", "pressure": "2 bar"}
    given = scene({"pipe": {"nodes": ["tank", "far"]}}, loads={"tank": tank, "gap": gap}, solver={"order": 1})
    result = simulate(given)
    u = result.probes["end"].u
    assert u.max() - u[0] > 1.05 * JOUKOWSKY
    (note,) = (note for note in result.notes if "Joukowsky" in note)
    assert note.endswith("waves of sources.draw and cavities that collapse add up")


def test_a_flow_that_is_reversed_may_add_as_much_as_its_change():
    turned = {"at": "far", "kind": "flow", "value": SHUT | {"to": "1 m^3/s"}}
    assert not told(scene({"pipe": {"nodes": ["tank", "far"]}}, sources={"draw": turned}))


def test_a_trickle_that_stops_beside_a_larger_flow_is_measured_by_that():
    trickle = {"at": "far", "kind": "flow", "value": {"shape": "ramp", "from": -1e-15, "to": 0.1, "duration": 0.1}}
    assert not told(scene({"pipe": {"nodes": ["tank", "far"]}}, sources={"draw": trickle}))


def test_nothing_is_told_beside_a_pressure_that_changes():
    level = {"at": "tank", "kind": "pressure", "value": {"shape": "ramp", "from": 1e5, "to": 9e5, "duration": 5}}
    draw = {"at": "far", "kind": "flow", "value": "-0.01 m^3/s"}
    given = scene({"pipe": {"nodes": ["tank", "far"]}}, loads={}, sources={"level": level, "draw": draw})
    assert not told(given)


@pytest.mark.parametrize("more", [{"start": "rest", "loads": {}}, {"sources": {}}])
def test_nothing_is_told_where_nothing_flows_at_first(more):
    assert not told(scene({"pipe": {"nodes": ["tank", "far"]}}, **more))
