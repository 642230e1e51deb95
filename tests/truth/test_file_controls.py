"""Controls and rules of EPANET files act within a run, at instants found by hand."""

from math import pi
from pathlib import Path

import pytest
from click.testing import CliRunner

from tline.cli.main import main
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.surge.operation import plan, read_network

INFLOW, BORE, LEVEL, START = 0.02, 2.0, 4.0, 1.0  # m³/s, m, m, hours of the clock
NETWORK = f"""[JUNCTIONS]
 spring 20 {-1e3 * INFLOW}
 c 20 0
 d 20 10
[RESERVOIRS]
 lake 60
[TANKS]
 tower 40 {LEVEL} 0 8 {BORE} 0
 apart 40 {LEVEL} 0 8 {BORE} 0
[PIPES]
 up spring tower 300 250 120 0 Open
 main lake c 900 250 120 0 Open
 spare lake c 900 250 120 0 Closed
 cut c apart 900 250 120 0 Closed
 last c d 100 250 120 0 Open
[VALVES]
 ease c d 100 TCV 12 0
[OPTIONS]
 UNITS LPS
[TIMES]
 START CLOCKTIME {START:g} AM
[CONTROLS]
CONTROLS
[RULES]
RULES
[END]
"""
RISING = INFLOW / (pi / 4 * BORE**2)  # m/s; the water that the pipe stores is 5e-5 of the tank's


def file(folder: Path, controls: str = "", rules: str = "") -> Path:
    path = folder / "town.inp"
    path.write_text(
        NETWORK.replace("CONTROLS]\nCONTROLS", f"CONTROLS]\n{controls}").replace("\nRULES\n", f"\n{rules}\n")
    )
    return path


def planned(path: Path, hour: float = 0.0, **more: str) -> tuple[Scene, str]:
    scene, _, controls = read_network(path, hour=hour, moving_tanks=True)
    scene, notes = plan(scene, more, t_end="10 s", tol=1e-6, controls=controls)
    return scene, "\n".join(notes)


def shuts_at(scene: Scene, link: str = "ease") -> float:
    opening = scene.links[link].table()["opening"]
    assert (opening["shape"], opening["to"]) == ("step", 0.0)
    return float(opening["at"])


@pytest.mark.parametrize(
    ("controls", "rules"),
    [
        ("LINK ease CLOSED IF NODE tower ABOVE 4.05", ""),
        ("", "RULE full\nIF TANK tower LEVEL >= 4.05\nTHEN VALVE ease STATUS IS CLOSED"),
        ("", "RULE full\nIF NODE tower HEAD ABOVE 44.05\nTHEN VALVE ease STATUS IS CLOSED"),
        ("", "RULE full\nIF NODE tower PRESSURE > 4.05\nTHEN VALVE ease STATUS IS CLOSED"),
    ],
)
def test_a_level_is_reached_when_the_inflow_has_filled_the_tank_so_far(tmp_path, controls, rules):
    scene, notes = planned(file(tmp_path, controls, rules))
    assert shuts_at(scene) == pytest.approx(0.05 / RISING, rel=2e-4)
    assert f"after {shuts_at(scene):.6g} s" in notes


@pytest.mark.parametrize(
    ("controls", "rules"),
    [
        ("LINK ease CLOSED AT TIME 2:00", ""),
        ("LINK ease CLOSED AT CLOCKTIME 3 AM", ""),
        ("", "RULE two\nIF SYSTEM TIME >= 2\nTHEN VALVE ease STATUS IS CLOSED"),
        ("", "RULE two\nIF SYSTEM CLOCKTIME = 3 AM\nTHEN VALVE ease STATUS IS CLOSED"),
    ],
)
def test_an_instant_counts_from_the_hour_of_the_import(tmp_path, controls, rules):
    path = file(tmp_path, controls, rules)
    scene, _ = planned(path, hour=7195 / 3600)
    assert shuts_at(scene) == 5.0
    assert planned(path, hour=1.0)[1] == ""  # an hour too early for a run of 10 s


def test_what_is_closed_already_or_past_is_left_alone_and_a_pipe_gets_a_valve(tmp_path):
    controls = (
        "LINK spare CLOSED AT TIME 1:00:02\nLINK last OPEN AT TIME 1:00:02\n"
        "LINK ease CLOSED AT TIME 0:30\nLINK main CLOSED AT TIME 1:00:02"
    )
    scene, _ = planned(file(tmp_path, controls), hour=1.0)
    assert shuts_at(scene, "main:gate") == 2.0
    assert "last:gate" not in scene.links


def test_what_is_operated_by_hand_goes_before_the_file(tmp_path):
    scene, notes = planned(file(tmp_path, "LINK ease CLOSED AT TIME 0:00:05"), close="ease@2s")
    assert shuts_at(scene) == 2.0
    assert notes == "controls and rules that are left out, for their links are operated once: " + (
        "'LINK ease CLOSED AT TIME 0:00:05'"
    )


@pytest.mark.parametrize(
    ("controls", "rules", "said"),
    [
        ("LINK ease 1 IF NODE tower ABOVE 4.01", "", "more than open or shut"),
        ("LINK spare OPEN IF NODE tower ABOVE 4.01", "", "not in the scene: 'LINK spare"),
        ("LINK ease CLOSED IF NODE apart ABOVE 1", "", "wait at is not in the scene: 'LINK ease"),
        ("LINK ease CLOSED IF NODE lake ABOVE 1", "", "hold their level: 'LINK ease"),
        ("", "RULE a\nIF TANK tower LEVEL > 4\nAND SYSTEM TIME > 1\nTHEN LINK ease STATUS = CLOSED", "'rule a'"),
        ("", "RULE a\nIF LINK main FLOW > 4\nTHEN LINK ease STATUS = CLOSED", "'rule a'"),
        (
            "",
            "RULE a\nIF TANK tower LEVEL > 4.01\nTHEN LINK ease STATUS = CLOSED\nELSE LINK main STATUS = OPEN",
            "'rule a'",
        ),
    ],
)
def test_what_cannot_be_mapped_is_named(tmp_path, controls, rules, said):
    scene, notes = planned(file(tmp_path, controls, rules))
    assert said in notes
    assert "opening" not in scene.links["ease"].table() or isinstance(scene.links["ease"].table()["opening"], float)


def test_the_command_line_lets_them_act_and_saves_a_scene_of_them(tmp_path):
    path, saved = file(tmp_path, "LINK ease CLOSED IF NODE tower ABOVE 4.05"), tmp_path / "saved.toml"
    options = ["--moving-tanks", "--for", "10s", "--tol", "0.02", "--save", str(saved)]
    ran = CliRunner().invoke(main, ["surge", str(path), *options])
    assert ran.exit_code == 0, ran.output
    assert "'LINK ease CLOSED IF NODE tower ABOVE 4.05': after 7.85" in ran.output
    assert shuts_at(read_scene(saved)) == pytest.approx(0.05 / RISING, rel=2e-4)


def test_the_import_tells_of_them(tmp_path):
    ran = CliRunner().invoke(main, ["import", str(file(tmp_path, "LINK ease CLOSED AT TIME 5"))])
    assert "`tline surge` lets those of the .inp file act within a run" in ran.output
