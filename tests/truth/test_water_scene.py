"""Scenes of EPANET networks start at EPANET's operating point, and stay there while nothing is operated."""

from pathlib import Path

import numpy as np
import pytest
from networks import ring

from tline.errors import InputError
from tline.interchange.epanet import read_epanet
from tline.interchange.water_scene import read_inp, water_scene
from tline.scene.scene import Scene
from tline.scene.site import GRAVITY
from tline.solver.nodes import nodes_of
from tline.solver.simulate import simulate
from tline.solver.steady import steady_state

wntr = pytest.importorskip("wntr")
SHIPPED = Path(wntr.__file__).parent / "library" / "networks"
SPEED = "1000 m/s"
CURVES = {
    "one point": "lifting 90 75",
    "power law": "lifting 0 100\n lifting 90 75\n lifting 150 20",
    "lines": "lifting 0 90\n lifting 50 88\n lifting 90 70\n lifting 150 10",
}


def heads_agree(path: Path) -> None:
    """EPANET's heads are floats of 32 bits, and its flows are found to 1e-5: 1 mm in all."""
    network = read_epanet(path)
    scene, _ = water_scene(network, SPEED)
    effort, _ = steady_state(scene, nodes_of(scene))
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


def test_power_pump_and_inflow(tmp_path):
    heads_agree(ring(tmp_path, changes={"HEAD lifting": "POWER 30", " d 20 10": " d 20 -10"}))


def test_nothing_is_operated_and_nothing_moves(tmp_path):
    scene, _ = read_inp(str(ring(tmp_path)), SPEED)
    envelope = simulate(scene, envelope=True).envelope
    assert envelope is not None
    largest = np.abs(envelope.start).max()
    assert np.maximum(envelope.highest - envelope.start, envelope.start - envelope.lowest).max() < 1e-9 * largest


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
        ({"EXPONENT 0.5": "EXPONENT 0.8"}, "junction 'c': the exponent of emitters is 0.8"),
        (
            {"\n a 20 30": "\n up:valve 5 0\n a 20 30", "spare a b": "spare a up:valve", "0 Closed": "0 Open"},
            "pipe 'up': its check valve",
        ),
    ],
)
def test_what_no_scene_has(tmp_path, changes, said):
    with pytest.raises(InputError, match=said):
        read_inp(str(ring(tmp_path, changes=changes)), SPEED)
