"""Operations of several elements at once, runs that go on until nothing is cut, and tables of what they did."""

import csv
import json
import re
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

import tline as tl
from tline import InputError, operate
from tline.solver.result.export import save_states
from tline.surge.event import Event, each_of
from tline.surge.tables import tables

TOWN = Path(__file__).parents[2] / "scenes" / "town.toml"


@pytest.fixture(scope="module")
def town():
    scene = tl.read(TOWN)
    table = scene.table()
    duty = table["links"]["duty"] | {"speed": 1}
    pumps = {"links.duty": duty, "links.assist": duty, "links.spare": duty | {"speed": 0}}
    return scene.change(pumps)


@pytest.mark.parametrize(
    ("kind", "name", "means"),
    [
        ("trip", "*", {"duty", "assist"}),
        ("trip", "du*", {"duty"}),
        ("trip", "duty, assist", {"duty", "assist"}),
        ("start", "*", {"spare"}),
        ("close", "*", {"ease"}),
        ("close", "ea?e", {"ease"}),
        ("trip", "duty", {"duty"}),
    ],
)
def test_a_list_or_a_pattern_means_what_it_fits(town, kind, name, means):
    assert {event.name for event in each_of(town, Event(kind, name, 1.0))} == means


def test_all_pumps_trip_and_their_power_returns(town):
    given: Any = {"inertia": "1 kg m^2", "rated_speed": "1450 rpm", "t_end": "4 s"}
    surge = operate(town, trip="*@1s", start="*uty@2s", **given)
    speeds = {trace.where: trace.values for trace in surge.result.states if trace.word == "speed"}
    assert {*speeds} == {"links.duty", "links.assist"}
    assert speeds["links.duty"][-1] > speeds["links.duty"].min()
    assert speeds["links.assist"][-1] == speeds["links.assist"].min()


def test_a_pattern_that_fits_nothing_is_refused(town):
    with pytest.raises(InputError, match=r"trip: nothing that it may mean is called 'x\*', expected one of 'duty'"):
        operate(town, trip="x*@1s")


def test_a_run_goes_on_until_its_extremes_are_none_of_its_end():
    pipe = {"length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    tap = {"at": "c", "kind": "orifice", "flow": "20 L/s", "pressure_drop": "6 bar"}
    scene = tl.Scene(
        medium="hydraulic",
        t_end="1 s",
        start="steady",
        lines={"main": {"nodes": ["lake", "c"], **pipe}},
        loads={"lake": {"at": "lake", "kind": "reservoir", "pressure": "6 bar"}, "tap": tap},
        probes={"tap": {"at": "c"}},
    )
    given: Any = {"close": "tap@0s+2s", "t_end": "0.8 s", "tol": 0.05}
    cut, whole = (operate(scene, until_settled=on, **given) for on in (False, True))
    assert cut.worst.unfinished
    assert not whole.worst.unfinished
    assert float(whole.scene.t_end) == 1.6
    assert any("it was made again, up to 1.6 s" in note for note in whole.notes)


@pytest.fixture(scope="module")
def surge():
    scene = tl.read(TOWN)
    running = {"links.duty": scene.table()["links"]["duty"] | {"speed": 1}}
    given: Any = {
        "trip": "duty@0.5s",
        "inertia": "0.4 kg m^2",
        "rated_speed": "1450 rpm",
        "t_end": "3 s",
        "cavities": False,
    }
    return operate(scene.change(running), **given)


def test_states_are_in_the_report_and_in_json(surge):
    text, told = str(surge), surge.to_dict()["states"]
    assert re.search(r"duty speed +rpm +1450 ", text)
    speed = next(each for each in told if each["quantity"] == "speed")
    assert (speed["before"], speed["unit"]) == (pytest.approx(1450 / 60), "Hz")
    assert speed["lowest_at"] > 0.5


def test_flow_and_velocity_of_pipes_are_those_of_probes(surge):
    _, pipes, _ = tables(surge.result)
    main = dict(zip(pipes.head, next(row for row in pipes.rows if row[0] == "main"), strict=True))
    scene = surge.scene.with_changes(probes={"end": {"at": surge.scene.lines["main"].nodes[1], "line": "main"}})
    seen = tl.simulate(scene, envelope=True).probes["end"]
    assert main["flow before at end 2 [m^3/s]"] == pytest.approx(seen.y[0], rel=1e-9)
    assert main["flow lowest at end 2 [m^3/s]"] == pytest.approx(seen.y.min(), rel=1e-3)
    area = np.pi / 4 * float(scene.lines["main"].parameters.diameter) ** 2
    assert main["velocity lowest at end 2 [m/s]"] == pytest.approx(seen.y.min() / area, rel=1e-3)
    assert main["flow lowest along it [m^3/s]"] <= main["flow lowest at end 2 [m^3/s]"]


def test_files_say_the_same(surge, tmp_path):
    for name in ("t.csv", "t.xlsx", "t.geojson"):
        surge.save_tables(tmp_path / name)
    expected = {table.name: table for table in tables(surge.result)}
    for name, table in expected.items():
        with (tmp_path / f"t-{name}.csv").open() as file:
            head, *rows = csv.reader(file)
        assert head == table.head
        assert [row[0] for row in rows] == [row[0] for row in table.rows]
    with ZipFile(tmp_path / "t.xlsx") as book:
        assert re.findall(r'sheet name="(\w+)"', book.read("xl/workbook.xml").decode()) == [*expected]
        cells = re.findall(r"<v>([^<]*)</v>", book.read("xl/worksheets/sheet1.xml").decode())
    numbers = [x for row in expected["nodes"].rows for x in row[1:] if x != "" and x == x]
    assert list(map(float, cells)) == numbers
    data, nodes = surge.to_xarray(), expected["nodes"]
    assert data["lowest"].values.tolist() == [row[nodes.head.index("lowest [Pa]")] for row in nodes.rows]
    assert data["x"].sel(node="a").item() == next(row[1] for row in nodes.rows if row[0] == "a")
    assert (data["lowest"].units, data["pipe length"].units) == ("Pa", "m")
    assert {*data["pipe end 2"].values} <= {row[0] for row in nodes.rows}
    found = json.loads((tmp_path / "t.geojson").read_text())["features"]
    lines = [each for each in found if each["geometry"]["type"] == "LineString"]
    (name,) = (name for name, line in surge.scene.lines.items() if line.vertices)
    bent = next(each for each in lines if each["properties"]["pipe"] == name)
    assert len(bent["geometry"]["coordinates"]) == 2 + len(surge.scene.lines[name].vertices)
    assert {each["properties"].get("node") for each in found} >= {"lake", "a", "b", "c"}


def test_histories_of_states(surge, tmp_path):
    save_states(surge.result, tmp_path / "states.csv")
    with (tmp_path / "states.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head[:2] == ["time [s]", "duty speed [Hz]"]
    assert len(rows) == len(surge.result.t)


def test_what_cannot_be_written_is_refused(surge, tmp_path):
    with pytest.raises(InputError, match=r"unknown kind of file, expected \.csv or \.xlsx or \.geojson"):
        surge.save_tables(tmp_path / "t.pdf")
    still = tl.simulate(tl.examples["cable_rc"])
    with pytest.raises(InputError, match="nothing has a state"):
        save_states(still, tmp_path / "states.csv")
