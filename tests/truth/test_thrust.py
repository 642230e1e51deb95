"""Forces on bends and dead ends, against Joukowsky's rise and the formula of textbooks for a bend."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

import tline as tl
from tline.surge.thrust import thrusts

HEAD, WAVE, DENSITY, DIAMETER, FLOW, ANGLE = 6e5, 1000.0, 1000.0, 0.5, 0.2, radians(60)
AREA = pi / 4 * DIAMETER**2
RISE = DENSITY * WAVE * FLOW / AREA


def bent(up: float = 0.0) -> tl.scene.Scene:
    """A main that turns by an angle in its middle, so far below both ends, and shuts at once at its end."""
    pipe = {"length": 500, "diameter": DIAMETER, "wave_speed": WAVE, "density": DENSITY}
    shut = {"shape": "step", "from": 1, "to": 0, "at": 0.5}
    drop = HEAD - DENSITY * 9.80665 * up
    return tl.Scene(
        medium="hydraulic",
        t_end=1.9,
        start="steady",
        lines={
            "one": {"nodes": ["lake", "bend"], **pipe},
            "two": {"nodes": ["bend", "end"], **pipe, "vertices": [[3 * sin(ANGLE), 5 + 3 * cos(ANGLE)]]},
        },
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": HEAD},
            "valve": {"at": "end", "kind": "orifice", "flow": FLOW, "pressure_drop": drop, "opening": shut},
        },
        nodes={
            "lake": {"position": [0, 0], "elevation": up},
            "bend": {"position": [0, 5], "elevation": 0},
            "end": {"position": [99, 0], "elevation": up},
        },
        probes={"end": {"at": "end"}},
        solver={"order": 3, "slab": 0.1},
    )


def forces(scene: tl.Scene):
    return thrusts(tl.simulate(scene, envelope=True, record=[*scene.lines]))


def test_a_bend_and_a_dead_end():
    """2 (p A + density Q²/A) sin(angle/2) on the bend, p A on what is shut; none where the pressure is held."""
    found = forces(bent())
    assert found.keys() == {"bend", "end"}
    flowing = HEAD * AREA + DENSITY * FLOW**2 / AREA
    assert found["bend"].before == pytest.approx(2 * flowing * sin(ANGLE / 2), rel=1e-9)
    assert found["bend"].highest == pytest.approx(2 * (HEAD + RISE) * AREA * sin(ANGLE / 2), rel=1e-6)
    assert found["end"].highest == pytest.approx((HEAD + RISE) * AREA, rel=1e-6)
    assert 1.0 <= found["bend"].at <= 1.2


def test_slopes_count():
    """A bend 30 m below both of its ends: in space, not on the map; at the end the gauge pressure is less by that."""
    found, slope = forces(bent(30.0)), 30 / 500
    level = (1 - slope**2) ** 0.5
    ways = np.array([[0, -level, slope], [level * sin(ANGLE), level * cos(ANGLE), slope]])
    flowing = HEAD * AREA + DENSITY * FLOW**2 / AREA
    assert found["bend"].before == pytest.approx(flowing * np.linalg.norm(ways.sum(axis=0)), rel=1e-9)
    assert found["end"].highest == pytest.approx((HEAD - DENSITY * 9.80665 * 30 + RISE) * AREA, rel=1e-6)


def test_without_places_only_single_pipes_have_one():
    assert forces(bent().with_changes(nodes={})).keys() == {"end"}
