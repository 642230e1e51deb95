"""Heights, ratings, and what a run says where a liquid or a wall cannot bear it."""

import pytest

from tline import InputError, Scene, simulate
from tline.scene.heights import weight_at
from tline.solver.description.description import describe
from tline.solver.result.notes import beyond_limits

PIPE = {"nodes": ["a", "b"], "length": "300 m", "diameter": "200 mm", "wave_speed": 1200, "density": 1000}


def scene(**more) -> Scene:
    """A valve that shuts at once at the end of a pipe at 2 m/s: ± 24 bar about 10 bar."""
    loads = {
        "tank": {"at": "a", "kind": "reservoir", "pressure": "10 bar"},
        "valve": {"at": "b", "kind": "valve", "before": "159.155 bar/(m^3/s)", "after": float("inf"), "time": "0.1 s"},
    }
    defaults = {"loads": loads, "probes": {"valve": {"at": "b"}, "middle": {"line": "pipe", "position": "50 %"}}}
    return Scene(medium="hydraulic", t_end="2 s", start="steady", **{"lines": {"pipe": PIPE}, **defaults, **more})


def test_below_vacuum_is_told_once_with_the_lowest() -> None:
    extremes = {"probes.valve": (-1.2e5, 0.0), "probes.middle": (-12.7e5, 0.0), "probes.tank": (3e5, 4e5)}
    (told,) = beyond_limits(describe(scene()), extremes)
    assert told.startswith("probes.middle and 1 more: the pressure falls to -12.7 bar; a liquid cavitates below")
    assert beyond_limits(describe(scene()), {"probes.valve": (-1.01e5, 1e9)}) == []


def test_voltages_exceed_a_rating_whatever_their_sign_and_never_cavitate() -> None:
    line = {"nodes": ["a", "b"], "z0": 50, "delay": 1}
    cable = Scene(medium="electrical", t_end=1, lines={"l": line}, probes={"p": {"at": "b"}}, rating="1 kV")
    assert beyond_limits(describe(cable), {"probes.p": (-2e6, 900.0)}) == [
        "probes.p: the voltage rises to 2 MV, above the rating of 1 kV"
    ]
    assert beyond_limits(describe(cable), {"probes.p": (-900.0, 900.0)}) == []


def test_a_run_tells_of_nodes_and_probes_by_the_pressure_on_the_wall() -> None:
    """Joukowsky: 24 bar above 10 bar; 20 m up, 1.96 bar less, and half of that in the middle."""
    loads = {
        "tank": {"at": "a", "kind": "reservoir", "pressure": "10 bar"},
        "valve": {"at": "b", "kind": "valve", "before": 803867 / 0.0628319, "after": float("inf"), "time": "0.1 s"},
    }
    up = scene(nodes={"a": {"elevation": 0}, "b": {"elevation": "20 m"}}, rating="33 bar", loads=loads)
    assert weight_at(up) == {"a": 0.0, "b": 1000 * 9.80665 * 20}
    low = next(note for note in simulate(up, envelope=True).notes if "falls" in note)
    assert low.startswith("probes.valve and 2 more: the pressure falls to -15.96 bar")
    high = next(note for note in simulate(up, envelope=True).notes if "rises" in note)
    assert high == "probes.middle: the pressure rises to 33.02 bar, above the rating of 33 bar"
    flat = next(note for note in simulate(scene(rating="33 bar"), envelope=True).notes if "rises" in note)
    assert flat == "probes.valve and 2 more: the pressure rises to 34 bar, above the rating of 33 bar"


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"nodes": {"c": {"elevation": 3}}}, "nodes.c: no line ends at this node"),
        ({"nodes": {"b": {"elevation": "3 kg"}}}, "nodes.b.elevation"),
        ({"nodes": {"b": {"position": [1, 2, 3]}}}, "nodes.b.position: not a place on a map"),
        ({"nodes": {"b": {"position": ["1", True]}}}, "nodes.b.position: not a place on a map"),
        ({"nodes": {"b": {"hight": 3}}}, "nodes.b.hight: unknown key"),
        ({"rating": "-5 bar"}, "rating"),
        ({"rating": "5 V"}, "rating"),
    ],
)
def test_mistakes(more, said) -> None:
    with pytest.raises(InputError, match=said):
        scene(**more)


def test_an_elevation_needs_a_density() -> None:
    line = {"nodes": ["a", "b"], "z0": 1e8, "delay": 1}
    with pytest.raises(InputError, match=r"nodes\.a\.elevation: the weight of the liquid does not follow"):
        Scene(medium="hydraulic", t_end=1, lines={"l": line}, probes={"p": {"at": "a"}}, nodes={"a": {"elevation": 1}})


def test_a_node_without_an_elevation_counts_as_one_at_zero_and_is_named() -> None:
    up = scene(nodes={"b": {"elevation": "-20 m"}}, probes={"valve": {"at": "b"}, "tank": {"at": "a"}})
    assert up.heights["a"].above_level == 0.0
    assert up.heights["b"].above_level == -20 * 9806.65
    (told,) = [note for note in simulate(up).notes if "elevation" in note]
    assert told == "nodes: no elevation is given at 'a', but at other nodes: taken as 0 m"
    only = scene(nodes={"b": {"elevation": "20 m"}}, probes={"valve": {"at": "b"}})
    assert not [note for note in simulate(only).notes if "elevation" in note]  # what a reservoir holds is piezometric


def test_heights_need_one_liquid() -> None:
    lines = {"one": PIPE, "two": PIPE | {"nodes": ["b", "c"], "density": 900}}
    with pytest.raises(InputError, match=r"lines\.two\.density: not that of lines\.one, .* 1000 kg/m\^3, got 900 kg"):
        scene(lines=lines, nodes={"c": {"elevation": 3}}, probes={"p": {"at": "a"}})
    scene(lines=lines, probes={"p": {"at": "a"}})
    apart = lines | {"two": PIPE | {"nodes": ["c", "d"], "density": 900}}
    two = scene(lines=apart, nodes={"b": {"elevation": 5}, "c": {"elevation": 3}}, probes={"p": {"at": "a"}})
    assert two.heights["b"].weight == 5 * 9806.65
    assert two.heights["d"].level == pytest.approx(3 * 900 * 9.80665)
