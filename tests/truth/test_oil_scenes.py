"""Scenes of oil, tanks whose level moves, and the swing of a vessel, against closed forms."""

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tline import Scene, SceneError
from tline.interchange.water_scene import read_inp
from tline.scene.file import read_scene
from tline.scene.heights import GRAVITY
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


PIPE = {"length": 200, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
AREA, LEVEL, DRAWN = 2.0, 5.0, 0.02


def scene(**more) -> Scene:
    """A tank 30 m high that a pipe empties at a constant flow."""
    tank = {"at": "t", "kind": "surge tank", "tank_area": AREA, "level": LEVEL, "gravity": GRAVITY}
    return Scene(
        medium="hydraulic",
        t_end=40,
        start="steady",
        lines={"pipe": {"nodes": ["t", "end"], **PIPE}},
        loads={"tank": tank | more},
        sources={"tap": {"at": "end", "kind": "flow", "value": -DRAWN}},
        nodes={"t": {"elevation": 30}, "end": {"elevation": 0}},
        probes={"t": {"at": "t"}},
    )


def test_a_tank_that_is_drawn_from_falls_by_its_volume_over_its_area():
    """But for the start of its fall, which waves in the pipe spread."""
    probe = simulate(scene(), tol=1e-8).probes["t"]
    level = probe.gauge_pressure / (1000 * GRAVITY)
    assert level[0] == pytest.approx(LEVEL, rel=1e-12)
    drawn = np.concatenate([[0.0], np.cumsum((probe.y[1:] + probe.y[:-1]) / 2 * np.diff(probe.t))])
    assert np.abs(level - (LEVEL - drawn / AREA)).max() < 1e-5
    assert level[-1] == pytest.approx(LEVEL - DRAWN * 40 / AREA, abs=1e-3)


def test_where_it_runs_empty_and_where_it_overflows():
    result = simulate(scene(lowest_level=4.8), tol=1e-3)
    (note,) = (note for note in result.notes if "loads.tank" in note)
    assert note == "loads.tank: it runs empty: its level comes to 4.6 m, below its 4.8 m"
    filled = scene(highest_level=5.1).with_changes(sources={"tap": {"at": "end", "kind": "flow", "value": DRAWN}})
    (note,) = (note for note in simulate(filled, tol=1e-3).notes if "loads.tank" in note)
    assert note == "loads.tank: it overflows: its level comes to 5.4 m, above its 5.1 m"


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"highest_level": 4}, "loads.tank.level: out of range, expected from lowest_level to highest_level, got 5 m"),
        ({"lowest_level": 7, "highest_level": 6}, "highest_level: too low, expected more than the lowest, 7 m"),
        ({"kv": 100}, "loads.tank.level: cannot be held behind a loss"),
    ],
)
def test_levels_that_are_none(more, said):
    with pytest.raises(SceneError, match=said):
        scene(**more)
    with pytest.raises(SceneError, match=r"loads.tank.level: is that of a steady start"):
        scene().with_changes(start="rest")


def test_tanks_of_a_file_move_when_asked(tmp_path):
    """The tower of the ring, of which EPANET knows the diameter."""
    pytest.importorskip("wntr")
    from networks import ring

    path = str(ring(tmp_path))
    held, notes = read_inp(path)
    assert "tanks: held at their level: 'tower'" in notes
    moving, notes = read_inp(path, moving_tanks=True)
    assert not any("held at their level" in note for note in notes)
    tower = moving.loads["tower"]
    assert (tower.kind, tower.level, tower.lowest_level, tower.highest_level) == ("surge tank", 4, 0, 8)
    assert tower.tank_diameter == pytest.approx(12, rel=1e-9)
    runs = [
        simulate(each.with_changes(t_end=20, probes={"tower": {"at": "tower"}}, solver={"order": 2}))
        for each in (held, moving)
    ]
    still, moved = (run.probes["tower"] for run in runs)
    assert moved.u[0] == pytest.approx(still.u[0], rel=1e-9)
    flow = moved.y[0]
    rise = flow * 20 / (np.pi / 4 * 12**2)
    assert (moved.u[-1] - moved.u[0]) / (1000 * GRAVITY) == pytest.approx(rise, rel=0.05)


AIR, P0, P1, V0 = 101_325.0, 3e5, 5e5, 0.5
INERTIA = 1000 * 400 / 0.05  # density·length/area of the column, kg/m⁴


@pytest.mark.parametrize("n", [1.0, 1.2, 1.4])
def test_a_polytropic_swing_has_the_extreme_and_the_period_of_its_energy(n):
    """I·q²/2 is what the pressure behind the column has done beyond the gas's; q vanishes at both ends of the swing."""
    scene = Scene(
        medium="hydraulic",
        t_end=16,
        start="steady",
        lines={"aside": {"nodes": ["lake", "dead"], "z0": 1e9, "delay": 0.05}},
        links={"column": {"nodes": ["lake", "vessel"], "kind": "inductor", "inductance": INERTIA}},
        sources={"lake": {"at": "lake", "kind": "pressure", "value": {"shape": "step", "from": P0, "to": P1}}},
        loads={"vessel": {"at": "vessel", "kind": "air vessel", "gas_volume": V0, "gas_pressure": P0, "exponent": n}},
        probes={"vessel": {"at": "vessel"}},
    )

    def gas(v: float) -> float:
        return (P0 + AIR) * (V0 / v) ** n - AIR

    def work(v: float) -> float:
        squeezed = V0 * np.log(V0 / v) if n == 1 else V0**n * (V0 ** (1 - n) - v ** (1 - n)) / (1 - n)
        return (P1 + AIR) * (V0 - v) - (P0 + AIR) * squeezed

    least = brentq(work, 0.2 * V0, 0.9 * V0, xtol=1e-15)
    middle, half = (V0 + least) / 2, (V0 - least) / 2  # v = middle + half·cos(a) takes the root's poles away
    x, weights = np.polynomial.legendre.leggauss(100)
    angles = np.pi / 2 * (1 + x)
    flows = np.sqrt([2 * work(v) / INERTIA for v in middle + half * np.cos(angles)])
    swing = float(np.pi / 2 * weights @ (half * np.sin(angles) / flows))
    probe = simulate(scene, tol=1e-8).probes["vessel"]
    t = swing + np.linspace(-0.05, 0.05, 2001)
    near = probe.at(t).u
    assert near.max() == pytest.approx(gas(least), rel=1e-6)
    assert t[near.argmax()] == pytest.approx(swing, abs=1e-3)
    assert probe.at(2 * swing).u == pytest.approx(P0, rel=1e-5)
