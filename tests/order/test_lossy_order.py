"""How errors of lossy lines fall when slabs, and with them cells, are halved."""

import numpy as np
import pytest
from lossy_scenes import cable

from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.charts.scenes import chart_scene
from tline.study.reference.friction import FrictionSolution
from tline.study.reference.lossy import lossy_response

SLABS = (16, 32, 64, 128)
STEP_ENDS = np.array([1, 3, 9, 13, 17, 30, 41])  # eighths of the delay


@pytest.mark.parametrize(("order", "slope"), [(1, 1), (2, 2), (3, 2)])
def test_behind_a_step_cells_are_of_second_order(order, slope):
    """But with order 1, whose values are means of slabs; diamonds would serve, too."""
    scene = cable(t_end="6 ns", resistance=200)
    line = scene.lines["line"].losses.exact
    exact = lossy_response(line, [f"{k / 8}e-9" for k in STEP_ENDS], 0.0, source=25, load=100, digits=15)
    u, errors = np.array([float(x) for x in exact.u]), []
    for n in SLABS:
        found = run(describe(scene), Resolution(order, 1e-9 / n, diamonds=False))
        errors.append(np.abs(found.probes["near"].u[n // 8 * STEP_ENDS] - u).max())
    assert -np.polyfit(np.arange(len(SLABS)), np.log2(errors), 1)[0] == pytest.approx(slope, abs=0.1)


SMOOTH = {"shape": "sine", "amplitude": 1, "frequency": "0.2 GHz"}
REMEMBERS = {
    "leak": {"conductance": 0.004},
    "skin": {"skin": {"resistance": 60, "frequency": "10 GHz"}},
    "insulation": {"loss_tangent": {"value": 0.02, "frequency": "1 GHz", "low": "1 MHz", "high": "100 GHz"}},
}


@pytest.mark.parametrize("losses", REMEMBERS.values(), ids=REMEMBERS)
@pytest.mark.parametrize("delay", [1.0, 0.8])
def test_memory_is_of_second_order(losses, delay):
    """Against a convolution on slabs that divide the delay, of a sine, at instants behind its start."""
    scene = cable(SMOOTH, t_end="6 ns", **losses).change({"lines.line.length": 0.2 * delay})
    t, errors = np.linspace(3e-9, 5.9e-9, 50), []
    exact = run(describe(scene), Resolution(5, 1e-9 / 40)).probes["far"].at(t).u
    for n in SLABS:
        found = run(describe(scene), Resolution(3, 1e-9 / n, fit=1e-9, exact=False)).probes["far"].at(t).u
        errors.append(np.abs(found - exact).max())
    assert -np.polyfit(np.arange(len(SLABS)), np.log2(errors), 1)[0] > 1.5
    assert errors[-1] < 1e-4


@pytest.mark.parametrize("order", [2, 4])
def test_darcys_friction_is_of_second_order_whatever_the_slabs(order):
    scene = chart_scene("friction").scene
    exact, (line,) = FrictionSolution(scene, 1024), scene.lines.values()
    found = []
    for n in SLABS:
        chosen = Resolution(order, float(line.parameters.delay) / n, diamonds=False)
        (probe,) = run(describe(scene), chosen).probes.values()
        k = np.arange(1, len(probe.t))
        k = k[k % n != 0]  # between fronts
        found.append(np.abs(probe.u[k] - exact.at("far", probe.t[k])).max())
    assert -np.polyfit(np.arange(len(found)), np.log2(found), 1)[0] == pytest.approx(2, abs=0.2)
