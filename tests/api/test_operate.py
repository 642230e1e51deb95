"""`tl.operate`: what `tline surge` does, in Python."""

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from click.testing import CliRunner

import tline as tl
from tline.cli.main import main

TOWN = Path(__file__).parents[2] / "scenes" / "town.toml"
OPERATIONS: Any = {"burst": "c:5 L/s@1s+0.5s", "demand": "d:-4 L/s@0.2s+0.5s", "when": "lift<4 bar: close ab+1s"}


@pytest.fixture(scope="module")
def surge() -> tl.Operation:
    return tl.operate(TOWN, t_end="2 s", rating="6 bar", seconds=600, **OPERATIONS)


@pytest.fixture(scope="module")
def without_cavities() -> tl.Operation:
    return tl.operate(TOWN, t_end="2 s", cavities=False, seconds=600, **OPERATIONS)


def test_it_tells_what_the_command_prints(surge, monkeypatch):
    """Both carry out the same, and what is found is printed."""
    asked = []
    monkeypatch.setattr("tline.surge.operation.carried_out", lambda *what, **how: asked.append((what, how)) or surge)
    tl.operate(TOWN, t_end="2 s", rating="6 bar", **OPERATIONS)
    options = [part for kind, text in OPERATIONS.items() for part in (f"--{kind}", text)]
    line = ["surge", str(TOWN), *options, "--for", "2s", "--rating", "6 bar"]
    assert json.loads(CliRunner().invoke(main, [*line, "--json"]).stdout) == surge.to_dict()
    printed = CliRunner().invoke(main, line)
    assert printed.stdout + "\n".join(printed.stderr.splitlines()) == repr(surge)
    assert "\nnote: 'lift<4 bar: close ab+1s': after 0.5 s\n" in repr(surge)
    ours, *theirs = [(scene, tuple(guesses), how) for (scene, guesses, *_), how in asked]
    assert theirs == [ours, ours]


def test_its_scene_does_the_same(without_cavities):
    surge = without_cavities
    again = tl.simulate(surge.scene, envelope=True).envelope
    assert again is not None
    assert surge.result.envelope is not None
    assert again.highest.tolist() == surge.result.envelope.highest.tolist()
    assert again.lowest_at.tolist() == surge.result.envelope.lowest_at.tolist()


def test_the_tolerance_is_met_soon():
    """Check valves bend waves steeply inside slabs: their friction is all along, and fronts are followed."""
    accuracy = tl.operate(TOWN, t_end="4 s", tol=1e-2, cavities=False, **OPERATIONS).result.accuracy
    assert accuracy.met
    assert sum(attempt.samples for attempt in accuracy.attempts) < 1e5


def test_every_node_is_in_its_table(surge):
    table = surge.to_dataframe()
    assert {*table.index} == {*surge.result.envelope.nodes}
    assert isinstance(table, pd.DataFrame)
    assert table.highest.idxmax() == surge.worst.highest.node
    assert table.highest.max() == surge.worst.highest.highest


def test_its_pictures_need_no_preparation(surge):
    assert len(surge.plot_map().axes) >= 2
    assert surge.plot_profile("lake", "tower").axes[0].get_ylabel() == "head [m]"
    assert surge.plot().axes


def test_probes_stand_where_something_is_operated_or_where_they_are_wanted(surge):
    assert {"c", "b"} <= {*surge.result.probes}
    assert [*tl.operate(TOWN, t_end=0.2, at="lake").result.probes] == ["lake"]
    station = TOWN.with_name("pump_group.toml")
    assert [*tl.operate(station, t_end=0.2, at="outlet").result.probes] == ["outlet"]  # where no pipe ends
    lines = tl.read(TOWN).table()["lines"]
    town = tl.read(TOWN).with_changes(lines={"c": lines["bc"], **lines})  # a pipe with the name of a node
    assert {"c"} <= {*tl.operate(town, t_end=0.2, demand="c:1 L/s@0s").result.probes}


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"close": "abc@1s"}, "close: not a valve, or an open pipe, expected"),
        ({"close": ["ab@1s", "ab@2s"]}, "close: 'ab' is operated twice"),
        ({"close": {"ab": 1}.items()}, "close: unknown value, expected a text, or a list of texts, got ('ab', 1)"),
        ({"burst": None}, "burst: unknown value, expected a text, or a list of texts, got None"),
        ({"at": ["lakes"]}, "at: no such node, expected 'lake', got 'lakes'"),
        ({"t_end": "soon"}, "t_end: there is no number in front"),
        ({"rating": "6 kg"}, "rating: this unit measures something else"),
        ({"tol": 7}, "solver.tol: tolerance out of range"),
        ({"order": 99}, "solver.order: not a whole number in range"),
    ],
)
def test_a_mistake_is_one_sentence_that_names_the_argument(given, sentence):
    with pytest.raises(tl.InputError) as caught:
        tl.operate(TOWN, **given)
    assert str(caught.value).startswith(sentence)
    assert "\n" not in str(caught.value)


def test_a_file_of_epanet_is_read_as_by_the_command():
    pytest.importorskip("wntr")
    file = str(TOWN.with_suffix(".inp"))
    reading = ["--at-hour", "1", "--wave-speed", "900 m/s", "--moving-tanks"]
    printed = CliRunner().invoke(main, ["surge", file, "--close", "ease@1s+1s", "--for", "2s", *reading, "--json"])
    water = {"hour": 1, "wave_speed": "900 m/s", "moving_tanks": True}
    found = tl.operate(file, close="ease@1s+1s", t_end="2 s", record=(), **water)  # pyright: ignore[reportArgumentType]
    assert json.loads(printed.stdout) == found.to_dict()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"hour": "8 h"}, "hour: out of range, expected a number from 0 to 8784, got '8 h'"),
        ({"material": 3}, "material: not a path, expected the path of a CSV file, got 3"),
        ({"wave_speed": [1]}, "wave_speed: not a number"),
    ],
)
def test_a_mistake_of_reading_is_one_sentence(given, sentence):
    pytest.importorskip("wntr")
    with pytest.raises(tl.InputError) as caught:
        tl.operate(TOWN.with_suffix(".inp"), **given)
    assert str(caught.value).startswith(sentence)
    with pytest.raises(tl.InputError, match=r"is for \.inp files"):
        tl.operate(TOWN, **given)


def test_what_is_no_network():
    with pytest.raises(tl.InputError, match=r"town.net: unknown kind of file, expected \.inp or \.toml, got \.net"):
        tl.operate("town.net")
    with pytest.raises(tl.InputError, match="scene: nothing to be operated, expected medium = 'hydraulic'"):
        tl.operate(TOWN.with_name("open_line.toml"))


def test_no_class_is_named_where_water_would_boil_beyond_the_pipes():
    """Behind a valve that shuts, a crest between links has the pressure of the basin 30 m below it."""
    scene = tl.Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        nodes={
            "lake": {"elevation": 0},
            "valve": {"elevation": 20},
            "crest": {"elevation": 30},
            "low": {"elevation": 0},
        },
        lines={
            "pipe": {"nodes": ["lake", "valve"], "length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
        },
        links={
            "shut": {"kind": "orifice", "nodes": ["valve", "crest"], "kv": 200},
            "down": {"kind": "orifice", "nodes": ["crest", "low"], "kv": 200},
        },
        loads={
            "lake": {"kind": "reservoir", "at": "lake", "pressure": "6 bar"},
            "low": {"kind": "reservoir", "at": "low", "pressure": 0},
        },
        probes={"valve": {"at": "valve"}},
    )
    found = tl.operate(scene, close="shut@1s", t_end="5 s")
    assert found.worst.needed is None
    assert "'crest'" in found.worst.untold
    assert found.result.envelope.alone["crest"][1] == pytest.approx(0, abs=10)


def test_no_probe_is_where_an_outlet_behind_a_gate_leaves_any_pressure():
    """What is shut in before an outlet that lets nothing in has no least pressure, and does not hold up the search."""
    pipe = {"nodes": ["lake", "b"], "length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    scene = tl.Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={"pipe": pipe},
        links={"valve": {"kind": "orifice", "nodes": ["b", "c"], "kv": 200}},
        loads={
            "lake": {"kind": "reservoir", "at": "lake", "pressure": "6 bar"},
            "tap": {"kind": "check valve", "at": "c", "flow": "20 L/s", "pressure_drop": "4 bar"},
        },
        probes={"b": {"at": "b"}},
    )
    surge = tl.operate(scene, close="pipe@1s+0.5s", t_end="20 s")
    assert [*surge.result.probes] == ["pipe:gate"]
    assert surge.worst.needed
    assert len(surge.result.accuracy.attempts) < 5


def test_a_pipe_with_a_blind_end_is_shut_at_the_other():
    pipe = {"length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    scene = tl.Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={"main": {"nodes": ["lake", "b"], **pipe}, "branch": {"nodes": ["b", "c"], **pipe}},
        loads={
            "lake": {"kind": "reservoir", "at": "lake", "pressure": "6 bar"},
            "tap": {"kind": "check valve", "at": "b", "flow": "20 L/s", "pressure_drop": "4 bar"},
            "plug": {"kind": "closed", "at": "c"},
        },
        probes={"b": {"at": "b"}},
    )
    surge = tl.operate(scene, close=["branch@1s", "main@2s"], t_end="5 s")
    assert surge.scene.lines["branch"].nodes == ("branch:gate", "c")
    assert surge.scene.links["branch:gate"].nodes == ("branch:gate", "b")
    assert surge.scene.lines["main"].nodes == ("lake", "main:gate")
