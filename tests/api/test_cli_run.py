"""The surface of `tline run` and `tline schema`: what they print, write, refuse and import."""

import csv
import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from run_scenes import FORK, VALVE

from tline.cli.main import COMMANDS, main
from tline.cli.run import FILES, run
from tline.cli.scene_files import schema
from tline.scene.file import read_scene, scene_from
from tline.solver import simulate as simulation


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    """The folder in which the commands run, with two scenes."""
    (folder / "valve.toml").write_text(VALVE)
    (folder / "fork.toml").write_text(FORK)
    return folder


def call(line: str) -> Result:
    return CliRunner().invoke(main, shlex.split(line))


def ran(line: str) -> Result:
    result = call(line)
    assert (result.exit_code, result.exception) == (0, None), result.output
    return result


def test_the_table_says_what_the_probes_saw() -> None:
    result = ran("run valve.toml")
    title, chosen, accuracy, empty, *table = result.stdout.splitlines()
    assert title == "Closing valve"
    told = r"order 4, 500 slabs of 4 ms, 4,000 line-end samples in [0-9.e-]+ s; "
    grid = "common tick of delays and fronts, predicted cost 4,000 samples without fronts"
    assert re.fullmatch(told + grid, chosen)
    reached = (
        r"estimated error [0-9.e-]+ of the amplitude at '(probe|middle)', 1e-06 asked and met; 2 runs in [0-9.e-]+ s"
    )
    assert re.fullmatch(reached, accuracy)
    assert empty == ""
    *rows, errors = zip(*(re.split(r"\s{2,}", row.rstrip()) for row in table), strict=True)
    assert errors[0] == "± error"
    assert all(0 <= float(error) < 1e-6 for error in errors[1:])
    assert [list(row) for row in zip(*rows, strict=True)] == [
        ["probe", "quantity", "minimum", "at [s]", "maximum", "at [s]", "at the end"],
        ["probe", "pressure [bar]", "1.3", "0.5", "10.7", "0.1", "10.7"],  # 6 ± 4.7, the jump z0·y
        ["", "flow [L/s]", "0", "0.1", "10", "0", "0"],
        ["middle", "pressure [bar]", "1.3", "0.6", "10.7", "0.2", "10.7"],
        ["", "flow [L/s]", "-10", "0.4", "10", "0", "0"],
    ]
    assert len({len(row) for row in table}) == 1  # aligned
    assert result.stderr == ""


def test_json_has_everything_in_full_precision_and_nothing_else() -> None:
    result = ran("run valve.toml --json --csv out.csv")
    told = json.loads(result.stdout)
    expected = simulation.simulate(read_scene("valve.toml"))
    assert told["title"] == "Closing valve"
    assert (told["order"], told["slab"], told["slabs"]) == (*expected.resolution[:2], len(expected.t) - 1)
    assert told["line_end_samples"] == expected.samples
    assert told["end_time"] == expected.t[-1]
    pressure = told["probes"]["probe"]["pressure"]
    assert pressure["unit"] == "Pa"
    assert pressure["maximum"] == pytest.approx(expected.probes["probe"].u.max(), rel=1e-14)  # a few roundings
    assert pressure["minimum"] == pytest.approx(expected.probes["probe"].u.min(), rel=1e-14)
    assert pressure["end"] == expected.probes["probe"].u[-1]
    assert pressure["maximum_time"] == pytest.approx(0.1)
    assert told["probes"]["middle"]["flow"]["unit"] == "m^3/s"
    assert (told["notes"], told["files"]) == ([], ["out.csv"])


def test_notes_go_to_stderr_and_into_the_json(folder: Path) -> None:
    (folder / "early.toml").write_text(FORK.replace('"40 ns"', '"1 ns"'))  # ends before the step
    result = ran("run early.toml --json")
    notes = json.loads(result.stdout)["notes"]
    assert notes
    assert result.stderr.splitlines() == [f"note: {note}" for note in notes]


def test_order_and_slab_override_the_scene(folder: Path) -> None:
    told = json.loads(ran("run valve.toml --order 8 --slab '10 ms' --json").stdout)
    assert (told["order"], told["slab"]) == (8, 0.01)
    (folder / "own.toml").write_text(VALVE + "[solver]\norder = 3\nslab = '20 ms'\n")
    told = json.loads(ran("run own.toml --slab 0.04 --json").stdout)
    assert (told["order"], told["slab"]) == (3, 0.04)


def test_a_table_beside_the_scene_is_found_when_the_solver_is_overridden(folder: Path) -> None:
    (folder / "sub").mkdir()
    (folder / "sub" / "rise.csv").write_text("0, 0\n1e-9, 1\n")
    scene = FORK.replace('{shape = "step", to = "1 V", at = "1.03 ns"}', '{shape = "table", file = "rise.csv"}')
    (folder / "sub" / "fork.toml").write_text(scene)
    assert json.loads(ran("run sub/fork.toml --order 4 --json").stdout)["order"] == 4


def test_all_files_are_written_and_named(folder: Path) -> None:
    others = {"load_lines", "states"}  # for resistive ends; for what has a state
    files = {kind: f"out-{kind}{each.suffixes[0]}" for kind, each in FILES.items() if kind not in others}
    options = " ".join(f"--{kind.replace('_', '-')} {file}" for kind, file in files.items())
    result = ran(f"run valve.toml {options} --path valve,tank")
    assert result.stdout.splitlines()[-len(files) :] == [f"wrote {file}" for file in files.values()]
    assert {path.name for path in folder.iterdir()} == {"valve.toml", "fork.toml", *files.values()}
    for file in (
        "out-plot.png",
        "out-profile.png",
        "out-map.png",
        "out-space_time.png",
        "out-plot_waves.png",
        "out-lattice.png",
    ):
        assert (folder / file).read_bytes().startswith(b"\x89PNG")
    assert '"marks":[[0.0,"valve"],[300.0,"tank"]]' in (folder / "out-animate.html").read_text(encoding="utf-8")
    table = np.loadtxt(folder / "out-csv.csv", delimiter=",", skiprows=1)
    expected = simulation.simulate(read_scene("valve.toml"))
    np.testing.assert_array_equal(table[:, 1], expected.probes["probe"].u)
    with np.load(folder / "out-npz.npz") as data:
        assert scene_from(tomllib.loads(str(data["scene"]))) == read_scene("valve.toml")


def test_a_ledger_is_printed_told_and_written(folder: Path) -> None:
    *_, reservoir, valve, total, closes, wrote = ran("run valve.toml --ledger-csv books.csv").stdout.splitlines()
    # 6 bar · 10 L/s for 0.1 s through the valve; out of the tank until 0.3 s, then to and fro for 0.4 s each
    assert reservoir.split() == ["loads.tank", "1.2", "0", "0", "0", "0"]
    assert valve.split() == ["loads.valve", "0", "0.6", "0", "0", "0"]
    assert total.split()[0] == "sum"
    assert closes.startswith("the ledger closes: ")
    assert wrote == "wrote books.csv"
    told = json.loads(ran("run valve.toml --ledger --json").stdout)["ledger"]
    head, *rows = csv.reader((folder / "books.csv").read_text(encoding="utf-8").splitlines())
    assert head[:3] == ["where", "supplied [J]", "dissipated [J]"]
    assert [row[0] for row in rows] == list(told["accounts"])
    assert [float(row[2]) for row in rows] == [account["dissipated"] for account in told["accounts"].values()]
    assert told["accounts"]["loads.valve"]["dissipated"] == pytest.approx(600.0, rel=1e-9)
    assert json.loads(ran("run valve.toml --json").stdout)["ledger"] == told
    assert json.loads(ran("run valve.toml --no-ledger --json").stdout)["ledger"] is None


def test_lines_on_the_path_are_recorded() -> None:
    ran("run fork.toml --space-time x.svg --path up,down")


MISTAKES = [
    ("none.toml", "none.toml: cannot be read, got No such file or directory"),
    ("valve.toml --order 17", "--order: not a whole number in range, expected one from 1 to 16, got '17'"),
    ("valve.toml --order many", "--order: not a whole number in range, expected one from 1 to 16, got 'many'"),
    ("valve.toml --slab '1 s'", "--slab: longer than the shortest delay, expected at most that of lines.pipe, 0.2 s"),
    (
        "valve.toml --slab '1 bar'",
        "--slab: this unit measures something else, expected a time such as '1 s', got '1 bar'",
    ),
    ("valve.toml --csv out.xlsx", "--csv: unknown kind of file, expected .csv, got 'out.xlsx'"),
    (
        "valve.toml --no-ledger --ledger-csv out.csv",
        "--ledger-csv: there is no ledger to write, expected no --no-ledger beside it",
    ),
    ("valve.toml --npz out", "--npz: unknown kind of file, expected .npz, got 'out'"),
    ("valve.toml --plot out.jpg", "--plot: unknown kind of file, expected .png or .svg or .pdf, got 'out.jpg'"),
    (
        "valve.toml --space-time a.html",
        "--space-time: unknown kind of file, expected .png or .svg or .pdf, got 'a.html'",
    ),
    ("valve.toml --animate out.mov", "--animate: unknown kind of file, expected .html or .gif or .mp4, got 'out.mov'"),
    ("valve.toml --csv no/out.csv", "no/out.csv: cannot be written, got no such file or directory"),
    (
        "valve.toml --plot a.png --lattice ./a.png",
        "--lattice: would overwrite what --plot writes, expected another file",
    ),
    (
        "valve.toml --path tank,valve",
        "--path: nothing shows it, expected --profile, --space-time, --plot-waves or --animate",
    ),
    ("valve.toml --path tank --animate a.gif", "--path: not two nodes or more, expected FROM,TO or FROM,…,TO"),
    ("valve.toml --path tank,vale --animate a.gif", "--path: no such node, expected 'valve', got 'vale'"),
    (
        "valve.toml --path tank,tank --animate a.gif",
        "--path: leads nowhere, expected two different nodes, got 'tank' twice",
    ),
    ("fork.toml --animate a.gif", "--path: the lines form no chain, expected the two nodes between which to look"),
    ("fork.toml --lattice a.png", "--lattice: a bounce diagram shows one line, expected a scene with one line, got 3"),
]


@pytest.mark.parametrize(("line", "sentence"), MISTAKES, ids=[line for line, _ in MISTAKES])
def test_mistakes_are_said_in_one_sentence(line: str, sentence: str, folder: Path) -> None:
    before = set(folder.iterdir())
    result = call(f"run {line}")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith(sentence)
    assert result.stderr.count("\n") == 1
    assert set(folder.iterdir()) == before


def test_both_options_are_named_if_both_are_wrong() -> None:
    result = call("run valve.toml --order 0 --slab -1")
    assert result.exit_code == 2
    assert [line.split(":")[0] for line in result.stderr.splitlines()] == ["--order", "--slab"]


def test_mistakes_of_the_scene_keep_their_names(folder: Path) -> None:
    (folder / "bad.toml").write_text(VALVE.replace("wave_speed", "wavespeed"))
    result = call("run bad.toml --order 4")
    assert result.exit_code == 2
    assert "lines.pipe.wavespeed: unknown key, expected 'wave_speed'" in result.stderr


@pytest.mark.parametrize(
    "line",
    [line for line, _ in MISTAKES if not re.search(r"none\.toml|--slab '1 s'", line)] + ["valve.toml --plot d.png"],
)
def test_nothing_is_simulated_for_files_that_cannot_be_written(
    line: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "d.png").mkdir()
    monkeypatch.setattr(simulation, "simulate", lambda *_, **__: pytest.fail("simulated"))
    assert call(f"run {line}").exit_code == 2


ACTIVE = (
    FORK
    + """
[loads.amplifier]
at = "in"
kind = "impedance"
expression = "-2000"
"""
)


def test_an_active_load_runs_only_when_asked_twice(folder: Path) -> None:
    (folder / "active.toml").write_text(ACTIVE, encoding="utf-8")
    refused = call("run active.toml")
    assert refused.exit_code == 1
    said = "loads.amplifier is active: Re Z(jω) < 0 for all ω; yet no wave grows by more than 0.1 % within the run"
    assert refused.stderr == f"{said}, expected passive elements, or --active to run it all the same\n"
    allowed = call("run active.toml --active")
    assert allowed.exit_code == 0
    assert f"note: {said}" in allowed.stderr


def test_help_teaches_with_examples_whose_options_exist() -> None:
    text = ran("run --help").stdout
    examples = re.findall(r"^ *tline (run .*)$", text.replace("\\\n", " "), re.MULTILINE)
    assert len(examples) == 6
    for example in examples:
        _, *words = shlex.split(example)
        run.make_context("run", words)


def test_schema_is_the_one_of_scene_files(folder: Path) -> None:
    printed = json.loads(ran("schema").stdout)
    assert set(printed["required"]) == {"medium", "t_end", "lines", "probes"}
    assert set(tomllib.loads(VALVE)) <= set(printed["properties"])
    assert ran("schema -o scene.json").stdout == "wrote scene.json\n"
    assert json.loads((folder / "scene.json").read_text(encoding="utf-8")) == printed
    result = call("schema -o no/scene.json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "no/scene.json: cannot be written, got no such file or directory\n"


def test_both_are_listed() -> None:
    text = ran("--help").stdout
    assert all(f"  {name} " in text for name in ("run", "schema"))
    assert COMMANDS["schema"][0] == f"{schema.function.__module__}:schema"  # type: ignore[union-attr]


def imported(line: str, first: str = "") -> set[str]:
    """Modules that are loaded after a command has run in a process of its own."""
    program = f"""
import sys
{first}
from tline.cli.main import main
main({shlex.split(line)!r}, standalone_mode=False)
print("\\n", *sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=300)
    assert done.stderr == ""  # and no progress bar in a pipe
    return set(done.stdout.splitlines()[-1].split())


def test_imports_are_no_more_than_needed() -> None:
    assert not imported("run --help") & {"numpy", "scipy", "numba", "pydantic", "matplotlib"}
    heavy = {"matplotlib", "PIL", "tqdm", "flint", "passivity", "wntr", "skrf", "pint", "fluids"}
    heavy |= {f"scipy.{part}" for part in ("signal", "optimize", "special", "sparse", "stats", "integrate")}
    unused = {"numba", "scipy", "numpy.ma", "numpy.random", "difflib", "html"}  # all is compiled and kept by now
    others = {
        f"tline.scene.{kind}" for kind in ("elements", "pump", "vessel", "multiport", "touchstone", "ibis.element")
    }
    assert not imported("run valve.toml") & (heavy | unused | others)
    assert not imported("run valve.toml --csv a.csv --npz a.npz --animate a.html") & {"matplotlib", "PIL", "IPython"}
    few = "from tline.pictures import animation; animation.FRAMES = 9"
    assert "matplotlib.pyplot" not in imported("run valve.toml --plot a.png --lattice b.svg --animate c.gif", few)


def test_a_tolerance_that_is_not_met_says_so_and_exits_with_1(folder: Path) -> None:
    slow = FORK.replace(
        "[probes.in]", '[loads.c]\nat = "up"\nkind = "parallel"\nresistance = 50\ncapacitance = "1 nF"\n[probes.in]'
    )
    (folder / "rc.toml").write_text(slow)
    asked = "run rc.toml --order 2 --slab '2 ns' --tol 1e-12"
    result = CliRunner().invoke(main, shlex.split(asked))
    assert result.exit_code == 1
    assert "1e-12 NOT met: order and slab are fixed by hand" in result.stdout
    told = CliRunner().invoke(main, [*shlex.split(asked), "--json"])
    accuracy = json.loads(told.stdout)["accuracy"]
    assert (accuracy["tol"], accuracy["met"]) == (1e-12, False)
    assert accuracy["estimate"] > 1e-12


def test_a_tolerance_in_the_scene_counts(folder: Path) -> None:
    (folder / "own.toml").write_text(VALVE + "[solver]\ntol = '0.1 %'\n")
    told = json.loads(ran("run own.toml --json").stdout)["accuracy"]
    assert (told["tol"], told["met"]) == (1e-3, True)
    assert [attempt["order"] for attempt in told["runs"]] == [2, 3]
    told = json.loads(ran("run own.toml --tol 1e-9 --json").stdout)["accuracy"]
    assert told["tol"] == 1e-9


@pytest.mark.parametrize(
    ("tol", "message"),
    [
        ("0", "--tol: tolerance out of range, expected at least 1e-13, got '0'"),
        ("3", "--tol: tolerance out of range, expected at most 0.1, got '3'"),
        ("1 mm", "--tol: "),
        ("small", "--tol: "),
    ],
)
def test_no_tolerance(tol: str, message: str) -> None:
    result = CliRunner().invoke(main, ["run", "valve.toml", "--tol", tol])
    assert result.exit_code == 2
    assert result.stderr.startswith(message)
    assert len(result.stderr.splitlines()) == 1
