"""Imported networks settle at EPANET's own new steady state after a start-up, a burst and a closing."""

from pathlib import Path

import pytest
from random_waterworks import waterworks
from settling import ACCURATE, WALLS, good, measured

from tline import Scene, operate, simulate
from tline.interchange.epanet import read_epanet
from tline.interchange.water_scene import water_scene
from tline.scene.heights import GRAVITY
from tline.surge.event import Event
from tline.surge.operate import operated

pytest.importorskip("wntr")
pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # of corners of ramps
MAIN = """
[JUNCTIONS]
 suction 0 0
 lift 0 0
 far 0 0
[RESERVOIRS]
 low 10
 high 40
[PIPES]
 in low suction 50 300 {rough} 0 Open
 main lift far 5000 250 {rough} {minor} Open
 out far high 50 300 {rough} 0 Open
[PUMPS]
 pump suction lift HEAD lifting
[STATUS]
 pump {status}
[CURVES]
 lifting 50 40
[OPTIONS]
 UNITS LPS
 HEADLOSS {formula}
[END]
"""
DEAD = """
[JUNCTIONS]
 a 0 {drawn}
 end 5 0
[RESERVOIRS]
 lake 60
[PIPES]
 first lake a 500 300 130 0 Open
 dead a end 2000 150 130 0 Open
[EMITTERS]
 end {hole}
[OPTIONS]
 UNITS LPS
[END]
"""


@pytest.mark.parametrize("minor", [0, 20])
@pytest.mark.parametrize(("formula", "rough"), [("H-W", 130), ("D-W", 0.1), ("C-M", 0.011)])
def test_a_pump_that_stands_is_started(tmp_path: Path, formula: str, rough: float, minor: float) -> None:
    files = [tmp_path / f"{status}.inp" for status in ("Closed", "Open")]
    for file in files:
        text = MAIN.format(status=file.stem, formula=formula, rough=rough, minor=minor)
        file.write_text(text)
    stands, runs = map(read_epanet, files)
    changed, _ = operated(water_scene(stands, WALLS)[0], [Event("start", "pump", 1.0, 5.0)])
    seen = simulate(changed.with_changes(t_end=200, solver={"order": 1}, probes={"p": {"at": "lift", "line": "main"}}))
    probe = seen.probes["p"]
    flow = runs.pipes["main"].flow
    assert abs(stands.pipes["main"].flow) < 1e-6
    assert probe.u[-1] / (1000 * GRAVITY) == pytest.approx(runs.nodes["lift"].head, abs=ACCURATE)
    assert probe.y[-1] == pytest.approx(flow, rel=1e-4)


def test_a_pipe_that_the_file_closes_is_opened(tmp_path: Path) -> None:
    files = [tmp_path / f"{status}.inp" for status in ("Closed", "Open")]
    for file in files:
        text = DEAD.format(drawn=20, hole=0).replace("[EMITTERS]", f" by lake a 400 200 130 0 {file.stem}\n[EMITTERS]")
        file.write_text(text)
    runs = read_epanet(files[1])
    surge = operate(str(files[0]), open="by@1s+5s", t_end="300 s", order=1, at=["a", "by:gate"])
    heads = [surge.result.probes[node].head[[0, -1]] for node in ("by:gate", "a")]
    assert heads[0][0] == pytest.approx(60, abs=1e-9)  # the valve stands at its second end
    assert heads[1][0] == pytest.approx(read_epanet(files[0]).nodes["a"].head, abs=ACCURATE)
    assert heads[1][1] == pytest.approx(runs.nodes["a"].head, abs=2e-2)  # the gate valve loses a little
    assert any("the file closes them" in note for note in surge.notes)


def test_a_burst_at_a_dead_end(tmp_path: Path) -> None:
    """10 L/s at the 55 m that stand there before."""
    drawn, burst = (tmp_path / f"{name}.inp" for name in ("drawn", "burst"))
    drawn.write_text(DEAD.format(drawn=0, hole=0))
    burst.write_text(DEAD.format(drawn=0, hole=10 / 55**0.5))
    before, after = read_epanet(drawn), read_epanet(burst)
    changed, _ = operated(water_scene(before, WALLS)[0], [Event("burst", "end", 1.0, 2.0, 0.01)])
    seen = simulate(changed.with_changes(t_end=100, solver={"order": 1}, probes={"p": {"at": "end"}}))
    assert seen.probes["p"].u[-1] / (1000 * GRAVITY) == pytest.approx(after.nodes["end"].head, abs=ACCURATE)
    assert after.nodes["end"].head < before.nodes["end"].head - 4


@pytest.mark.parametrize("seed", range(2))
def test_random_waterworks(tmp_path: Path, seed: int) -> None:
    """By Hazen and Williams, Darcy and Weisbach, Chezy and Manning."""
    path = tmp_path / "works.inp"
    path.write_text(waterworks(seed))
    found = list(measured(path))
    assert {one["kind"] for one in found} >= {"start", "burst"}
    assert all(good(one) for one in found), found
    assert all(one["still"] >= 4 for one in found)


def test_a_run_from_the_new_steady_state_stays_there(tmp_path: Path) -> None:
    """Lines and the start have the same law of friction."""
    path = tmp_path / "works.inp"
    for seed in range(3):
        path.write_text(waterworks(seed))
        scene, _ = water_scene(read_epanet(path), WALLS)
        seen = simulate(Scene(**scene.table() | {"t_end": 5.0, "solver": {"order": 2}}), envelope=True).envelope
        assert seen is not None
        assert (seen.highest - seen.lowest).max() <= 1e-9 * seen.highest.max()
