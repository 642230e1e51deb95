"""Scenes of EPANET networks start at EPANET's operating point, and stay there while nothing is operated."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from networks import ring
from random_inp import random_inp

from tline import InputError, Scene, simulate
from tline.interchange.epanet import read_epanet
from tline.interchange.pipe_walls import wave_speeds
from tline.interchange.water_network import Valve
from tline.interchange.water_scene import differences, read_inp, water_scene
from tline.interchange.water_valves import valve_link
from tline.scene.heights import GRAVITY
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state

wntr = pytest.importorskip("wntr")
ODD = ("differs from", "no steady state of its own")  # notes that say that a scene is not at EPANET's operating point
EXCUSED = ("takes it out of the network", "do not balance", "cannot deliver")  # that EPANET's own state is none
SHIPPED = Path(wntr.__file__).parent / "library" / "networks"
SPEED = "1000 m/s"
CURVES = {
    "one point": "lifting 90 75",
    "power law": "lifting 0 100\n lifting 90 75\n lifting 150 20",
    "lines": "lifting 0 90\n lifting 50 88\n lifting 90 70\n lifting 150 10",
}


def heads_agree(path: Path, hour: float = 0.0) -> None:
    """EPANET's heads are floats of 32 bits, and its flows are found to 1e-5: 1 mm in all."""
    network = read_epanet(path, hour)
    scene, _ = water_scene(network, wave_speeds(SPEED, None))
    effort, _ = steady_state(describe(scene))
    for name, node in network.nodes.items():
        assert effort[name] / (network.density * GRAVITY) == pytest.approx(node.head, abs=1e-3), name


@pytest.mark.parametrize("name", ["Net1", "Net2", "Net3", "ky4", "ky10"])
def test_shipped_networks(name):
    heads_agree(SHIPPED / f"{name}.inp")


@pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
@pytest.mark.parametrize("speed", [1.0, 0.9])
def test_pumps(tmp_path, curve, speed):
    heads_agree(ring(tmp_path, changes={"lifting 90 75": curve, "HEAD lifting": f"HEAD lifting SPEED {speed}"}))


@pytest.mark.parametrize("valve", ["TCV 12", "PRV 20", "PSV 50", "PBV 4", "FCV 20"])
def test_valves(tmp_path, valve):
    heads_agree(ring(tmp_path, changes={"TCV 12": valve}))


def test_a_valve_that_regulates_stands_still_while_nothing_is_operated(tmp_path):
    scene, notes = read_inp(str(ring(tmp_path, changes={"TCV 12": "PRV 20"})))
    (regulator,) = (link for link in scene.links.values() if link.kind == "regulating valve")
    assert regulator.keeps == "downstream"
    assert any("keep what they keep at the operating point" in note for note in notes)
    still = scene.with_changes(t_end=60, solver={"order": 2})
    seen = simulate(still, envelope=True).envelope
    assert (seen.highest - seen.lowest).max() <= 1e-9 * np.abs(seen.start).max()


@pytest.mark.parametrize(("kind", "keeps"), [("PRV", "downstream"), ("PSV", "upstream"), ("FCV", "flow")])
def test_what_a_valve_keeps(kind, keeps):
    valve = Valve(("a", "b"), kind, 0.1, 0.01, 13.0, active=True)
    link = valve_link("v", valve, 1000.0, [])
    assert (link["kind"], link["keeps"]) == ("regulating valve", keeps)
    assert 0 < link["opening"] < 1
    assert valve_link("v", replace(valve, active=False), 1000.0, [])["kind"] == "orifice"


@pytest.mark.parametrize("exponent", [0.5, 0.8, 1.5])
def test_emitters(tmp_path, exponent):
    heads_agree(ring(tmp_path, changes={"EXPONENT 0.5": f"EXPONENT {exponent}"}))


def test_an_hour_later_levels_patterns_controls_and_rules_count(tmp_path):
    """The tower fills through the ring; the demand at b doubles at 2 h, a control opens and a rule shuts a pipe."""
    changes = {
        " b 25 40": " b 25 40 day",
        "[COORDINATES]": "[PATTERNS]\n day 0.5 0.5 1\n[CONTROLS]\n LINK spare OPEN AT TIME 1\n"
        "[RULES]\nRULE 1\nIF SYSTEM TIME >= 2\nTHEN LINK ca STATUS IS CLOSED\n[COORDINATES]",
    }
    path = ring(tmp_path, changes=changes)
    begun, later = read_epanet(path), read_epanet(path, 2.5)
    assert later.basins["tower"].head > begun.basins["tower"].head + 0.1
    assert later.junctions["b"].demand == pytest.approx(2 * begun.junctions["b"].demand, rel=1e-5)
    assert ("spare" in later.pipes, "ca" in later.pipes) == (True, False)
    assert "patterns, controls and rules: as they stand after 2.5 h" in later.notes
    heads_agree(path, 2.5)


def test_walls_set_the_wave_speed(tmp_path):
    """Korteweg's formula for a thin elastic wall, of water with 2.19 GPa."""
    table = tmp_path / "walls.csv"
    table.write_text("pipe, wall, thickness\nmain, steel, 6 mm\nab, 1234 m/s\n*, 2.76 GPa, 10 mm\nold, pvc, 1 cm\n")
    scene, notes = read_inp(str(ring(tmp_path)), material=str(table))
    assert "material: no pipe in use has these names: 'old'" in notes
    rho, d = scene.lines["main"].parameters.density, scene.lines["main"].parameters.diameter
    speed = (2.19e9 / rho / (1 + 2.19e9 / 206e9 * d / 6e-3)) ** 0.5
    assert scene.lines["main"].parameters.wave_speed == pytest.approx(speed)
    assert scene.lines["ab"].parameters.wave_speed == 1234
    d = scene.lines["bc"].parameters.diameter
    speed = (2.19e9 / rho / (1 + 2.19e9 / 2.76e9 * d / 1e-2)) ** 0.5
    assert scene.lines["bc"].parameters.wave_speed == pytest.approx(speed)
    _, notes = read_inp(str(ring(tmp_path)))
    assert "wave speed: 1000 m/s in all pipes, for nothing says what they are made of" in notes


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("main, wood, 6 mm", "line 1: .*'wood'"),
        ("main, steel, -6 mm", "line 1: out of range, expected above zero, got -6 mm"),
        ("main, steel, 6 mm, 3", "line 1: not a row, expected pipe, wall, thickness; or pipe, wave speed"),
        ("main, 900 m/s\nmain, 900 m/s", "line 2: pipe 'main' has a row already"),
    ],
)
def test_mistakes_in_a_table_of_walls(tmp_path, row, said):
    table = tmp_path / "walls.csv"
    table.write_text(row)
    with pytest.raises(InputError, match=said):
        read_inp(str(ring(tmp_path)), material=str(table))


def test_power_pump_and_inflow(tmp_path):
    heads_agree(ring(tmp_path, changes={"HEAD lifting": "POWER 30", " d 20 10": " d 20 -10"}))


def test_nothing_is_operated_and_nothing_moves(tmp_path):
    scene, _ = read_inp(str(ring(tmp_path)), SPEED)
    assert moved(scene) < 1e-9


LINE = """
[JUNCTIONS]
 a 10 5
 b 10 {drawn}
 c 12 0
[RESERVOIRS]
 lake 150
{more}
[PIPES]
 p1 lake a 500 200 120 0 Open
 p2 b c 300 100 120 0 Open
 {pipe}
[VALVES]
 v {ends} 100 {valve} 0
[OPTIONS]
 UNITS LPS
[END]
"""


def line(folder: Path, valve: str, ends: str = "a b", drawn: float = 0.0, more: str = "", pipe: str = "") -> Path:
    """A reservoir, a pipe, a valve, and a pipe that ends."""
    path = folder / "line.inp"
    path.write_text(LINE.format(valve=valve, ends=ends, drawn=drawn, more=more, pipe=pipe))
    return path


def test_a_zone_behind_a_valve_that_holds_has_the_head_that_it_holds(tmp_path):
    """72 m above 10 m, though nothing is drawn there."""
    path = line(tmp_path, "PRV 72")
    heads_agree(path)
    scene, notes = read_inp(str(path), SPEED)
    assert read_epanet(path).junctions["b"].head == pytest.approx(82.0, abs=1e-9)
    assert scene.nodes["b"].start == pytest.approx(82.0 * 1000 * GRAVITY)
    assert not any(odd in note for odd in ODD for note in notes)
    assert moved(scene) < 1e-9


def test_a_pressure_breaker_through_which_water_flows_backward_is_named(tmp_path):
    """EPANET lets it add its setting to the head."""
    path = line(tmp_path, "PBV 13.6", "b a", drawn=6)
    network = read_epanet(path)
    assert network.valves["v"].flow == pytest.approx(-0.006, rel=1e-4)
    assert network.nodes["b"].head - network.nodes["a"].head == pytest.approx(13.6)
    heads_agree(path)
    scene, notes = read_inp(str(path), SPEED)
    assert any("valve 'v': water flows through it backward" in note and "13.6 m" in note for note in notes)
    assert moved(scene) < 1e-9


BETWEEN = """
[JUNCTIONS]
 a 0 {first}
 b 0 {second}
[RESERVOIRS]
 high 50
 low 25
[PIPES]
 p1 high a 500 500 100 0 Open
 p2 b low 500 500 100 0 Open
[VALVES]
 v a b 500 {valve} 0
[OPTIONS]
 UNITS LPS
[END]
"""


@pytest.mark.parametrize("valve", ["FCV 100", "PSV 49", "PRV 25.5", "PBV 23"])
@pytest.mark.parametrize("drawn", [(50, 50), (0, 50), (20, 5)])
def test_a_valve_with_demands_at_both_ends(tmp_path, valve, drawn):
    path = tmp_path / "between.inp"
    path.write_text(BETWEEN.format(valve=valve, first=drawn[0], second=drawn[1]))
    heads_agree(path)


STANDBY = """
[JUNCTIONS]
 a 10 20
 b 12 0
[RESERVOIRS]
 lake 60
 spare {head}
[PIPES]
 p1 lake a 500 300 100 0 Open
 p2 {link} 500 300 100 0 CV
 {more}
[OPTIONS]
 UNITS LPS
[END]
"""


@pytest.mark.parametrize("head", [40, 55])
@pytest.mark.parametrize(("link", "more"), [("spare a", ""), ("b a", "p3 spare b 100 300 100 0 CV")])
def test_a_reservoir_behind_a_check_valve_stands_by(tmp_path, head, link, more):
    """It gives nothing until the head falls below its own, and does so then."""
    path = tmp_path / "standby.inp"
    junction = "b" if more else None
    text = STANDBY.format(head=head, link=link, more=more)
    path.write_text(text if junction else text.replace(" b 12 0\n", ""))
    scene, notes = read_inp(str(path), SPEED)
    assert not any("spare" in note for note in notes)
    assert not any(odd in note for odd in ODD for note in notes)
    heads_agree(path)
    assert moved(scene) < 1e-9
    falls = {"shape": "ramp", "from": 60 * 1000 * GRAVITY, "to": 20 * 1000 * GRAVITY, "at": 0.1, "duration": 0.5}
    table = scene.table() | {"t_end": 8.0, "solver": {"order": 1}, "probes": {"p": {"at": "p2:valve", "line": "p2"}}}
    del table["loads"]["lake"]
    table["sources"] = {"lake": {"at": "lake", "kind": "pressure", "value": falls}}
    assert simulate(Scene(**table)).probes["p"].y.max() > 1e-3


def test_what_no_pipe_leads_to_is_left_out_and_named(tmp_path):
    """A pump between a reservoir and a demand, beside a network."""
    path = line(tmp_path, "TCV 3", more=" well 5\n[PUMPS]\n lift well c POWER 1", pipe=" p3 b a 300 100 120 0 Open")
    path.write_text(path.read_text().replace(" p2 b c 300 100 120 0 Open\n", "").replace(" c 12 0", " c 12 3"))
    scene, notes = read_inp(str(path), SPEED)
    assert "left out, no pipe in use leads there: 'c', 'well'" in notes
    assert not scene.nodes.keys() & {"c", "well"}
    assert not any(odd in note for odd in ODD for note in notes)


def test_differences_are_named(tmp_path):
    """A pocket whose demand EPANET takes through a closed valve all the same."""
    changes = {" ease a d 100 TCV 12 0": " ease a d 100 TCV 12 0\n[STATUS]\n ease Closed"}
    _, notes = read_inp(str(ring(tmp_path, changes=changes)), SPEED)
    assert any("a demand of 0.01 m³/s there" in note for note in notes)
    (note,) = [note for note in notes if "differs from EPANET's heads: " in note]
    assert note.count(" m") >= 3


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # of what moves within rounding
@pytest.mark.parametrize("block", range(2))
def test_random_networks_start_where_epanet_does_and_stay_there(tmp_path, block):
    """Or they say where they do not; each link of EPANET's in both directions, loops, and parts without demand."""
    used, refused = 0, []
    for seed in range(10 * block, 10 * block + 10):
        path = tmp_path / f"{seed}.inp"
        path.write_text(random_inp(seed))
        try:
            scene, notes = read_inp(str(path), SPEED)
        except InputError as error:
            refused.append(str(error))
            continue
        if any(excuse in note for excuse in EXCUSED for note in notes):
            continue
        assert not any(odd in note for odd in ODD for note in notes), seed
        used += 1
        assert moved(scene) < 1e-9, seed
    assert used >= 4
    assert all("EPANET" in said for said in refused), refused


def test_how_long_a_valve_takes_to_shut_matters(tmp_path):
    """Linear closures over 1 s and 10 s of a valve without loss, beside a wave that returns after 1 s."""
    path = line(tmp_path, "TCV 0", drawn=8)
    scene, notes = read_inp(str(path), SPEED)
    assert any("that of a butterfly valve is a guess" in note and "'v'" in note for note in notes)
    peaks = []
    for duration in (1.0, 10.0):
        table = scene.table()
        shut = {"shape": "ramp", "from": 1, "to": 0, "at": 0.5, "duration": duration}
        table["links"]["v"]["opening"] = shut
        table["probes"] = {"p": {"at": "a"}}
        result = simulate(Scene(**{**table, "t_end": 15.0, "solver": {"order": 1}}))
        u = result.probes["p"].u
        peaks.append(float(u.max() - u[0]))
    assert peaks[0] > 1.5 * peaks[1]


def moved(scene: Scene) -> float:
    """How far any pressure leaves the steady one, over the largest."""
    envelope = simulate(Scene(**scene.table() | {"t_end": 5.0, "solver": {"order": 1}}), envelope=True).envelope
    assert envelope is not None
    largest = np.abs(envelope.start).max()
    return np.maximum(envelope.highest - envelope.start, envelope.start - envelope.lowest).max() / largest


def test_check_valves_let_nothing_back(tmp_path):
    """The pump stops at once, and the tower would feed the ring."""
    scene, _ = read_inp(str(ring(tmp_path)), SPEED)
    table = scene.table()
    table["links"]["duty"]["speed"] = {"shape": "step", "from": 1, "to": 0, "at": 0.5}
    table["probes"] = {"tower": {"at": "up:valve"}, "pump": {"at": "lift"}}
    result = simulate(Scene(**{**table, "t_end": 5.0}))
    for probe in result.probes.values():
        assert probe.y[0] > 1e-3
        assert probe.y.min() > -1e-9
    assert result.probes["tower"].y.min() < 1e-9


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"\n a 20 30": "\n up:valve 5 0\n a 20 30", "spare a b": "spare a up:valve", "0 Closed": "0 Open"},
            "pipe 'up': its check valve",
        )
    ],
)
def test_what_no_scene_has(tmp_path, changes, said):
    with pytest.raises(InputError, match=said):
        read_inp(str(ring(tmp_path, changes=changes)), SPEED)


FULL = """
[JUNCTIONS]
a 0 2
b 0 0
c 0 0
[RESERVOIRS]
lake 50
[TANKS]
tower 20 9.9 0 10 2 0
[PIPES]
in lake a 300 200 120 0 Open
up a tower 300 200 120 0 CV
on a b 200 150 120 0 Open
off c a 200 150 120 0 CV
[PUMPS]
stands b c HEAD curve
[STATUS]
stands Closed
[CURVES]
curve 5 30
[OPTIONS]
Units LPS
"""


def test_a_full_tank_takes_no_more_and_a_pump_stands(tmp_path):
    """EPANET shuts what fills a full tank, a check valve too; what a standing pump keeps apart has its own head."""
    path = tmp_path / "full.inp"
    path.write_text(FULL)
    network = read_epanet(path, 2.0)
    assert set(network.pipes) == {"in", "on", "off"}
    assert network.pumps["stands"].speed == 0.0
    scene, notes = water_scene(network, wave_speeds("1000 m/s", None))
    assert not list(differences(network, scene))
    assert "pumps: they stand, behind check valves: 'stands'" in notes
    held = simulate(Scene(**scene.table() | {"t_end": 1, "solver": {"order": 1}}), envelope=True).envelope
    assert held is not None
    assert np.abs(held.highest - held.lowest).max() <= 1e-12 * held.highest.max()
