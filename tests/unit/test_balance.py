"""Newton's steps of the steady state, by elimination and at once."""

from pathlib import Path

import pytest

from tline.scene.file import read_scene
from tline.solver import balance
from tline.solver.nodes import nodes_of
from tline.solver.steady import steady_state

NONE = 1e-12  # Pa, m³/s: where nothing drives
SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ["town", "pump_trip", "valve_closure", "pipe_friction"])
@pytest.mark.parametrize("exact", [balance.EXACT, 0.0], ids=["by elimination", "at once"])
def test_large_networks_are_solved_like_small_ones(monkeypatch, name, exact):
    scene = read_scene(SCENES / f"{name}.toml")
    small, flows = steady_state(scene, nodes_of(scene))
    monkeypatch.setattr(balance, "SMALL", 0)
    monkeypatch.setattr(balance, "EXACT", exact)
    large, same = steady_state(scene, nodes_of(scene))
    assert large == pytest.approx(small, rel=1e-9, abs=1e-9 * max(small.values()) + NONE)
    assert same == pytest.approx(flows, abs=1e-9 * abs(flows).max() + NONE)
