"""Tanks whose level moves, against closed forms."""

import numpy as np
import pytest

from tline import Scene, SceneError, simulate
from tline.interchange.water_scene import read_inp
from tline.scene.site import GRAVITY

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
