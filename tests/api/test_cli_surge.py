"""`tline surge`: its texts, files and mistakes."""

import json
from pathlib import Path

import pytest
from command_line import assert_refused, run

ROOT = Path(__file__).parents[2]
TOWN = f"{ROOT}/scenes/town.inp"


pytestmark = pytest.mark.usefixtures("folder")


def test_a_network_is_operated_and_its_scene_does_the_same(folder: Path) -> None:
    pytest.importorskip("wntr")
    operations = "--trip duty@1s --close ab@2s+1s --burst 'c:5 L/s@2s+1s' --demand d:-4L/s@1s+1s --for 5s --no-cavities"
    pictures = "--heads heads.png --map map.png --profile way.png --path lake,tower --envelope table.csv"
    more = "--at b,c --rating '6 bar' --seconds 600"
    done = run(f"surge {TOWN} --at-hour 1 {operations} {pictures} {more} --save scene.toml")
    assert done.exit_code == 1
    assert "largest rises" in done.stdout
    assert "no pressure class is named, for water boils" in done.stdout
    assert "above the rating of 6 bar" in done.stderr
    assert {path.name for path in folder.iterdir()} == {
        "heads.png", "map.png", "way.png", "table.csv", "scene.toml"
    }  # fmt: skip
    told = run("run scene.toml --envelope again.csv")
    assert told.exit_code < 2
    assert (folder / "again.csv").read_text() == (folder / "table.csv").read_text()
    again = json.loads(run("surge scene.toml --for 5s --json --no-cavities").stdout)
    first = json.loads(run(f"surge {TOWN} --at-hour 1 {operations} --json").stdout)
    assert again["risen"] == first["risen"]
    assert first["fallen"][0]["node"] == "lift"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("--trip duty", "--trip: not an operation, expected PUMP@TIME, such as P1@1s, got 'duty'"),
        ("--trip duty@1s+3s", "--trip: a trip takes no time of its own"),
        ("--trip dutty@1s", "--trip: not a pump, expected 'duty', got 'dutty'"),
        ("--stop dutty@1s+5s", "--stop: not a pump, expected 'duty', got 'dutty'"),
        ("--stop duty@1kg+5s", "--stop: this unit measures something else"),
        ("--stop duty@1s --trip duty@2s", "--stop: 'duty' is operated twice"),
        ("--close ease@soon", "--close: there is no number in front"),
        ("--close ease@1kg", "--close: this unit measures something else"),
        ("--close ease@-1s", "--close: out of range, expected times of zero and more"),
        ("--close duty@1s", "--close: not a valve, or an open pipe, expected"),
        ("--burst b@1s", "--burst: not an operation, expected NODE:FLOW@TIME+DURATION, such as J73:20L/s@2s"),
        ("--burst b:-3L/s@1s", "--burst: not an operation"),
        ("--burst b:3m@1s", "--burst: this unit measures something else"),
        ("--burst 'lake:5 L/s@1s'", "--burst: the pressure there is held"),
        ("--at nowhere", "--at: no such node"),
        ("--for never", "--for: there is no number in front"),
        ("--path lake,tower", "--path: nothing shows it, expected --profile beside it"),
        ("--save scene.txt", "--save: unknown kind of file, expected .toml"),
        ("--trip duty@1s --inertia heavy", "--inertia: "),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    pytest.importorskip("wntr")
    assert_refused(f"surge {TOWN} {line}", sentence)


def test_what_is_no_network(folder: Path) -> None:
    assert run(f"surge {ROOT}/scenes/open_line.toml").stderr.startswith("scene: nothing to be operated")
    assert run("surge town.net").stderr == "town.net: cannot be read, got No such file or directory\n"
    (folder / "town.net").write_text("")
    assert run("surge town.net").stderr == "town.net: unknown kind of file, expected .inp or .toml, got .net\n"
    assert run(f"surge {ROOT}/scenes/town.toml --at-hour 3").stderr.startswith("--at-hour: is for .inp files")
