"""Newton's steps of the steady state, by elimination and at once."""

from math import pi
from pathlib import Path

import pytest

from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady import balance
from tline.solver.steady.steady_state import steady_state

NONE = 1e-12  # Pa, m³/s: where nothing drives
SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ["town", "pump_trip", "valve_closure", "pipe_friction"])
@pytest.mark.parametrize("exact", [balance.EXACT, 0.0], ids=["by elimination", "at once"])
def test_large_networks_are_solved_like_small_ones(monkeypatch, name, exact):
    scene = read_scene(SCENES / f"{name}.toml")
    small, flows = steady_state(describe(scene))
    monkeypatch.setattr(balance, "SMALL", 0)
    monkeypatch.setattr(balance, "EXACT", exact)
    large, same = steady_state(describe(scene))
    assert large == pytest.approx(small, rel=1e-9, abs=1e-9 * max(small.values()) + NONE)
    assert same == pytest.approx(flows, abs=1e-9 * abs(flows).max() + NONE)


def test_a_pipe_between_reservoirs_follows_darcy(monkeypatch):
    """Δp = ρ f l/(2 d A²) Q², also where no effort is left to be found."""
    monkeypatch.setattr(balance, "SMALL", 0)
    pipe = {"nodes": ["high", "low"], "length": 100, "diameter": 0.2, "wave_speed": 1000, "density": 1000}
    scene = Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={"pipe": pipe | {"friction": {"kind": "darcy", "factor": 0.02}}},
        loads={
            "upper": {"at": "high", "kind": "reservoir", "pressure": 2e5},
            "lower": {"at": "low", "kind": "reservoir", "pressure": 1e5},
        },
        probes={"p": {"at": "low"}},
    )
    _, flows = steady_state(describe(scene))
    area = pi * 0.2**2 / 4
    assert flows[0] == pytest.approx(area * (1e5 * 2 * 0.2 / (1000 * 0.02 * 100)) ** 0.5)
