"""`tline import` of EPANET files, and `tline run --envelope`: files, texts, mistakes."""

import csv
import re
from pathlib import Path

import pytest
from command_line import run
from networks import ring

from tline.scene.file import read_scene

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    ring(folder).rename("town.inp")
    return folder


def test_the_example_of_the_help_and_of_the_docs() -> None:
    pytest.importorskip("wntr")
    example, _ = re.findall(r"^ +tline (import .*[.]inp.*)$", run("import --help").stdout, re.MULTILINE)
    done = run(example)
    assert (done.exit_code, done.stdout) == (0, "wrote town.toml\n")
    assert done.stderr.splitlines()[0] == "note: left out, closed or without flow: 'spare'"
    page = (ROOT / "docs" / "networks.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```console\ntline (import .*)\n", page)
    assert run(shown.replace("scenes/", f"{ROOT}/scenes/").replace("town.toml", "shipped.toml")).exit_code == 0
    shipped, own = (read_scene(file).lines for file in ("shipped.toml", "town.toml"))
    assert [(name, line.parameters) for name, line in shipped.items()] == [
        (n, line.parameters) for n, line in own.items()
    ]


def test_the_scene_that_is_shipped_is_the_network_that_is_shipped() -> None:
    pytest.importorskip("wntr")
    run(f"import {ROOT}/scenes/town.inp --wave-speed '1000 m/s' -o town.toml")
    ours, shipped = read_scene("town.toml").table(), read_scene(ROOT / "scenes" / "town.toml").table()
    assert shipped.pop("title").startswith(ours.pop("title"))
    assert shipped["links"]["duty"].pop("speed")
    assert shipped == ours


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("import town.inp --at-hour noon", "--at-hour: not a number of hours, expected such as 17 or 17.5, got noon"),
        ("import town.inp --at-hour -1", "--at-hour: out of range, expected a number from 0 to 8784, got -1"),
        ("import town.inp --material none.csv", "none.csv: cannot be read"),
        ("import town.cir --at-hour 3", "--at-hour: is for .inp files"),
        ("import town.inp --wave-speed fast", "--wave-speed: there is no number in front"),
        ("import town.inp --wave-speed 3kg", "--wave-speed: this unit measures something else"),
        ("import none.inp --wave-speed 1000", "none.inp: cannot be read, got No such file"),
        ("import town.cir --wave-speed 1000", "--wave-speed: is for .inp files"),
        ("import town.inp --wave-speed -3", "lines.intake.wave_speed"),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    if "none" in sentence or "lines" in sentence:
        pytest.importorskip("wntr")
    done = run(line)
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.replace('"', "").startswith(sentence)


def test_an_envelope_has_a_row_for_every_node(folder: Path) -> None:
    done = run(f"run {ROOT}/scenes/water_pipe.toml --envelope extremes.csv")
    assert (done.exit_code, done.stdout.splitlines()[-1]) == (0, "wrote extremes.csv")
    head, *rows = csv.reader((folder / "extremes.csv").read_text(encoding="utf-8").splitlines())
    extremes = [[f"{word} pressure [Pa]", "at [s]", "± error [Pa]"] for word in ("lowest", "highest")]
    assert head == ["node", "start pressure [Pa]", *extremes[0], *extremes[1]]
    assert [row[0] for row in rows] == ["reservoir", "valve"]
    # Joukowsky: 1 m/s at 980 kg/m³ and 1500 m/s, about 30 bar; the valve shuts at 0.2 s, the wave is back after 0.4 s
    start, low, low_at, _, high, high_at, _ = map(float, rows[1][1:])
    assert (start, low, high) == pytest.approx((30e5, 30e5 - 14.7e5, 30e5 + 14.7e5), rel=1e-4)
    assert low_at == pytest.approx(0.6, abs=0.01)
    assert high_at == pytest.approx(0.2, abs=0.01)
    assert all(float(x) == 30e5 for x in (rows[0][1], rows[0][2], rows[0][5]))


def test_an_envelope_needs_its_suffix() -> None:
    done = run(f"run {ROOT}/scenes/water_pipe.toml --envelope extremes.png")
    assert (done.exit_code, done.stderr) == (2, "--envelope: unknown kind of file, expected .csv, got 'extremes.png'\n")
