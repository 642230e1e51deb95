"""How errors of lossy lines fall when slabs, and with them loss elements, are halved."""

import itertools

import numpy as np
import pytest
from lossy_scenes import cable
from tline.solver.tolerance.extrapolate import extrapolated

from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.charts.scenes import chart_scene
from tline.study.reference.friction import FrictionSolution
from tline.study.reference.lossy import lossy_response

SLABS = (32, 64, 128, 256, 512)
STEP_ENDS = np.array([1, 3, 9, 13, 17, 30, 41])  # eighths of the delay


def errors(order: int, powers: tuple[int, ...]) -> np.ndarray:
    """Largest errors of runs extrapolated so often, at the coarsest slabs' ends."""
    scene = cable(t_end="6 ns", resistance=200)
    line = scene.lines["line"].losses.exact
    exact = lossy_response(line, [f"{k / 8}e-9" for k in STEP_ENDS], 0.0, source=25, load=100, digits=15)
    u = np.array([float(x) for x in exact.u])
    column = [run(describe(scene), Resolution(order, 1e-9 / n, diamonds=False)) for n in SLABS]
    for power in powers:
        column = [extrapolated(*pair, power) for pair in itertools.pairwise(column)]
    every = [round(1e-9 / 8 / result.resolution.h) for result in column]
    return np.array([np.abs(r.probes["near"].u[e * STEP_ENDS] - u).max() for r, e in zip(column, every, strict=True)])


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize(("powers", "slope"), [((), 1), ((1,), 2), ((1, 2), 3)])
def test_behind_a_step_each_extrapolation_adds_an_order(order, powers, slope):
    """With loss elements, which this line would not need."""
    found = errors(order, powers)
    fitted = -np.polyfit(np.arange(len(found)), np.log2(found), 1)[0]
    assert fitted == pytest.approx(slope, abs=0.25)


@pytest.mark.parametrize("order", [2, 4])
def test_darcys_friction_is_of_second_order_whatever_the_slabs(order):
    """With loss elements."""
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
