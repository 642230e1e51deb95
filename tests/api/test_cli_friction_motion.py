"""`tline friction motion`: prescribed motions from options and files, and their mistakes."""

import csv
import json
import shlex

import command_line
import pytest
from click.testing import CliRunner
from command_line import assert_refused
from matplotlib.image import imread

import friction
from tline.cli.main import main


def run(command):
    return command_line.run(f"friction motion {command}")


@pytest.fixture(autouse=True)
def folder(folder):
    (folder / "moved.csv").write_text("t [ms]; x [mm]\n# a stroke\n0;0\n500;1,5\n1000;0\n", encoding="utf-8")
    (folder / "driven.csv").write_text("0,0.1\n1,0.1\n", encoding="utf-8")
    for name, text in BAD.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


BAD = {
    "gap.csv": "t,x\n0,0\n1,\n2,0\n",
    "back.csv": "t,x\n0,0\n2,1\n1,0\n",
    "words.csv": "t,heat\n0,0\n",
    "twice.csv": "t,t\n0,0\n",
    "unit.csv": "t [m],x\n0,0\n",
    "empty.csv": "\n",
    "other.csv": "t,v\n0,0\n",
}


def test_numbers_are_the_librarys(folder):
    told = json.loads(run("lugre --velocity '5 cm/s' --frequency '1 Hz' --z0 '1 um' --csv out.csv --json").output)
    own = friction.prescribe(friction.LuGre(), velocity=friction.Sine(0.05, 1.0), t_end=2.0, z0=1e-6)
    assert told["lugre"]["F_f"] == own.F_f.tolist()
    assert told["lugre"]["errors"] == own.errors
    rows = list(csv.DictReader((folder / "out.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["z"]) for row in rows] == own.z.tolist()


def test_files_with_units_and_without_heading():
    told = json.loads(run("dahl --position moved.csv --json").output)["dahl"]
    table = friction.Table([0.0, 0.5, 1.0], [0.0, 0.0015, 0.0])
    assert told["F_f"] == friction.prescribe(friction.Dahl(), position=table).F_f.tolist()
    assert json.loads(run("coulomb --velocity driven.csv --json").output)["coulomb"]["x"][-1] == pytest.approx(0.1)


def test_rest_has_any_force():
    result = run("karnopp --velocity 0")
    assert "at rest (1001 of 1001 samples) any force up to 1.2 N; exact to rounding" in result.output
    assert json.loads(run("karnopp --velocity 0 --json").output)["karnopp"]["F_f"][0] is None


def test_formulas_and_elements(folder):
    law = "maxwell-slip --set stiffness='1 N/mm, 500' --set limits=0.4,0.6"
    sine = json.loads(run(f"{law} --position '2 mm' --frequency 1 --samples 50 --json").output)["maxwell-slip"]
    own = friction.MaxwellSlip([1000.0, 500.0], [0.4, 0.6])
    times = [2.0 * k / 50 for k in range(51)]
    there = friction.prescribe(own, position=friction.Sine(0.002, 1.0), t_end=2.0, times=times)
    assert sine["F_f"] == pytest.approx(there.F_f.tolist(), abs=1e-12)
    formula = json.loads(run(f"{law} --position '2m*sin(2*pi*t)' --t-end 2 --samples 50 --json").output)["maxwell-slip"]
    assert formula["F_f"] == pytest.approx(sine["F_f"], abs=1e-9)
    assert formula["errors"]["v"] < 1e-9
    held = json.loads(run("coulomb --velocity driven.csv --hold --json").output)["coulomb"]
    assert held["x"][-1] == pytest.approx(0.1)


def test_loops_are_drawn(folder):
    result = run("dahl karnopp --position '1 um, 2 mm' --frequency '1 Hz' --plot out.png")
    assert [line.split(":")[0] for line in result.output.splitlines()[:4]] == [
        "dahl, 1 µm", "karnopp, 1 µm", "dahl, 2 mm", "karnopp, 2 mm"
    ]  # fmt: skip
    assert imread(folder / "out.png")[..., :3].std() > 0.05


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("lugre", "--velocity: not one motion, expected --velocity or --position"),
        ("lugre --velocity 1 --position 1", "--velocity: not one motion"),
        ("lugre --position 1", "--position: needs its partner"),
        ("lugre --position 1 --frequency 0", "--frequency: too small"),
        ("lugre --position '1 m/s' --frequency 1", "--position: "),
        ("lugre --velocity 1 --frequency 1 --t-end 1e9", "--t-end: too many reversals"),
        ("lugre --velocity 1 --t-end 0", "--t-end: too small"),
        ("coulomb --velocity 1 --z0 1", "--z0: the coulomb model has no bristles"),
        ("lugre --position moved.csv --frequency 1", "--frequency: of a file"),
        ("lugre --velocity moved.csv", "--velocity: a column is missing, expected t and v, got t and x"),
        ("lugre --velocity 'sin(t' ", "--velocity: not an expression that can be computed: ')' is missing"),
        ("lugre --velocity t --frequency 1", "--frequency: of a formula"),
        ("lugre --velocity 1 --hold", "--hold: nothing to hold"),
        ("maxwell-slip --velocity 1", "--set: the maxwell-slip model needs stiffness and limits"),
        ("maxwell-slip --velocity 1 --set stiffness=1,2 --set limits=1", "--set limits: not one for each stiffness"),
        ("lugre --position none.csv", "--position: 'none.csv' cannot be read"),
        ("lugre --position gap.csv", "--position: line 3 is not 2 numbers, expected t, x"),
        ("lugre --position back.csv", "--position: line 4: time does not rise, expected more than 2 s, got 1"),
        ("lugre --position words.csv", "--position: unknown column, expected t, x, v, F, got 'heat'"),
        ("lugre --position twice.csv", "--position: a column twice"),
        ("lugre --position unit.csv", "--position: "),
        ("lugre --position empty.csv", "--position: no rows"),
        ("lugre --position other.csv", "--position: a column is missing"),
    ],
)
def test_mistakes(command, sentence):
    assert_refused(f"friction motion {command}", sentence)


@pytest.mark.parametrize(
    "text",
    [
        "t\tx\n0\t0\n0,5\t0,0015\n1\t0\n",
        "sep=;\nTime (ms);Position (mm)\n0;0\n500;1,5\n1000;0\n",
        "t,x,\ns,mm,\n0,0,\n0.5,1.5,\n1,0,\n",
        '"t"  "x"\n[ms] [mm]\n0    0\n500  1.5\n1000 0\n',
        "0 0\n0.5 0.0015\n1 0\n",
    ],
)
def test_dialects_say_the_same(text, folder):
    (folder / "dialect.csv").write_text(text, encoding="utf-8")
    moved, same = (run(f"lugre --json --position {name}.csv") for name in ("moved", "dialect"))
    assert (same.exit_code, same.stderr) == (0, "")
    told, other = (json.loads(each.output)["lugre"] for each in (moved, same))
    assert told["F_f"] == pytest.approx(other["F_f"], rel=1e-9)


def test_parameters_from_a_file(folder):
    moved = friction.prescribe(friction.Dahl(), velocity=friction.Sine(0.05, 1.0), t_end=2.0, times=TIMES)
    rows = [f"{1e3 * t:.17g};{1e3 * v:.17g};{f:.17g}" for t, v, f in zip(moved.t, moved.v, moved.F_f, strict=True)]
    (folder / "data.csv").write_text("\n".join(["t [ms]; v [mm/s]; F [N]", *rows]), encoding="utf-8")
    result = identified("data.csv --model coulomb --model dahl --plot fit.png --csv fit.csv")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.output.startswith("dahl: misses blocks left out by ")
    assert "coulomb: misses all samples by " in result.output
    assert imread(folder / "fit.png")[..., :3].std() > 0.05
    head, first, *_ = (folder / "fit.csv").read_text(encoding="utf-8").splitlines()
    assert head == "t,x,v,force,force dahl,force coulomb"
    told = json.loads(identified("data.csv --model dahl --json").output)
    assert told["fits"]["dahl"]["parameters"]["sigma0"] == pytest.approx(500.0, rel=1e-4)
    assert float(first.split(",")[3]) == moved.F_f[0]


TIMES = [k / 200 for k in range(401)]
RECORDS = {
    "level.csv": "t,x,F\n" + "".join(f"{k},{k % 7},1\n" for k in range(60)),
    "short.csv": "t,v,F\n0,1,2\n1,2,3\n",
    "bare.csv": "0,1,2\n1,2,3\n",
    "still.csv": "t,F\n0,1\n1,2\n",
    "hole.csv": "t,v,F\n0,1,2\n1,nan,3\n",
}


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("level.csv", "level.csv: constant, expected something that changes"),
        ("short.csv", "short.csv: too few samples, expected 50 to 100,000, got 2"),
        ("bare.csv", "bare.csv: no heading, expected names of columns in the first line"),
        ("still.csv", "still.csv: a column is missing, expected t, F and x or v, got t, F"),
        ("hole.csv", "hole.csv: line 3 is not 3 numbers, expected t, v, F"),
        ("level.csv --model stribeck", "--model: unknown, expected coulomb or"),
        ("level.csv --folds 1", "--folds: not a number of blocks, expected 2 to 20, got 1"),
        ("none.csv", "none.csv: 'none.csv' cannot be read"),
    ],
)
def test_records_that_tell_nothing(command, sentence, folder):
    for name, text in RECORDS.items():
        (folder / name).write_text(text, encoding="utf-8")
    result = identified(command)
    assert result.stderr.startswith(sentence)
    assert result.stderr.count("\n") == 1
    assert (result.exit_code, result.stdout) == (2, "")


def identified(command):
    return CliRunner().invoke(main, ["friction", "identify", *shlex.split(command)], catch_exceptions=False)
