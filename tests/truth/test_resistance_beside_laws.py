"""Constant resistance all along a line beside a law that passes nothing: the exact solution of the line without it."""

import numpy as np
import pytest
from lossy_scenes import cable

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.simulate import simulate
from tline.study.reference.lossy import LossySolution

RAMP = {"shape": "ramp", "to": -1, "at": "0.21 ns", "duration": "0.37 ns"}


@pytest.mark.parametrize("tol", [1e-4, 1e-9])
def test_a_ramp_is_as_wrong_as_told(tol):
    linear = cable(value=RAMP, t_end="8 ns", resistance=200)
    table = linear.table()
    table["loads"]["d"] = {"at": "b", "kind": "diode", "saturation": 1e-30}
    scene = Scene(**table)
    assert describe(scene).diamonds
    result = simulate(scene, tol=tol)
    assert result.accuracy.met
    t = np.random.default_rng(3).uniform(0, 8e-9, 40)
    for name, probe in result.probes.items():
        exact = np.array(LossySolution(linear, name).at(t.tolist(), 14).u, float)
        wrong = np.abs(probe.at(t).u - exact).max()
        assert wrong <= (3 * result.accuracy.worst + 1e-13) * np.abs(exact).max()
