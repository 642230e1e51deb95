"""`tline drives`: texts, exit codes, numbers in full, files; and the package's surface."""

import csv
import json
import time
from dataclasses import replace

import command_line
import numpy as np
import pytest
from command_line import assert_refused
from matplotlib.image import imread

import drives
from drives import CoupledDrives, Spool, Torque

BOTH = '"0.1 N m"'


def run(command):
    return command_line.run(f"drives {command}")


def told(command):
    result = run(f"{command} --json")
    assert (result.exit_code, result.stderr) == (0, "")
    return json.loads(result.stdout)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("bode --from '1 Hz' --to '10 Hz' --points 2", " 62.832 "),
        ("step --step '0.3 s'", "highest sample at 1.8 s"),
        ("bode", "x_k/T1 = -70.71067812/(s^2 + 500*s + 2000)"),
        ("control --period '10 ms' --delay '4 ms' --filter-time '3 ms' --slack", "belt_speed [m/s]"),
        ("control --coulomb '0.04 N m' --speed '0.1 m/s'", "events of the left spool (2): stop at "),
        ("bode --output phi1", "DC gain -inf"),
        ("bode --angle '60 deg' --output tension", "tension/T2 = 20000/(s^2 + 900*s + 4000)"),  # k_p = 200 N/m
        ("bode --radius '10 cm, 5 cm' --inertia '1e-3 kg m^2, 2e-3 kg m^2'", "x_k/T2 = ("),
        ("step --t1 0.1Nm --t2 0.1Nm", "tension [N]             0     0.999683"),
        ("step --t2 '-0.1 N m' --slack", "tension [N]  0"),
        ("step --coulomb '0.04 N m, 0 N m'", "events of the left spool (1): stop at 0.356"),
        ("control", "gain 0.40325, integral time 0.01 s"),
        ("control --limit '2 N m' --no-antiwindup", "energy [J]"),
    ],
)
def test_answers(command, words):
    result = run(command)
    squeezed = " ".join(words.split())
    assert squeezed in " ".join(result.output.split())
    assert (result.exit_code, result.stderr) == (0, "")


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("bode --angle '90 deg'", "--angle: not physical, expected more than 0 and less than 90"),
        ("bode --angle 45", "--angle: the unit is missing, expected a quantity such as '45 deg', got '45'"),
        ("bode --radius 0.1", "--radius: the unit is missing, expected a quantity such as '1 m', got '0.1'"),
        ("bode --radius '0 m'", "--radius: not physical, expected more than 0"),
        ("bode --radius '1 kg'", "--radius: this unit measures something else"),
        ("bode --friction '-1 N m s'", "--friction: not physical, expected 0 or more"),
        ("bode --inertia '1 kg m^2, 2 kg m^2, 3 kg m^2'", "--inertia: the wrong number of values"),
        ("bode --pulley-stiffness '1 N/m, 2 N/m'", "--pulley-stiffness: the wrong number of values"),
        ("bode --belt-stiffness 'inf N/m'", "--belt-stiffness: not a finite number"),
        ("bode --output speed", "--output: unknown name, expected x_k or tension"),
        ("bode --from '10 rad/s' --to '1 rad/s'", "--from: no range"),
        ("bode --to '3 m'", "--to: this unit measures something else, expected a frequency such as '1 rad/s'"),
        ("bode --plot out.gif", "--plot: unknown kind of file"),
        ("bode --csv out.txt", "--csv: unknown kind of file"),
        ("bode --csv nowhere/out.csv", "nowhere/out.csv: cannot be written"),
        ("bode --parameters nothing.toml", "nothing.toml: cannot be read"),
        ("bode --parameters typo.toml", "typo.toml: radus: unknown parameter, expected inertia"),
        ("bode --parameters number.toml", "number.toml: radius: not a text with a unit"),
        ("bode --parameters broken.toml", "broken.toml: is not valid TOML"),
        ("step --table late.csv", "late.csv: line 4: time does not rise, expected more than 2 s, got 1"),
        ("step --table short.csv", "short.csv: line 3 is not 3 numbers, expected t, T1, T2"),
        ("step --table bare.csv", "bare.csv: no heading, expected names of columns in the first line, such as t [s]"),
        ("step --table empty.csv", "empty.csv: no rows"),
        ("step --table part.csv", "part.csv: a column is missing, expected t, T1, T2, got t, T1"),
        (f"step --table late.csv --t1 {BOTH}", "--table: the torques are given twice"),
        ("step --hold", "--hold: needs its partner, expected --table beside it"),
        ("step --t1 5", "--t1: the unit is missing"),
        ("step --rise '0 s'", "--rise: not a time"),
        ("step --t-end '1 s' --step '2 s'", "--step: unfit"),
        ("step --t-end '1e9 s' --step '1 us'", "--step: unfit"),
        ("control --limit '0 N m'", "--limit: not physical"),
        ("step --break-away '1 N m'", "--break-away: needs its partner, expected --coulomb beside it"),
        ("step --coulomb '1 N m' --stribeck '1 rad/s'", "--stribeck: needs its partner, expected --break-away"),
        ("step --coulomb '1 N m' --break-away '0.5 N m'", "--break-away: below F_c"),
        ("step --coulomb '1'", "--coulomb: the unit is missing"),
        ("step --coulomb '1 N m, 2 N m, 3 N m'", "--coulomb: the wrong number of values"),
        ("control --speed-bandwidth '0 rad/s'", "--speed-bandwidth: not physical"),
        ("control --friction '0 N m s' --belt-damping '0 N s/m'", "tension/tau_f: no PI controller of this rule"),
    ],
)
def test_mistakes(command, sentence, folder):
    for name, text in (
        ("typo.toml", 'radus = "1 m"'),
        ("number.toml", "radius = 0.1"),
        ("broken.toml", "radius = "),
        ("late.csv", "t,T1,T2\n0,0,0\n2,1,1\n1,1,1\n"),
        ("short.csv", "t,T1,T2\n0,0,0\n2,1\n"),
        ("bare.csv", "0,0,0\n"),
        ("empty.csv", ""),
        ("part.csv", "t,T1\n0,0\n"),
    ):
        (folder / name).write_text(text, encoding="utf-8")
    assert_refused(f"drives {command}", sentence)


@pytest.mark.parametrize(
    ("options", "verdict"),
    [
        ("--tension-bandwidth '400 rad/s'", "the tension loop reaches 286.3 rad/s, not the 400 rad/s asked for"),
        ("--tension-bandwidth '100 Hz'", "the tension loop reaches 286.3 rad/s, not the 628.3 rad/s asked for"),
        (
            "--tension '50 N' --limit '2 N m'",
            "cannot be held: they take T1 = 4 N m and T2 = 6 N m, and the limit is 2 N m; "
            "at that speed the largest tension is 10 N; at no speed more than 20 N",
        ),
        ("--speed '5 m/s' --limit '2 N m'", "at that tension the largest speed is 1.5 m/s"),
        ("--disturbance='-3 N m' --limit '2 N m'", "from 1 s on, a belt speed of 1 m/s and a tension of 5 N cannot"),
    ],
)
def test_what_cannot_be_had_is_said_and_exits_1(options, verdict, folder):
    plain, table = run(f"control {options}"), run(f"control {options} --json --csv run.csv")
    assert (plain.exit_code, table.exit_code) == (1, 1)
    assert verdict in plain.stdout.splitlines()[-1]
    assert [verdict in one for one in json.loads(table.stdout)["verdicts"]] == [True]
    assert (folder / "run.csv").exists()


@pytest.mark.parametrize("options", ["step", "step --slack", "control", "control --limit '2 N m'"])
def test_a_run_that_does_not_fit_the_equations_is_said_and_exits_1(options, monkeypatch):
    right = CoupledDrives.state_space

    def faulty(self, *ports):
        model = right(self, *ports)
        return replace(model, c=2 * model.c)

    monkeypatch.setattr(CoupledDrives, "state_space", faulty)
    plain, table = run(options), run(f"{options} --json")
    assert (plain.exit_code, table.exit_code) == (1, 1)
    assert plain.stdout.splitlines()[-1].startswith("two methods disagree at ")
    assert plain.stdout.splitlines()[-1] in json.loads(table.stdout)["verdicts"]


def test_what_is_asked_for_is_reached():
    seen = told("control --tension-bandwidth '200 rad/s'")
    band = seen["design"]["tension"]["bandwidth"]
    assert (band, seen["verdicts"]) == ({"asked": 200.0, "reached": 200.0}, [])
    assert seen["design"]["tension"]["crossover"] == pytest.approx(200, rel=1e-12)


def test_a_belt_that_pushes_is_noted():
    result = run("step --t1 '-0.1 N m' --json")
    assert result.exit_code == 0
    assert result.stderr == f"note: {json.loads(result.stdout)['notes'][0]}\n"
    assert "the belt pushes" in result.stderr


def test_bode_as_json_is_the_library():
    found, own = told("bode --points 50"), CoupledDrives().transfer("x_k", "T1")
    assert found["omega"] == np.logspace(-1, 4, 50).tolist()
    seen = found["x_k/T1"]
    assert seen["degrees"] == np.degrees(own.phase(found["omega"])).tolist()
    assert seen["magnitude"] == own.magnitude(found["omega"]).tolist()
    assert seen["denominator"] == ["1", "500", "2000"]
    assert seen["poles"] == [[z.real, z.imag] for z in own.poles]
    assert (seen["zeros"], seen["relative_degree"], seen["dc_gain"]) == ([], 2, float(own.dc_gain))
    assert [mode["times"] for mode in seen["hidden"]] == [1, 3]
    assert told("bode --output phi1 --points 2")["phi1/T1"]["dc_gain"] is None


def test_runs_as_json_and_csv_are_the_library(folder):
    (folder / "torques.csv").write_text("t,T1,T2\n0,0.1,0\n0.5,0.1,0.3\n", encoding="utf-8")
    unequal = CoupledDrives(Spool(1e-3, 0.1, 0.1), Spool(2e-3, 0.1, 0.05))
    options = '--inertia "1e-3 kg m^2, 2e-3 kg m^2" --radius "10 cm, 5 cm" --t-end "1 s" --step "10 ms"'
    for hold in (False, True):
        command = f"step --table torques.csv {'--hold' * hold} {options} --csv run.csv --json"
        result = run(command)
        assert result.stderr == ""
        seen = json.loads(result.stdout)
        torques = (Torque.table([0.0, 0.5], values, held=hold) for values in ([0.1, 0.1], [0.0, 0.3]))
        own = drives.simulate(unequal, *torques, t_end=1.0, step=0.01)
        assert seen["outputs"] == {name: x.tolist() for name, x in own.outputs.items()}
        assert seen["energy"]["supplied"] == own.energy.supplied[-1]
        rows = list(csv.DictReader((folder / "run.csv").read_text(encoding="utf-8").splitlines()))
        assert [float(row["x_k"]) for row in rows] == own.outputs["x_k"].tolist()
        assert [float(row["t"]) for row in rows] == own.t.tolist()


def test_control_as_json_is_the_library():
    seen, own = told('control --speed-bandwidth "20 rad/s" --limit "2 N m"'), drives.design(CoupledDrives(), 20)
    design = seen["design"]["speed"]
    assert (design["gain"], design["integral_time"]) == (float(own.speed.gain), float(own.speed.integral_time))
    assert design["poles"] == [[z.real, z.imag] for z in own.poles["speed"]]
    assert max(seen["outputs"]["T2"]) == 2.0
    assert set(seen) == {"design", "t", "outputs", "energy", "notes", "verdicts"}


def test_parameters_from_a_file_and_options_over_it(folder):
    (folder / "d.toml").write_text('radius = ["10 cm", "5 cm"]\nangle = "30 deg"\n', encoding="utf-8")
    same = told('bode --radius "10 cm, 5 cm" --angle "30 deg" --points 2')
    assert told("bode --parameters d.toml --points 2") == same
    assert told('bode --parameters d.toml --radius "10 cm" --angle "45 deg"') == told("bode")


@pytest.mark.parametrize("command", ["bode --poles", "step --plot", "control --limit 2Nm --plot"])
def test_pictures_show_something(command, folder):
    assert run(f"{command} out.png").exit_code == 0
    assert imread(folder / "out.png")[..., :3].std() > 0.05


def test_help_is_quick():
    began = time.process_time()
    run("--help")
    assert time.process_time() - began < 0.5
