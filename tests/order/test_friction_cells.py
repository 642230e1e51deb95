"""Friction in cells many slabs wide: of second order in their width, and as exact as diamonds beside fronts."""

import numpy as np
import pytest
from diamond_scenes import AREA, RISE, at_once, pipes, shut

from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run

T_END, SLAB = 8.0, 1 / 64
WIDTHS = [1 / 2, 1 / 4, 1 / 8, 1 / 16]
WAVES = {"shape": "sine", "amplitude": AREA / 4, "frequency": 0.1, "offset": -AREA}
RAMP = {"shape": "ramp", "from": -AREA, "to": -AREA / 2, "at": 0, "duration": 4.0}
FRICTION = {"kind": "darcy", "factor": 0.2}


def errors(scene, widths) -> np.ndarray:
    """Largest errors over Joukowsky's rise, against diamonds of order 4, at instants beside fronts."""
    description, t = describe(scene), np.arange(1.0, T_END, 0.5) + 0.01
    exact = run(description, Resolution(4, 4 * SLAB)).probes["valve"].at(t).u
    runs = [run(description, Resolution(2, SLAB, cell=w)) for w in widths]
    return np.array([np.abs(each.probes["valve"].at(t).u - exact).max() / RISE for each in runs])


@pytest.mark.parametrize("flow", [WAVES, RAMP])
@pytest.mark.parametrize("delays", [(1.0,), (1.0, 0.87 * 2**0.5)])
def test_second_order(flow, delays):
    found = errors(shut(flow, pipes(*delays, **FRICTION), T_END), WIDTHS)
    assert np.polyfit(np.log(WIDTHS), np.log(found), 1)[0] > 1.5
    assert found[-1] < 1e-3


@pytest.mark.parametrize(("instant", "delays"), [(0.0, (1.0,)), (0.373, (1.0, 0.87 * 2**0.5))])
def test_fronts_part_cells(instant, delays):
    """Else friction behind a front would begin up to a cell before it."""
    wide, narrow = errors(shut(at_once(instant), pipes(*delays, **FRICTION), T_END), [1 / 4, 1 / 16])
    assert narrow < min(wide / 2, 2e-3)
