"""The surface of `tline many`: numbers, files, mistakes."""

import json
import re
import shlex
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner

from tline.cli.main import main
from tline.cli.many import many

CABLE = """
medium = "electrical"
t_end = "8 ns"
[lines.cable]
nodes = ["near", "far"]
z0 = 50
delay = "1 ns"
[sources.driver]
at = "near"
kind = "voltage"
value = 1
resistance = 25
[loads.end]
at = "far"
kind = "parallel"
resistance = 100
capacitance = "4 pF"
[probes.near]
at = "near"
[probes.far]
at = "far"
"""
Z0 = "--vary 'lines.cable.z0=uniform(40 ohm, 0.06 kohm)'"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cable.toml").write_text(CABLE, encoding="utf-8")
    return tmp_path


def run(line: str):
    return CliRunner().invoke(main, shlex.split(line), catch_exceptions=False)


def test_files_and_quantiles_are_of_the_same_runs(folder: Path) -> None:
    done = run(f"many cable.toml {Z0} --runs 500 --json --csv r.csv --npz r.npz --plot r.png")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert (told["runs"], told["unit"], told["estimate"] < 1e-6) == (500, "V", True)
    table = np.genfromtxt(folder / "r.csv", delimiter=",", skip_header=1)
    head = (folder / "r.csv").read_text(encoding="utf-8").partition("\n")[0].split(",")
    with np.load(folder / "r.npz") as arrays:
        for name, key in (("lines.cable.z0", "lines.cable.z0"), ("far highest voltage [V]", "far/highest")):
            np.testing.assert_array_equal(table[:, head.index(name)], arrays[key])
        assert told["probes"]["far"]["highest"] == np.quantile(arrays["far/highest"], [0.05, 0.5, 0.95]).tolist()
    assert (folder / "r.png").stat().st_size > 10_000


def test_numbers_drawn_are_those_asked_for(folder: Path) -> None:
    both = f"{Z0} --vary 'loads.end.resistance=normal(100, 5 ohm)'"
    drawn = []
    for seed in (1, 1, 2):
        assert run(f"many cable.toml {both} --runs 400 --tol 1e-3 --seed {seed} --npz r.npz").exit_code == 0
        with np.load(folder / "r.npz") as arrays:
            drawn.append([arrays[place] for place in ("lines.cable.z0", "loads.end.resistance")])
    np.testing.assert_array_equal(drawn[0], drawn[1])
    assert not np.isin(drawn[0], drawn[2]).any()
    z0, resistance = drawn[0]
    assert 40 <= z0.min() < 42
    assert 58 < z0.max() <= 60
    assert abs(resistance.mean() - 100) < 5 * 5 / 400**0.5  # five standard errors
    assert abs(resistance.std() / 5 - 1) < 5 / 800**0.5
    assert abs(np.corrcoef(z0, resistance)[0, 1]) < 5 / 400**0.5


def test_a_matched_line_shows_one_value_in_all_runs() -> None:
    matched = "--vary lines.cable.delay=uniform(0.9e-9,1.1e-9)"
    told = json.loads(run(f"many cable.toml {matched} --runs 50 --json").stdout)
    assert told["probes"]["near"]["lowest"] == [0.0, 0.0, 0.0]
    text = run(f"many cable.toml {matched} --runs 50").stdout
    assert re.search(r"^near +lowest \[mV\] +0 +0 +0$", text, re.MULTILINE)


def test_a_tolerance_not_met_exits_with_1(folder: Path) -> None:
    (folder / "cable.toml").write_text(CABLE.replace("4 pF", "1e-7 pF"), encoding="utf-8")
    done = run(f"many cable.toml {Z0} --runs 4 --tol 1e-9")
    assert done.exit_code == 1
    assert done.stderr.startswith("note: the estimated error of ")


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("", "--vary: nothing varies, expected such as --vary"),
        ("--vary lines.cable.z0", "--vary: no distribution, expected PLACE=DISTRIBUTION, got 'lines.cable.z0'"),
        (f"{Z0} {Z0}", "--vary: lines.cable.z0 varies twice"),
        ("--vary lines.cabel.z0=normal(50,2)", "lines.cabel.z0: no number of the scene that may vary, expected 'lines"),
        ("--vary loads.end.inductance=normal(50,2)", "loads.end.inductance: no number of the scene that may vary"),
        ("--vary lines.cable.z0=50", "lines.cable.z0: not a distribution, expected one of 'uniform(low, high)', "),
        ("--vary lines.cable.z0=gauss(50,2)", "lines.cable.z0: not a distribution"),
        ("--vary lines.cable.z0=normal(50)", "lines.cable.z0: not a distribution"),
        ("--vary 'lines.cable.z0=normal(50,__import__(2))'", "lines.cable.z0: there is no number in front"),
        ("--vary lines.cable.z0=normal(50,nan)", "lines.cable.z0: not a finite number"),
        ("--vary 'lines.cable.z0=normal(50 V,2)'", "lines.cable.z0: this unit measures something else"),
        ("--vary lines.cable.z0=normal(50,-2)", "lines.cable.z0: a negative deviation"),
        ("--vary lines.cable.z0=normal(50,40)", "lines.cable.z0: 'normal(50,40)' drew "),
        ("--vary lines.cable.z0=uniform(60,40)", "lines.cable.z0: the lower limit is above the upper one"),
        ("--vary lines.cable.z0=uniform(-60,40)", "lines.cable.z0: limits out of range"),
        ("--vary lines.cable.z0=uniform(1,1e308)", "lines.cable.z0: limits out of range"),
        (f"{Z0} --runs 0", "--runs: not a whole number in range"),
        (f"{Z0} --runs many", "--runs: not a whole number in range"),
        (f"{Z0} --seed -1", "--seed: not a whole number in range"),
        (f"{Z0} --tol 1e-12", "--tol: tolerance out of range"),
        (f"{Z0} --plot a.txt", "--plot: unknown kind of file"),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    done = run(f"many cable.toml {line}")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(sentence)
    assert done.stderr.count("\n") == 1


COUPLED = """
nodes1 = ["near", "b"]
nodes2 = ["far", "c"]
even = { z0 = 60, delay = "1 ns" }
odd = { z0 = 40, delay = "1 ns" }
"""


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('nodes = ["near", "far"]\nz0 = 50\ndelay = "1 ns"\nwrong = 1', "lines.cable.wrong: unknown key"),
        ('nodes = ["near", "far"]\nz0 = 50\ndelay = "1 ns"\nlength = 0.1\nresistance = 1', "lines.cable: has losses"),
        (COUPLED, "lines.cable: has coupled conductors"),
    ],
)
def test_a_scene_it_does_not_take_is_one_sentence(line: str, sentence: str, folder: Path) -> None:
    own = re.sub(r"(?s)(?<=lines.cable]\n).*?(?=\[sources)", f"{line}\n", CABLE)
    (folder / "cable.toml").write_text(own, encoding="utf-8")
    done = run(f"many cable.toml {Z0}")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(sentence)


def test_every_option_has_a_help_text_and_every_example_runs(folder: Path) -> None:
    assert all(option.help for option in many.params if isinstance(option, click.Option))
    text = run("many --help").stdout.replace("\\\n", "")
    examples = re.findall(r"^ +tline (many .*)$", text, re.MULTILINE)
    assert len(examples) == 2
    for example in examples:
        done = run(example)
        assert done.exit_code == 0, done.output
    assert (folder / "runs.csv").exists()
