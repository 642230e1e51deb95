"""Four quadrants that a user gives."""

import pytest

from tline.errors import SceneError
from tline.scene.pump import Pump
from tline.scene.pump_curves import RADIAL


def test_the_same_figures_as_points_are_the_same_pump():
    own = [[h, b] for h, b in zip(RADIAL.head, RADIAL.torque, strict=True)]
    pump = {"nodes": ["sump", "end"], "curve": [(0.02, 5e5)], "efficiency": 0.8}
    one, other = (Pump(**pump, quadrants=quadrants) for quadrants in ("radial", own))
    assert one.law() == other.law()
    assert Pump(**other.table()) == other
    with pytest.raises(SceneError, match=r"quadrants: not Suter's tables, expected 9, 13, 17, \.\.\. points"):
        Pump(**pump, quadrants=own[:-1])
