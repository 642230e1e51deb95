"""`tline design`: its texts, files and mistakes."""

import json
import shlex
from pathlib import Path

import command_line
import pytest
from click.testing import CliRunner

from tline.cli.main import main
from tline.scene.file import read_scene
from tline.solver.simulate import simulate

SCENES = Path(__file__).parents[2] / "scenes"
TOWN = f"{SCENES}/town.inp"
TRIP, CLOSURE = f"{SCENES}/pump_trip.toml", f"{SCENES}/valve_closure.toml"


pytestmark = pytest.mark.usefixtures("folder")


def run(line: str):
    return command_line.run(f"design {line}")


@pytest.mark.parametrize(
    ("line", "node", "limit"),
    [
        (f"vessel {TRIP} --at pump --lowest '2 bar' --kv 600", "pump", "lowest"),
        (f"relief {CLOSURE} --at valve --highest '10 bar'", "valve", "highest"),
        (f"relief {CLOSURE} --at valve --highest '10 bar' --kv 150", "valve", "highest"),
        (f"closure {CLOSURE} valve --highest '12 bar'", "valve", "highest"),
    ],
)
def test_the_scene_that_is_written_keeps_the_limit(line: str, node: str, limit: str, folder: Path) -> None:
    done = run(f"{line} -o scene.toml --plot curve.png --csv curve.csv --json")
    assert done.exit_code == 0, done.output
    assert {path.name for path in folder.iterdir()} == {"scene.toml", "curve.png", "curve.csv"}
    told = json.loads(done.stdout)
    again = simulate(read_scene("scene.toml"), tol=1e-5, envelope=True).envelope
    assert again is not None
    assert again.of(node)[limit] == pytest.approx(told["found"][limit], rel=1e-3)
    assert 0 <= told["found"]["margin"] < 0.01 * told["limits"][limit]
    rows = (folder / "curve.csv").read_text().splitlines()
    assert rows[0].split(",")[1:] == ["lowest", "highest", "margin", "error"]
    assert len(rows) == 1 + len(told["curve"])


def test_text_has_sizes_margin_and_curve_with_units() -> None:
    done = run(f"flywheel {TRIP} pump --path pump,tank --lowest '1 bar'")
    assert done.exit_code == 0
    for words in ("inertia   8.0", "kg m^2", "gauge pressure from pump to tank: 1", "bar, margin", "margin [bar]"):
        assert words in done.stdout


def test_an_epanet_file_operated_is_the_scene_that_surge_saves() -> None:
    trip, search = "--trip duty@0.2s --for 6s --tol 0.01", "duty --lowest '-0.1 bar' --tol 0.01 --json"
    save = f"surge {TOWN} {trip} --no-cavities --save town.toml"
    saved = CliRunner().invoke(main, shlex.split(save), catch_exceptions=False)
    assert saved.exit_code == 0, saved.output
    one, other = run(f"flywheel {TOWN} {trip} {search}"), run(f"flywheel town.toml {search}")
    assert json.loads(one.stdout)["found"] == json.loads(other.stdout)["found"]
    assert json.loads(one.stdout)["found"]["lowest"] == pytest.approx(-0.1e5, abs=0.01e5)
    assert "its rotor has 2.9 kg m^2 and 1450 rpm" in one.stderr


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (f"vessel {TRIP} --at pmp --lowest 1bar", "--at: no such node, expected 'pump', got 'pmp'"),
        (f"vessel {TRIP} --at pump", "--highest: no limit is given, expected a lowest pressure or head, a highest, or"),
        (f"vessel {TRIP} --at pump --lowest 3m", "--lowest: a head needs heights, expected a pressure, or elevations"),
        (f"vessel {TRIP} --at pump --lowest 3kg", "--lowest: this unit measures something else, expected a pressure"),
        (f"vessel {TRIP} --at pump --lowest 1bar --for 3m", "--for: "),
        (f"vessel {TRIP} --at pump --lowest 1bar --reserve 1", "--reserve: out of range, expected from 0 to 0.9"),
        (f"vessel {TRIP} --at pump --lowest 2bar --highest 1bar", "--lowest: not below the highest"),
        (f"vessel {TRIP} --at pump --lowest -30bar", "--lowest: is kept without a vessel, expected a stricter limit"),
        (f"vessel {TRIP} --at pump --lowest 4.5bar", "--lowest: 'pump' is beyond it before the surge, at 4 bar"),
        (f"closure {TRIP} v --highest 9bar", "valve: no such valve, expected a scene with a valve of kind 'orifice'"),
        (f"closure {CLOSURE} valv --highest 9bar", "valve: no such valve, expected 'valve', got 'valv'"),
        (f"closure {CLOSURE} valve --highest 9bar --begin 7s", "--begin: after the end of the run, expected before 6"),
        (f"flywheel {CLOSURE} p --lowest 1bar", "pump: no such pump, expected a scene with a pump, got 'p'"),
        (f"flywheel {TRIP} pump --lowest 1bar --path pump,tnk", "--path: no such node, expected 'tank', got 'tnk'"),
        (f"flywheel {TRIP} pump --lowest 1bar --path sump", "--path"),
        (f"relief {CLOSURE} --at valve --highest 8bar --set-pressure 9bar", "--set-pressure: out of range"),
        (f"relief {CLOSURE} --at valve --highest 8bar --set-pressure 7bar --kv 9", "nothing is left to search"),
        (f"relief {CLOSURE} --at valve --highest 40bar", "--highest: is kept without a relief valve"),
        (f"flywheel {TRIP} pump --lowest 3.9999bar --tol 0.01", "at most 3.999 bar at 'pump', the best of what was"),
        (f"vessel {TOWN} --at lift --lowest 1bar", "--lowest: 'suction' is beyond it before the surge, at 0.7106 bar"),
        (f"vessel {TOWN} --at lift --lowest 1bar --trip dut@1s", "--trip: not a pump, expected 'duty', got 'dut'"),
        (f"vessel {TRIP} --at pump --lowest 1bar --at-hour 3", "--at-hour: is for .inp files, expected none, got 3"),
        (f"vessel {SCENES}/cable_mismatch.toml --at a --lowest 1bar", "expected 'hydraulic', got 'electrical'"),
    ],
)
def test_mistakes_get_a_sentence(line: str, sentence: str) -> None:
    done = run(line)
    assert done.exit_code == 2
    assert sentence in done.stderr
    assert done.stderr.count("\n") == 1
