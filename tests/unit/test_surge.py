"""What is said of pressures that rise beyond Joukowsky and line packing."""

import pytest

from tline.scene.scene import Scene
from tline.solver.simulate import simulate

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
