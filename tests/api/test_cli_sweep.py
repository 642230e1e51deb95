"""The surface of `tline sweep`: numbers, files, mistakes."""

import json
import random
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import xarray
from command_line import assert_refused, run
from run_scenes import driven_cable

from tline.errors import InputError
from tline.sweeps.work import SweepWork

LOAD = '[loads.end]\nat = "far"\nkind = "parallel"\nresistance = 100\ncapacitance = "4 pF"'
CABLE = driven_cable(LOAD).replace("[probes.far]", '[probes.near]\nat = "near"\n[probes.far]')
Z0 = "--vary 'lines.cable.z0=uniform(40 ohm, 0.06 kohm)'"


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    (folder / "cable.toml").write_text(CABLE, encoding="utf-8")
    (folder / "cable.npz").write_text("no archive", encoding="utf-8")
    return folder


def test_files_and_quantiles_are_of_the_same_runs(folder: Path) -> None:
    done = run(f"sweep cable.toml {Z0} --sample random:500 --json --csv r.csv --npz r.npz --plot r.png")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert (told["runs"], told["unit"], told["estimate"] < 1e-6) == (500, "V", True)
    table = np.genfromtxt(folder / "r.csv", delimiter=",", skip_header=1)
    head = (folder / "r.csv").read_text(encoding="utf-8").partition("\n")[0].split(",")
    with np.load(folder / "r.npz") as arrays:
        np.testing.assert_array_equal(table[:, head.index("lines.cable.z0")], arrays["lines.cable.z0"])
        np.testing.assert_array_equal(table[:, head.index("far highest voltage [V]")], arrays["highest"][:, 1])
        assert told["probes"]["far"]["highest"] == np.quantile(arrays["highest"][:, 1], [0.05, 0.5, 0.95]).tolist()
    assert (folder / "r.png").stat().st_size > 10_000


def test_numbers_drawn_are_those_asked_for(folder: Path) -> None:
    both = f"{Z0} --vary 'loads.end.resistance=normal(100, 5 ohm)'"
    drawn = []
    for seed in (1, 1, 2):
        assert run(f"sweep cable.toml {both} --sample random:400 --tol 1e-3 --seed {seed} --npz r.npz").exit_code == 0
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
    told = json.loads(run(f"sweep cable.toml {matched} --sample latin:50 --json").stdout)
    assert told["probes"]["near"]["lowest"] == [0.0, 0.0, 0.0]
    text = run(f"sweep cable.toml {matched} --sample latin:50").stdout
    assert re.search(r"^near +lowest \[mV\] +0 +0 +0$", text, re.MULTILINE)


def test_few_runs_are_told_one_by_one(folder: Path) -> None:
    done = run("sweep cable.toml --vary 'lines.cable.z0=40 ohm:60 ohm:3' --vary loads.end.resistance=100,50")
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("6 runs in ")
    head, *rows = done.stdout.splitlines()[2:]
    assert head.split("  ")[:2] == ["lines.cable.z0", "loads.end.resistance"]
    assert [row.split()[:2] for row in rows[:3]] == [["40", "100"], ["40", "50"], ["50", "100"]]


def test_failed_runs_are_told_and_exit_with_1(folder: Path) -> None:
    done = run("sweep cable.toml --vary lines.cable.z0=50,-1 --csv r.csv --netcdf r.nc")
    assert done.exit_code == 1
    sentence = "lines.cable.z0: z0 out of range, expected more than 0, got -1.0"
    assert done.stderr == f"note: 1 of 2 runs failed, run 1: {sentence}\n"
    assert (folder / "r.csv").read_text(encoding="utf-8").splitlines()[2].endswith(f'nan,"{sentence}"')
    with xarray.open_dataset(folder / "r.nc", engine="h5netcdf") as found:
        assert found.error.values.tolist() == ["", sentence]
        assert found.highest.sel({"lines.cable.z0": 50, "probe": "far"}) > 0.9


def test_a_tolerance_not_met_exits_with_1(folder: Path) -> None:
    fixed = "\n[solver]\norder = 2\nslab = '0.5 ns'\n"
    (folder / "cable.toml").write_text(CABLE + fixed, encoding="utf-8")
    done = run(f"sweep cable.toml {Z0} --sample random:2 --tol 1e-12")
    assert done.exit_code == 1
    assert done.stderr.startswith("note: 2 runs missed the tolerance, estimated errors up to ")


def test_ctrl_c_before_anything_is_done_writes_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("tline.sweeps.work.side_by_side", interrupted)
    before = sorted(folder.iterdir())
    done = run(f"sweep cable.toml {Z0} --sample random:30 --csv r.csv --npz r.npz --plot r.svg --resume go.npz")
    assert (done.exit_code, done.stdout, done.stderr.strip()) == (130, "", "interrupted")
    assert sorted(folder.iterdir()) == before


def test_ctrl_c_later_keeps_what_is_done_and_exits_with_130(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def batches(*_: object) -> Iterator[object]:
        yield from islice(made(*_), 1)
        raise KeyboardInterrupt

    made = SweepWork.batches
    monkeypatch.setattr(SweepWork, "batches", batches)
    monkeypatch.setattr("tline.sweeps.work.side_by_side", refused)
    line = "sweep cable.toml --vary lines.cable.z0=40:60:5 --resume go.npz --csv r.csv"
    done = run(line)
    assert done.exit_code == 130
    assert done.stderr == "note: interrupted: 4 of 5 runs are not made\n"
    with np.load("go.npz") as saved:
        assert saved["done"].sum() == 1


def refused(*_: object) -> None:
    raise InputError("scene", "is made one at a time")


def test_it_goes_on_from_a_file(folder: Path) -> None:
    line = f"sweep cable.toml {Z0} --sample random:30 --resume r.npz --keep '0 ns:8 ns:3'"
    assert run(line).exit_code == 0
    done = run(line)
    assert done.stdout.startswith("30 runs in ")
    assert (run(f"{line} --seed 3").exit_code, run(f"{line} --tol 1e-3").exit_code) == (2, 2)


def test_a_damaged_file_is_refused_or_read_rightly(folder: Path) -> None:
    """Byte by byte in its directory, and here and there in front of it."""
    line = "sweep cable.toml --vary lines.cable.z0=40,60 --resume r.npz --csv r.csv"
    assert run(line).exit_code == 0
    whole, right = Path("r.npz").read_bytes(), Path("r.csv").read_bytes()
    directory = whole.index(b"PK\1\2")
    chance = random.Random(3)
    places = [*range(directory, directory + 60), *chance.sample(range(len(whole)), 20)]
    for place in places:
        for byte in (5, 132):
            Path("r.npz").write_bytes(whole[:place] + bytes([byte]) + whole[place + 1 :])
            done = run(line)
            if done.exit_code == 0:
                assert Path("r.csv").read_bytes() == right
            else:
                assert done.exit_code == 2
                assert re.fullmatch(
                    r"r\.npz: (is no file of a sweep|holds another sweep), expected [^\n]*\n", done.stderr
                )


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("", "--vary: nothing varies, expected such as --vary"),
        ("--vary lines.cable.z0", "--vary: no values, expected PATH=VALUES, got 'lines.cable.z0'"),
        (f"{Z0} {Z0}", "--vary: lines.cable.z0 varies twice"),
        ("--vary lines.cabel.z0=40,50", "lines.cabel.z0: no such element, expected 'cable', got 'cabel'"),
        ("--vary lines.cable.z=40,50", "lines.cable.z: unknown key, expected 'z0'"),
        ("--vary 'lines.cable. =40'", "lines.cable.: not a path"),
        ("--vary lines.cable.z0=normal(50,2)", "--sample: lines.cable.z0 has a distribution, and no count of runs"),
        ("--vary lines.cable.z0=gauss(50,2)", "lines.cable.z0: not a distribution"),
        ("--vary lines.cable.z0=normal(50)", "lines.cable.z0: not a distribution"),
        ("--vary 'lines.cable.z0=normal(50,__import__(2))'", "lines.cable.z0: there is no number in front"),
        ("--vary lines.cable.z0=normal(50,nan)", "lines.cable.z0: not a finite number"),
        ("--vary 'lines.cable.z0=normal(50 V,2)'", "lines.cable.z0: this unit measures something else"),
        ("--vary lines.cable.z0=normal(50,-2)", "lines.cable.z0: a negative deviation"),
        ("--vary lines.cable.z0=uniform(60,40)", "lines.cable.z0: the lower limit is above the upper one"),
        ("--vary lines.cable.z0=loguniform(-60,40)", "lines.cable.z0: equal ratios through zero"),
        ("--vary lines.cable.z0=40:60:many", "lines.cable.z0: the count of '40:60:many': not a whole number"),
        ("--vary lines.cable.z0=40:60:5:lin", "lines.cable.z0: not a range"),
        ("--vary lines.cable.z0=-40,-60", "lines.cable.z0: z0 out of range, expected more than 0"),
        (f"{Z0} --sample random", "--sample: not a whole number in range"),
        (f"{Z0} --sample random:0", "--sample: not a whole number in range"),
        (f"{Z0} --sample sobol:100", "--sample: Sobol points are balanced by powers of two"),
        (f"{Z0} --sample dice:3", "--sample: unknown, expected one of 'grid', 'list', 'random:COUNT'"),
        (f"{Z0} --sample grid", "lines.cable.z0: a distribution, expected values for a grid"),
        ("--vary lines.cable.z0=40,50 --vary loads.end.resistance=1,2,3 --sample list", "--vary: not as many values"),
        (f"{Z0} --sample latin:3 --seed -1", "--seed: not a whole number in range"),
        (f"{Z0} --sample latin:3 --tol 1e-15", "--tol: tolerance out of range"),
        (f"{Z0} --sample latin:3 --keep extreme", "--keep: unknown, expected 'extremes', instants in s"),
        (f"{Z0} --sample latin:3 --keep '0 ns:9 ns:3'", "--keep: not instants of the run, expected 0 to 8e-09 s"),
        (f"{Z0} --sample latin:3 --workers none", "--workers: not a whole number in range"),
        (f"{Z0} --sample latin:3 --resume r.csv", "--resume: unknown kind of file, expected .npz"),
        (f"{Z0} --sample latin:3 --resume cable.npz", "cable.npz: is no file of a sweep"),
        (f"{Z0} --sample latin:3 --plot a.txt", "--plot: unknown kind of file"),
    ],
)
def test_a_mistake_is_one_sentence(line: str, sentence: str) -> None:
    assert_refused(f"sweep cable.toml {line}", sentence)
