"""Pictures of networks: the route found, profiles against the envelope, colours against values, and the layout."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from tline import InputError, Result, Scene, simulate
from tline.pictures import Route, animated, lines_to_map, network as laying, plot_map, plot_profile, route, surges
from tline.pictures.bounds import bounds
from tline.pictures.network import course, layout
from tline.pictures.path import extremes_along
from tline.scene.file import read_scene, scene_from
from tline.scene.heights import GRAVITY
from tline.solver.result.dense_output import inside

TOWN = Path(__file__).parents[2] / "scenes" / "town.toml"
METRE = 1000 * GRAVITY  # Pa of a metre of head in the town
TOL = 1e-2


@pytest.fixture(scope="module")
def town() -> Result:
    """The pump stops; a run in which all lines are recorded, cut short."""
    scene = scene_from(read_scene(TOWN).table() | {"t_end": "3 s", "rating": "6 bar"})
    return simulate(scene, tol=TOL, record=scene.lines, envelope=True)


@pytest.fixture(scope="module")
def drawn(town: Result) -> Figure:
    return plot_map(town)


@pytest.fixture(scope="module")
def way(town: Result) -> Route:
    return route(town.scene, "lake", "tower")


def test_a_route_passes_a_pump_and_a_check_valve(way: Route) -> None:
    assert way.lines == ("intake", "main", "ab", "up")
    assert way.nodes == ("lake", "suction", "lift", "a", "b", "up:valve", "tower")
    assert way.marks == (0, 80, 80, 980, 1680, 1680, 1980)
    assert way.labels == {0: "lake", 80: "suction–lift", 980: "a", 1680: "b–up:valve", 1980: "tower"}
    assert [leg.span for leg in way.legs] == [(0, 80), (80, 980), (980, 1680), (1680, 1980)]


def test_a_route_passes_the_nodes_listed(town: Result) -> None:
    assert route(town.scene, "lift", "c", "b").lines == ("main", "ca", "bc")
    assert route(town.scene, "lift", "b").lines == ("main", "ab")


@pytest.mark.parametrize(
    ("nodes", "sentence"),
    [
        (("lake", "towr"), "path: no such node, expected 'tower', got 'towr'"),
        (("suction", "lift"), "path: no line lies on it, expected nodes between which there is one, got suction and"),
        (("lake", "c", "c"), "path: leads nowhere, expected two different nodes, got 'c' twice"),
    ],
)
def test_routes_that_are_none(town: Result, nodes: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(InputError, match=re.escape(sentence)):
        route(town.scene, *nodes)


def test_a_profile_has_the_envelope_at_its_nodes(town: Result, way: Route) -> None:
    seen, envelope = extremes_along(town, way), town.envelope
    assert envelope is not None
    ends = [end for leg in way.legs for end in town.scene.lines[leg.line].nodes]
    at = np.flatnonzero(np.isin(seen.x, way.marks))
    amplitude = np.abs(seen.highest).max()
    for node, k in zip(ends, at, strict=True):
        there = envelope.of(node)
        for name, found in (("start", seen.start), ("lowest", seen.lowest), ("highest", seen.highest)):
            # the profile is that of the extrapolated run, the envelope that of the last one
            assert found[k] == pytest.approx(there[name], abs=2 * TOL * amplitude), (node, name)
    assert np.all(seen.lowest <= seen.start)
    assert np.all(seen.highest >= seen.start)


def test_a_profile_of_a_lossless_pipe_is_joukowskys(way: Route) -> None:
    """An instant closure: the highest pressure is the same all along, but for the tank itself."""
    pipe = {"nodes": ["tank", "valve"], "length": "300 m", "wave_speed": 1500, "z0": 4.7e7}
    scene = Scene(
        medium="hydraulic", t_end="2 s", start="steady", lines={"pipe": pipe}, probes={"valve": {"at": "valve"}},
        loads={"tank": {"at": "tank", "kind": "reservoir", "pressure": "20 bar"},
               "valve": {"at": "valve", "kind": "valve", "before": 2e8, "after": float("inf"), "time": "0.1 s"}},
    )  # fmt: skip
    path = route(scene, "valve", "tank")
    result = simulate(scene, record=path.lines)
    seen = extremes_along(result, path)
    np.testing.assert_allclose(seen.highest[:-1], 20e5 + 4.7e5, rtol=1e-6)
    np.testing.assert_allclose(seen.lowest[:-1], 20e5 - 4.7e5, rtol=1e-6)
    np.testing.assert_allclose([seen.highest[-1], seen.lowest[-1]], 20e5, rtol=1e-6)
    axes = plot_profile(result, path).axes[0]
    shown = {str(line.get_label()): np.asarray(line.get_ydata()) for line in axes.lines}
    np.testing.assert_allclose(shown["highest"], seen.highest / 1e5)
    assert (axes.get_ylabel(), axes.get_xlabel()) == ("pressure [bar]", "distance from valve [m]")


def test_bounds_follow_the_ground(town: Result, way: Route) -> None:
    seen = extremes_along(town, way)
    found = {bound.kind: bound for bound in bounds(town.scene, way, seen.x, seen.lowest)}
    heights = [10, 2, 2, 20, 20, 25, 25, 40]
    np.testing.assert_allclose(found["ground"].effort / METRE, heights)
    np.testing.assert_allclose(found["rating"].effort, found["ground"].effort + 6e5)
    np.testing.assert_allclose(found["vacuum"].effort, found["ground"].effort - 101_325)
    assert found["rating"].name == "rating 6 bar"
    high = bounds(town.scene, way, seen.x, seen.lowest + 1e6)
    assert [bound.kind for bound in high] == ["ground", "rating"]


def test_a_profile_shows_heads_and_bounds(town: Result, way: Route) -> None:
    picture = plot_profile(town, way)
    axes = picture.axes[0]
    assert axes.get_ylabel() == "head [m]"
    names = [text.get_text() for text in picture.legends[0].get_texts()]
    assert names == ["highest", "steady", "lowest", "ground", "rating 6 bar", "vacuum, \N{MINUS SIGN}1.013 bar"]
    low, high = axes.get_ylim()
    for line in axes.lines[: len(names)]:
        assert low < np.nanmin(line.get_ydata()) <= np.nanmax(line.get_ydata()) < high


def test_a_cables_bounds_are_on_both_sides() -> None:
    cable = {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}
    scene = Scene(medium="electrical", t_end="9 ns", lines={"c": cable}, probes={"p": {"at": "far"}}, rating="1 kV")
    x = np.array([0.0, 5e-9])
    found = bounds(scene, route(scene), x, np.zeros(2))
    assert [(bound.name, *bound.effort) for bound in found] == [
        ("rating 1 kV", 1e3, 1e3),
        ("\N{MINUS SIGN}1 kV", -1e3, -1e3),
    ]


def test_an_animation_draws_bounds(town: Result, way: Route, tmp_path: Path) -> None:
    animated(town, way).save(tmp_path / "x.html")
    found = re.search(r"^const data = (.*);$", (tmp_path / "x.html").read_text(encoding="utf-8"), re.MULTILINE)
    assert found
    data = json.loads(found[1])
    assert [kind for kind, _, _ in data["bounds"]] == ["ground", "rating", "vacuum"]
    assert data["bounds"][0][2][:2] == [[0.0, 10.0], [80.0, 2.0]]
    assert data["effort"] == "head [m]"
    assert data["range"][0] < -10 < 60 < data["range"][1]


# maps


def test_surges_are_measured_from_the_start(town: Result) -> None:
    rise, fall = surges(town)
    assert town.envelope is not None
    lift = town.envelope.of("lift")
    assert fall.nodes["lift"] == lift["start"] - lift["lowest"]
    assert rise.nodes["lake"] == pytest.approx(0.0, abs=1e-6 * lift["start"])
    assert fall.lines["main"][0] == pytest.approx(fall.nodes["lift"], abs=2 * TOL * lift["start"])
    assert fall.lines["main"][10] > 1.5 * (2 * fall.nodes["lift"] + 10 * fall.nodes["a"]) / 12  # no straight line
    # the pump's 75 m less 2 m of height are more than 6 bar; the tower's line stays between the limits
    assert rise.beyond["main"] == 0.0
    assert "main" in fall.beyond
    assert "up" not in {*rise.beyond, *fall.beyond}


def test_colours_are_those_of_the_values(town: Result, drawn: Figure) -> None:
    for axes, bar, surge in zip(drawn.axes[:2], drawn.axes[2:], surges(town), strict=True):
        largest = max([*surge.nodes.values(), *(max(values) for values in surge.lines.values())]) / METRE
        assert bar.get_ylim() == pytest.approx((0.0, largest))
        shown = [c for c in axes.collections if isinstance(c, LineCollection) and c.get_array() is not None]
        assert len(shown) == len(surge.lines)
        for steps, values in zip(shown, surge.lines.values(), strict=True):
            np.testing.assert_allclose(steps.get_array(), np.maximum(values[1:], values[:-1]) / METRE)
    assert [bar.get_ylabel() for bar in drawn.axes[2:]] == ["rise of head [m]", "fall of head [m]"]
    squares = [line for line in drawn.axes[0].lines if line.get_marker() == "s"]
    assert sorted(float(np.asarray(line.get_xdata())[0]) for line in squares) == [0.0, 200.0]  # lake, tower
    assert {"lake", "a", "tower"} <= {text.get_text() for text in drawn.axes[0].texts}


def test_names_on_a_map_do_not_cover_each_other(drawn: Figure) -> None:
    boxes = [text.get_window_extent() for text in drawn.axes[0].texts]
    assert len(boxes) > 5
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_lines_on_a_map_bend_at_their_vertices(town: Result) -> None:
    places = layout(town.scene)
    assert places["tower"] == (200.0, 20.0)
    points = course(town.scene, "ca", places, np.linspace(0, 1, 201))
    assert [tuple(points[k]) for k in (0, -1)] == [places["c"], places["a"]]
    for vertex in ((110.0, 80.0), (90.0, 60.0)):
        assert np.hypot(*(points - vertex).T).min() < 1.0


def test_without_positions_distances_are_delays() -> None:
    """A tree of equal lines can be drawn with all neighbours equally far apart, and three lines form a triangle."""
    lines = {name: {"nodes": [*name], "z0": 50, "delay": delay}
             for name, delay in {"ab": 1, "bc": 1, "ca": 1, "cd": 2}.items()}  # fmt: skip
    scene = Scene(medium="electrical", t_end=9, lines=lines, probes={"p": {"at": "d"}})
    places = layout(scene)
    apart = {name: np.hypot(*np.subtract(places[name[0]], places[name[1]])) for name in lines}
    assert apart == pytest.approx({"ab": 1, "bc": 1, "ca": 1, "cd": 2}, rel=0.1)
    loose = Scene(medium="electrical", t_end=9, lines={k: lines[k] for k in ("ab", "cd")}, probes={"p": {"at": "d"}})
    assert np.isfinite([*layout(loose).values()]).all()


def test_too_many_nodes_without_positions_are_refused_before_a_run(
    town: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(laying, "MOST_PLACED", 5)
    assert lines_to_map(town.scene) == ["intake", "main", "ab", "bc", "ca", "up"]
    table = town.scene.table()
    del table["nodes"]["a"]["position"]
    sentence = "nodes: 'a' has no position, and a map of 9 nodes is not laid out, expected positions of all nodes"
    with pytest.raises(InputError, match=re.escape(sentence)):
        lines_to_map(scene_from(table))


def test_a_map_needs_an_envelope() -> None:
    cable = {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}
    scene = Scene(medium="electrical", t_end="9 ns", lines={"c": cable}, probes={"p": {"at": "far"}})
    with pytest.raises(InputError, match=re.escape("map: the run kept no envelope, expected simulate(scene, envelope")):
        plot_map(simulate(scene))


def test_routes_and_maps_pass_junctions_of_three_ports() -> None:
    scene = Scene(
        medium="electrical", t_end="9 ns", probes={"p": {"at": "out"}},
        lines={
            "a": {"nodes": ["in", "p"], "z0": 50, "delay": "1 ns"},
            "b": {"nodes": ["q", "out"], "z0": 50, "delay": "1 ns"},
        },
        links={"c": {"kind": "junction", "nodes": ["r", "p", "q"], "z0": 50, "scattering": np.eye(3).tolist()}},
        loads={"r": {"at": "r", "kind": "resistor", "resistance": 50}},
    )  # fmt: skip
    assert route(scene, "in", "out").nodes == ("in", "p", "q", "out")
    assert set(layout(scene)) == {"in", "p", "q", "r", "out"}


def test_extremes_inside_see_a_pulse_that_is_shorter_than_their_grid() -> None:
    pulse = {"shape": "pulses", "high": 1, "width": "20 ps", "rise": "5 ps", "fall": "5 ps"}
    scene = Scene(
        medium="electrical", t_end="12 ns", probes={"p": {"at": "far"}}, solver={"order": 3, "slab": "5 ps"},
        lines={"c": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns", "length": 1, "resistance": 1e-3}},
        sources={"s": {"at": "near", "kind": "voltage", "value": pulse, "resistance": 50}},
        loads={"r": {"at": "far", "kind": "resistor", "resistance": 50}},
    )  # fmt: skip
    result = simulate(scene, record=["c"])
    assert inside(result, "c").extremes(result.t)[2] == pytest.approx(0.5, abs=1e-3)
