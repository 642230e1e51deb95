"""Studies: scenarios of a network from one file, kept as they end, and compared."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

import tline as tl
from tline.cli.main import main
from tline.surge import study as studies
from tline.surge.scenarios import read_plan

TOWN = Path(__file__).parents[2] / "scenes" / "town.toml"
VESSEL = {"at": "lift", "kind": "air vessel", "gas_pressure": "7 bar", "gas_volume": "2 m^3"}
STUDY = {
    "title": "A town",
    "network": str(TOWN),
    "run": {"t_end": "2 s", "cavities": False},
    "paths": [["lake", "tower"]],
    "variants": {"vessel": {"loads": {"vessel": VESSEL}}},
    "events": {"power failure": {"trip": "duty@0.5s"}, "burst": {"burst": "b*:5 L/s@0.5s", "each": "nodes"}},
}


def without_seconds(found: tl.SurgeStudy) -> list[dict]:
    return [{key: x for key, x in each.items() if key != "seconds"} for each in found.to_dict()["scenarios"]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def study(folder: Path) -> tl.SurgeStudy:
    return tl.surge_study(STUDY, folder=folder, workers=1)


def test_every_event_runs_in_every_variant(study):
    names = [each.scenario.name for each in study.outcomes]
    assert names == ["power failure", "power failure, vessel", "burst b", "burst b, vessel"]


def test_a_scenario_is_what_operate_finds_and_its_scene_runs_just_so(study, folder):
    (outcome,) = (each for each in study.outcomes if each.scenario.name == "burst b, vessel")
    scene = tl.read(TOWN).change({"loads.vessel": VESSEL})
    direct = tl.operate(scene, burst="b:5 L/s@0.5s", t_end="2 s", cavities=False)
    assert outcome.told["highest"] == direct.to_dict()["highest"]
    assert outcome.worst["highest"]["highest"] == direct.worst.highest.highest
    again = tl.simulate(folder / f"{outcome.scenario.file}.toml", envelope=True).envelope
    assert again is not None
    kept = {node["node"]: node["lowest"] for node in outcome.told["nodes"]}
    assert (again.lowest - again.weight).tolist() == [kept[node] for node in again.nodes]


def test_what_is_kept_is_not_run_again_and_what_changes_is(study, folder, monkeypatch):
    ran = []
    run = studies.run_scenarios
    monkeypatch.setattr(studies, "run_scenarios", lambda each: ran.extend(each) or run(each))
    assert tl.surge_study(STUDY, folder=folder, workers=1).to_dict() == study.to_dict()
    assert not ran
    events = {**STUDY["events"], "power failure": {"trip": "duty@0.6s"}}
    tl.surge_study({**STUDY, "events": events}, folder=folder, workers=1)
    assert [each.event for each in ran] == ["power failure"] * 2


def test_its_map_may_stand_on_axes_of_others(study):
    axes = Figure().subplots()
    assert study.plot(axes) is axes
    assert axes.get_title(loc="left") == "rise above the steady state"
    assert axes.collections


def test_an_executor_finds_the_same(study):
    with ThreadPoolExecutor(1) as executor:
        assert without_seconds(tl.surge_study(STUDY, executor=executor)) == without_seconds(study)


def test_a_scenario_that_cannot_be_run_is_a_sentence(tmp_path):
    found = tl.surge_study(STUDY | {"events": {"no pump": {"trip": "dutty@1s"}}, "variants": {}}, workers=1)
    assert found.outcomes[0].verdict == "trip: not a pump, expected 'duty', got 'dutty'"
    assert "1 scenarios, 0 without a class of pressure, 1 failed" in str(found)
    found.save(tmp_path / "page.html")
    assert "not a pump" in (tmp_path / "page.html").read_text()


def test_the_page_stands_alone(study, tmp_path):
    study.save(tmp_path / "page.html")
    study.save(tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").read_bytes().count(b"/Subtype /Image") == 4
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.count("data:image/png") == 4  # a map and a profile of each variant
    assert not re.search(r'(src|href)="(?!data:)', page)
    for outcome in study.outcomes:
        assert f"{outcome.scenario.file}.toml" in page
        rise, fall = (outcome.worst[word] for word in ("rise", "fall"))
        moves = rise["highest"] - rise["before"], fall["before"] - fall["lowest"]
        assert f"{moves[0] / 1e5:.4g} / {moves[1] / 1e5:.4g}" in page


def test_the_command_reads_the_file_beside_its_network(study, folder, tmp_path):
    (tmp_path / "town.toml").write_text(TOWN.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "study.toml").write_text(
        'network = "town.toml"\nrun = { t_end = "2 s", cavities = false }\n'
        'events.shut = { close = "*@0.5s+1s", each = "valves" }\n'
    )
    line = ["study", str(tmp_path / "study.toml"), "--workers", "1", "--csv", str(tmp_path / "table.csv"), "--json"]
    done = CliRunner().invoke(main, line, catch_exceptions=False)
    told = json.loads(done.stdout)["scenarios"]
    assert [each["name"] for each in told] == ["shut ease"]
    assert done.exit_code == (told[0]["pressure_class"] is None)
    assert (tmp_path / "table.csv").read_text().startswith("scenario,rise [bar],at,after [s],fall [bar]")


def test_pipes_pumps_valves_and_nodes_in_turn():
    each = {"close": "*@1s", "each": "pipes"}
    plan = read_plan(STUDY | {"events": {"out": each, "trip": {"trip": "d*@1s", "each": "pumps"}}, "variants": {}})
    scene = tl.read(TOWN)
    assert [one.element for one in plan.scenarios] == [*scene.lines, "duty"]
    nodes = read_plan(STUDY | {"events": {"hole": {"burst": "*:1 L/s@1s", "each": "nodes"}}, "variants": {}})
    assert "lake" not in {one.element for one in nodes.scenarios}  # its pressure is held


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"events": {}}, "events: is missing"),
        ({"even": {}}, "even: unknown key, expected 'events'"),
        ({"run": {"tend": 1}}, "run.tend: unknown key, expected 't_end'"),
        ({"reading": {"our": 1}}, "reading.our: unknown key, expected 'hour'"),
        ({"events": {"a": {"clos": "x@1s"}}}, "events.a.clos: unknown key, expected 'close'"),
        ({"events": {"a": {"close": "x@1s", "each": "valve"}}}, "events.a.each: unknown, expected 'valves'"),
        ({"events": {"a": {"close": "*@1s", "each": "nodes"}}}, "events.a.each: no single operation for nodes in turn"),
        ({"events": {"a": {"close": "z*@1s", "each": "pipes"}}}, "close: nothing that it may mean is called 'z*'"),
        ({"paths": [["lake", "towr"]]}, "path: no such node, expected 'tower'"),
        ({"variants": {"a": 3}}, "variants.a: not a table"),
        ({"variants": {"a": {"loads": {"x": {"at": "lift"}}}}}, "variants.a: loads.x"),
        ({"variants": {"a": {"run": {"tol": 1, "toll": 1}}}}, "variants.a.run.toll: unknown key, expected 'tol'"),
        ({"network": "nowhere.toml"}, "nowhere.toml: cannot be read"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_sentence_before_anything_runs(given, sentence):
    with pytest.raises(tl.InputError) as caught:
        tl.surge_study(STUDY | given, workers=1)
    assert str(caught.value).startswith(sentence)
