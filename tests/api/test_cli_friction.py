"""`tline friction`: texts, exit codes, numbers in full, files; and the package's surface."""

import csv
import json

import command_line
import pytest
from command_line import assert_refused
from matplotlib.image import imread

import friction

LAW = "--set F_s=1.5 --set F_v=0 --set v_s=0.01"
HUNTING = f"run karnopp {LAW} --pid '100 N/m, 200 N/(m s), 5 N s/m' --target '1 cm' --t-end 60"


def run(command):
    return command_line.run(f"friction {command}")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("run coulomb", "break-away at 2 s"),
        ("run coulomb", "v = 16 m/s"),
        ("run coulomb --slope '2 N/s' --v0 -1", "reversal at 0.6180339887 s"),
        ("run karnopp", "break-away at 2.4 s"),
        ("run karnopp --set F_s='1500 mN'", "break-away at 3 s"),
        ("run lugre --set sigma0='0.1 N/um' --tol 1e-9", "v = 13.96402"),
        ("run coulomb --method euler --step '10 ms'", "more events"),
        ("run karnopp --spring '20 N/m' --pull '5 cm/s' --t-end 60", "stop at"),
        ("run elasto-plastic --sine '0.6 N' --frequency '1 Hz'", "rosenbrock (order 5): done"),
        ("run coulomb --set F_c=1 --method moreau --step 0.001", "moreau (order 1): done"),
        ("run coulomb --sine '0.5 N' --frequency '1 Hz' --offset '0.9 N' --slope '0.1 N/s'", "break-away at 0.0"),
        ("run coulomb karnopp --offset '2 N' --t-end 1", "karnopp by events"),
        ("run coulomb --x0 '4 cm' --spring '20 N/m' --pull 0", "x = 0.04 m, v = 0 m/s, F_f = -0.8 N"),
        ("run dahl --z0 '1 mm' --slope 0 --t-end '1 ms'", "F_f = 0.499"),
        (HUNTING, "sticks and slips to and fro: period 5.5367546 s, span 0.0091603998 m"),
    ],
)
def test_answers(command, words):
    result = run(command)
    assert words in result.output
    assert (result.exit_code, result.stderr) == (0, "")


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("run coulombe", "MODEL: unknown, expected coulomb or karnopp or"),
        ("run coulomb --mass -1", "--mass: too small, expected more than 0, got -1"),
        ("run coulomb --mass '1 m'", "--mass: "),
        ("run karnopp --set F_s=0.5", "--set F_s: below F_c, expected at least F_c = 1, got 0.5"),
        ("run karnopp --set v_s=0", "--set v_s: too small"),
        ("run karnopp --set sigma0=1", "--set: the karnopp model has no sigma0"),
        ("run karnopp --set F_s", "--set: no parameter"),
        ("run karnopp --set 'F_s=__import__(1)'", "--set F_s: "),
        ("run coulomb --method euler", "--step: 'euler' needs a step"),
        ("run coulomb --method euler --step 0", "--step: too small"),
        ("run coulomb --method euler --step 1e-15", "--step: too small"),
        (
            "run coulomb --method rosenbrock",
            "--method: 'rosenbrock' does not fit the coulomb model, expected events or",
        ),
        ("run coulomb --sine 1", "--sine: needs its partner"),
        ("run coulomb --spring 1", "--spring: needs its partner"),
        ("run coulomb --spring -1 --pull 1", "--spring: too small"),
        ("run coulomb --phase 1", "--phase: needs its partner, expected --sine beside it"),
        ("run coulomb --table nothing.csv --slope 1", "--table: another force than --slope"),
        ("run coulomb --hold", "--hold: needs its partner, expected --table beside it"),
        ("run coulomb --spring 1 --pid 1", "--pid: beside a spring"),
        ("run coulomb --target 1", "--target: needs its partner, expected --pid beside it"),
        ("run coulomb --pid 1,2,3,4", "--pid: too many gains"),
        ("run coulomb --pid 1,-2", "--pid: too small"),
        ("run coulomb --play '1 mm'", "--play: needs its partner, expected --spring beside it"),
        ("run lugre --spring 1 --pull 1 --play '1 mm'", "--method: 'taylor' knows no play"),
        ("run coulomb --limit 1", "--limit: needs its partner, expected --pid beside it"),
        ("run coulomb --pid 1 --limit '0 N'", "--limit: too small, expected more than 0"),
        ("run coulomb --pid 1 --delay '1 ms'", "--delay: without a period"),
        ("run coulomb --pid 1 --period '1 ms' --delay '1 h'", "--delay: too long"),
        ("run lugre --pid 1", "--method: 'taylor' knows no controller"),
        ("run coulomb --method euler --step 1 --samples 5", "--samples: 'euler' has fixed steps"),
        ("run coulomb karnopp --set sigma0=1", "--set: the coulomb or karnopp model has no sigma0"),
        ("run coulomb --table nothing.csv", "--table: 'nothing.csv' cannot be read"),
        ("run coulomb --plot out.gif", "--plot: unknown kind of file"),
        ("run coulomb --t-end 0", "--t-end: too small"),
        ("run coulomb --z0 1", "--z0: the coulomb model has no bristles"),
    ],
)
def test_mistakes(command, sentence, folder):
    assert_refused(f"friction {command}", sentence)


def test_a_force_table_is_read_and_checked(folder):
    (folder / "force.csv").write_text("t,F\n0,0\n1,2\n3,2\n", encoding="utf-8")
    told = json.loads(run("run coulomb --table force.csv --t-end 3 --json").output)
    assert told["end"]["v"] == pytest.approx(2.25)
    (folder / "force.csv").write_text("0,0\n1,nan\n", encoding="utf-8")
    assert run("run coulomb --table force.csv").stderr.startswith("--table: line 2 is not 2 numbers, expected t, F")
    (folder / "force.csv").write_text("0,0,1\n", encoding="utf-8")
    assert run("run coulomb --table force.csv").stderr.startswith("--table: line 1 is not 2 numbers")


def test_a_held_table_jumps(folder):
    (folder / "force.csv").write_text("t [s]; F [N]\n0; 0\n1; 2,0\n", encoding="utf-8")
    told = json.loads(run("run coulomb --table force.csv --hold --t-end 3 --samples 3 --csv out.csv --json").output)
    assert told["events"] == [{"kind": "break-away", "t": 1.0, "x": 0.0}]
    assert told["end"]["v"] == pytest.approx(2.0)
    rows = list(csv.DictReader((folder / "out.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["t"]) for row in rows] == [0.0, 1.0, 2.0, 3.0]


def test_several_models_are_told_by_their_names():
    told = json.loads(run("run coulomb lugre --set sigma0=1e3 --json").output)
    own = [friction.simulate(law, friction.Testbench()) for law in (friction.Coulomb(), friction.LuGre(sigma0=1e3))]
    assert {name: each["end"]["v"] for name, each in told.items()} == {each.model.name: each.v[-1] for each in own}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("lugre --method rk4 --step 0.01", "grows without bound"),
        ("lugre --sine '2 N' --frequency '5 Hz' --t-end 1 --tol 1e-14", "done, but the tolerance is not met"),
        ("lugre --budget 10", "the budget of steps is spent, a larger budget goes on"),
    ],
)
def test_what_is_not_met_exits_with_one(arguments, words):
    result = run(f"run {arguments}")
    assert (result.exit_code, words in result.output) == (1, True)


def test_errors_are_told_with_the_numbers():
    stiff = "run lugre --set sigma0=1e5 --sine '2 N' --frequency '1 Hz' --t-end 2"
    told = json.loads(run(f"{stiff} --tol 1e-3 --json").output)
    assert set(told["errors"]) == {"t", "x", "v", "z", "F_a", "F_f", "W_a", "W_f"}
    assert (told["tol"], max(told["errors"].values()) <= 1e-3, told["event_count"]) == (1e-3, True, 7)
    assert "; worst: " in run(f"{stiff} --tol 1e-3").output
    assert json.loads(run("run karnopp --json").output)["errors"] is None
    assert "errors: those of rounding" in run("run karnopp").output
    assert "errors: not estimated by euler" in run("run coulomb --method euler --step '10 ms'").output


def test_a_steep_ramp_breaks_away_once():
    told = json.loads(run("run karnopp --slope '1000 N/s' --t-end '100 s' --json").output)
    assert told["status"] == "done"
    assert told["events"] == [{"kind": "break-away", "t": 0.0012, "x": 0.0}]


def test_numbers_are_the_librarys(folder):
    told = json.loads(run("run karnopp --json --csv run.csv").output)
    own = friction.simulate(friction.Karnopp(), friction.Testbench())
    assert told["end"]["v"] == own.v[-1]
    assert told["events"] == [{"kind": "break-away", "t": own.events[0].t, "x": 0.0}]
    assert told["energy"]["residual"] == own.ledger.residual
    rows = list(csv.DictReader((folder / "run.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["F_f"]) for row in rows] == own.F_f.tolist()


@pytest.mark.parametrize("command", ["run lugre --plot", "run lugre karnopp --plot"])
def test_pictures_show_something(command, folder):
    assert run(f"{command} out.png").exit_code == 0
    assert imread(folder / "out.png")[..., :3].std() > 0.05


@pytest.mark.parametrize("v0", [-5.0, 0.0])
def test_friction_that_is_nowhere_above_zero_is_seen(v0):
    run = friction.simulate(friction.Coulomb(), friction.Testbench(friction.Ramp(0.0), v0=v0), 1.0)
    low, high = run.plot().axes[1].get_ylim()
    assert low <= run.F_f.min() <= run.F_f.max() <= high


def test_angular_frequencies_are_no_frequencies():
    sines = [
        json.loads(run(f'run coulomb --sine "0.6 N" --t-end "0.1 s" --frequency "{frequency}" --json').stdout)
        for frequency in ("1 Hz", "1", "6.283185307179586 rad/s", "360 deg/s")
    ]
    assert sines[1:] == sines[:1] * 3
