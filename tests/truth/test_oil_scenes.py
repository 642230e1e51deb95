"""The scenes of oil, brake fluid and diesel against closed forms."""

from math import pi, sqrt
from pathlib import Path

import pytest
from scipy.integrate import solve_ivp

from tline.scene.file import read_scene
from tline.solver.simulate import simulate

SCENES = Path(__file__).parents[2] / "scenes"


def extremes(name: str, node: str) -> tuple[float, float]:
    seen = simulate(read_scene(SCENES / f"{name}.toml"), envelope=True).envelope
    assert seen is not None
    found = seen.of(node)
    return found["lowest"], found["highest"]


def poiseuille(viscosity: float, length: float, diameter: float) -> float:
    return 128 * viscosity * length / (pi * diameter**4)


def test_a_hose_adds_joukowskys_rise_and_at_most_the_drop_of_its_friction():
    """Closed within 2·L/c; the drop along the hose, which the stopped oil packs, is laminar."""
    flow, area = 40e-3 / 60, pi / 4 * 12.7e-3**2
    drop = poiseuille(0.04, 6, 12.7e-3) * flow
    rise = sqrt(870 * 7e8) / area * flow
    _, highest = extremes("hydraulic_hose", "valve")
    error = 0.01 * 200e5  # the scene's tolerance
    assert 160e5 - drop + rise - error < highest < 160e5 + rise + error


def test_a_brake_line_swings_as_its_mass_on_the_calipers_spring():
    """One mass with Poiseuille's resistance: it neglects waves, and how friction grows with frequency."""
    mass = 1050 * 3.2 / (pi / 4 * 3.2e-3**2)
    loss, stiff = poiseuille(0.01, 3.2, 3.2e-3), 1 / 1e-13

    def rates(t, y):
        pressure, flow = y
        return flow * stiff, (min(t / 0.02, 1) * 80e5 - pressure - loss * flow) / mass

    swing = solve_ivp(rates, (0, 0.08), (0, 0), rtol=1e-8, atol=1e-9, max_step=1e-4).y[0].max()
    _, highest = extremes("brake_line", "caliper")
    assert highest == pytest.approx(swing, rel=0.05)


def test_a_needle_that_opens_before_the_echo_takes_joukowskys_pressure():
    lowest, _ = extremes("injection_pipe", "injector")
    assert lowest == pytest.approx(1000e5 - 850 * 1450 / (pi / 4 * 3e-3**2) * 62.5e-6, rel=1e-3)
