"""Lines with cavities are stretches for the solver, and one line for everybody else."""

import re
import tomllib

import numpy as np
import pytest

from tline import InputError, Scene, SceneError
from tline.frequency import respond
from tline.pictures import route, surges
from tline.pictures.lattice import only_line
from tline.pictures.path import effort_along, extremes_along, start_effort
from tline.scene.file import scene_from, scene_text
from tline.scene.stretches import expanded
from tline.solver.description.description import describe
from tline.solver.many.runs import many_runs
from tline.solver.result.dense_output import inside
from tline.solver.simulate import judged, simulate
from tline.study.baseline import BASELINES

PIPE = {"nodes": ["tank", "end"], "length": "300 m", "diameter": 0.2, "wave_speed": 1000, "density": 1000}
SHUT = {"shape": "ramp", "from": -0.02, "to": 0, "duration": 0.05}
THIRD = {"line": "pipe", "position": "75 %"}
TABLE = {
    "medium": "hydraulic",
    "t_end": 1.5,
    "start": "steady",
    "lines": {"pipe": PIPE | {"cavities": {"places": 3, "vapour_pressure": "20 mbar"}}},
    "nodes": {"tank": {"elevation": 0}, "end": {"elevation": "4 m"}},
    "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": 2e5}},
    "sources": {"out": {"at": "end", "kind": "flow", "value": SHUT}},
    "probes": {"end": {"at": "end"}, "near": {"at": "tank", "line": "pipe"}, "third": THIRD},
    "solver": {"order": 2, "slab": "25 ms"},
}


def written_out() -> Scene:
    """The same with pipes and loads in a row."""
    names = ["tank", "one", "two", "three", "end"]
    pipes = {f"p{k}": PIPE | {"nodes": names[k : k + 2], "length": 75} for k in range(4)}
    cavity = {"kind": "vapour cavity", "vapour_pressure": 2000}
    loads = {at: cavity | {"at": at} for at in names[1:-1]}
    probes = {"end": {"at": "end"}, "near": {"at": "tank"}, "third": {"at": "three", "line": "p2"}}
    nodes = {at: {"elevation": k} for k, at in enumerate(names)}
    return Scene(**TABLE | {"lines": pipes, "nodes": nodes, "loads": TABLE["loads"] | loads, "probes": probes})


def test_a_line_with_cavities_is_pipes_and_loads_in_a_row():
    one, other = simulate(Scene(**TABLE), ledger=True, envelope=True), simulate(written_out(), ledger=True)
    for name, probe in other.probes.items():
        assert one.probes[name].u == pytest.approx(probe.u, abs=1e-7)
        assert one.probes[name].y == pytest.approx(probe.y, abs=1e-14)
    assert np.isclose(one.probes["third"].u, 2000 - 101_325 + 3 * 9806.65).sum() > 3  # slab ends with a cavity
    assert {entry.where for entry in one.ledger.entries} >= {"lines.pipe", "lines.pipe.cavities", "loads.tank"}
    total = sum(other.ledger.of(f"loads.{name}").taken for name in ("one", "two", "three"))
    assert one.ledger.of("lines.pipe.cavities").taken == pytest.approx(total)
    assert one.envelope.nodes == ("tank", "end")
    assert judged(one).estimates.keys() == one.probes.keys()


def test_it_is_written_as_it_was_read():
    scene = Scene(**TABLE)
    assert scene_text(scene_from(tomllib.loads(scene_text(scene)))) == scene_text(scene)
    assert tomllib.loads(scene_text(scene))["lines"]["pipe"]["cavities"] == TABLE["lines"]["pipe"]["cavities"]
    assert list(scene.lines) == ["pipe"]
    assert expanded(written_out()).lines.keys() == written_out().lines.keys()


@pytest.mark.parametrize("friction", [None, {"kind": "darcy", "factor": 0.02}])
def test_pictures_see_one_line(friction):
    pipe = TABLE["lines"]["pipe"] | ({"friction": friction} if friction else {})
    scene = Scene(**TABLE | {"lines": {"pipe": pipe}})
    way = route(scene)
    result = simulate(scene, record=way.lines, envelope=True)
    assert way.nodes == ("tank", "end")
    x, t = np.array([0.0, 75.0, 225.0, 299.9]), np.array([0.0, 0.4, 1.0])
    effort = effort_along(result, way, x, t)
    assert effort[:, 2] == pytest.approx(result.probes["third"].at(t).u, abs=1.0)
    seen = extremes_along(result, way)
    assert (np.diff(seen.x) > 0).all()
    assert len(seen.lowest) == len(seen.x)
    assert start_effort(result, way) == 2e5
    assert len(surges(result)[0].lines["pipe"]) == 13
    t = np.linspace(0, 1.4, 57)
    if friction is None:
        a, b = result.lines["pipe"].waves(t, 0.6)
        assert (a + b) / 2 == pytest.approx(inside(result, "pipe").effort(t, 0.6), abs=0.02 * np.ptp(a))
    else:
        fallen = 0.02 * 225 / 0.2 * 1000 / 2 * (0.02 / (np.pi * 0.01)) ** 2
        assert result.probes["third"].u[0] == pytest.approx(2e5 - fallen)


def changed(pipe: dict | None = None, **more) -> Scene:
    return Scene(**TABLE | {"lines": {"pipe": TABLE["lines"]["pipe"] | (pipe or {})}} | more)


@pytest.mark.parametrize(
    ("pipe", "more", "message"),
    [
        ({"cavities": {}}, {}, "lines.pipe.cavities.places: is missing"),
        ({"cavities": {"places": 0}}, {}, "lines.pipe.cavities.places: not a whole number in range, expected one f"),
        ({"cavities": {"places": 1, "gas_volume": 0}}, {}, "lines.pipe.cavities.gas_volume: volume out of range"),
        (
            {"cavities": {"places": 1, "gas_volum": 1}},
            {},
            "lines.pipe.cavities.gas_volum: unknown key, expected 'gas_volume'",
        ),
        (
            {"cavities": {"places": 1, "vapour_pressure": "2 bar"}},
            {},
            "lines.pipe.cavities.vapour_pressure: too high, expected less than the atmosphere's",
        ),
        (
            {},
            {"nodes": {"end": {"elevation": 4}}},
            "lines.pipe.cavities: the height of node 'tank' is not known, expected elevations of both ends",
        ),
        (
            {},
            {"loads": {"pipe, place 2": {"at": "tank", "kind": "reservoir", "pressure": 2e5}}},
            "lines: a name that a part of lines.pipe has, expected another name, got 'pipe, place 2'",
        ),
        (
            {},
            {"links": {"v": {"kind": "orifice", "nodes": ["end", "pipe, place 2"], "kv": 50}}},
            "lines: a name that a part of lines.pipe has, expected another name, got 'pipe, place 2'",
        ),
        (
            {},
            {"solver": {"slab": 0.1}},
            "solver.slab: longer than the shortest delay, expected at most that of lines.p",
        ),
    ],
)
def test_mistakes_are_told_in_one_sentence(pipe, more, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        changed(pipe, **more)


def test_what_cannot_be_had_is_refused_by_name():
    boiling = changed(loads={"tank": TABLE["loads"]["tank"] | {"pressure": -99_000}})
    with pytest.raises(InputError, match=r'loads\."pipe, place 1": no state at rest: the liquid boils'):
        simulate(boiling)
    still = changed(start="rest", solver={})
    linear = {
        "a bounce diagram": lambda: only_line(still),
        "transfer functions": lambda: respond(still, 1j, "out"),
        "many runs": lambda: many_runs(describe(still), {"lines.pipe.z0": np.array([1e7])}, 1e-6),
    }
    for what, asked in linear.items():
        with pytest.raises(
            InputError, match=rf"lines\.pipe\.cavities: is non-linear, expected a line without for {what}"
        ):
            asked()
    assert all(
        "baseline methods know linear elements only" in baseline.incompatibility(still)
        for baseline in BASELINES.values()
    )


LOSSY = PIPE | {"friction": {"kind": "darcy", "factor": 0.02}}


@pytest.mark.parametrize(("position", "share"), [("0 m", 0.0), ("100 %", 1.0), ("75 m", 0.25), ("300 m", 1.0)])
def test_a_probe_inside_a_lossy_line_parts_it_there(position, share):
    scene = changed(lines={"pipe": LOSSY}, probes={"p": {"line": "pipe", "position": position}}, solver={})
    parts = expanded(scene)
    seen = parts.probes["p"]
    line = parts.lines[seen.line]
    assert seen.fraction(line) == (1.0 if share else 0.0)
    assert parts.height("p").elevation == pytest.approx(4 * share)
    assert len(parts.lines) == (1 if share in (0.0, 1.0) else 2)
    assert sum(line.parameters.length for line in parts.lines.values()) == pytest.approx(300)


def test_two_probes_at_one_place_and_one_at_a_cavity_share_a_node():
    probes = {name: {"line": "pipe", "position": at} for name, at in zip("pqr", ("40 %", "120 m", "50 %"), strict=True)}
    friction = {"friction": {"kind": "darcy", "factor": 0.02}}
    parts = expanded(changed(friction, probes=probes, solver={}))
    assert list(parts.lines) == [f"pipe, stretch {k}" for k in range(1, 6)]
    assert {parts.probes[name].line for name in "pq"} == {"pipe, stretch 2"}
    assert parts.lines["pipe, stretch 2"].nodes == ("pipe, place 1", "pipe, probe p")
    assert list(parts.loads) == ["tank", "pipe, place 1", "pipe, place 2", "pipe, place 3"]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"solver": {"slab": 0.1}}, "longer than the shortest delay, expected at most that of lines.pipe, 0.075 s"),
        ({"loads": {"pipe, probe p": {"at": "tank", "kind": "closed"}}}, "a name that a part of lines.pipe has"),
        ({"probes": {"p": {"line": "pipe", "position": "310 m"}}}, "p.position: not on the line, expected 0 to 300 m"),
    ],
)
def test_mistakes_about_places_inside_are_told_in_one_sentence(more, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        changed(lines={"pipe": LOSSY}, **{"probes": {"p": {"line": "pipe", "position": "25 %"}}} | more)


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_a_search_that_leads_nowhere_says_why():
    lines = {"pipe": {"nodes": ["tank", "end"], "z0": 2e7, "delay": 0.3, "cavities": {"places": 7, "gas_volume": 1e-9}}}
    loads = TABLE["loads"] | {"end": {"at": "end", "kind": "cavity", "gas_volume": 1e-9}}
    value = {"shape": "ramp", "from": -0.04, "to": 0, "at": 0.03, "duration": 0.1}
    sources = {"out": {"at": "end", "kind": "flow", "value": value}}
    accuracy = simulate(
        changed(lines=lines, loads=loads, sources=sources, nodes={}, solver={}, t_end=3), tol=1e-4
    ).accuracy
    assert not accuracy.met
    assert accuracy.limit.startswith("narrower slabs do not help: cavities collapse at other instants in each run")


@pytest.mark.parametrize(("elevation", "told"), [("-40 m", False), ("40 m", True)])
def test_a_probe_inside_has_the_height_of_its_place(elevation, told):
    """A flow lowers the pressure by 2.5 bar; 35 m of water more or less stand on the wall."""
    pulse = {"shape": "ramp", "from": 0, "to": -0.0079, "duration": 0.05}
    scene = Scene(
        **TABLE
        | {
            "start": "rest",
            "t_end": 0.4,
            "lines": {"pipe": PIPE},
            "loads": {},
            "nodes": {"tank": {"elevation": 0}, "end": {"elevation": elevation}},
            "sources": {"out": {"at": "end", "kind": "flow", "value": pulse}},
            "probes": {"inside": {"line": "pipe", "position": "87.5 %"}},
        }
    )
    assert any("cavitates" in remark for remark in simulate(scene).remarks) == told
