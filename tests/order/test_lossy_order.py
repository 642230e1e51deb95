"""How errors of lossy lines fall when slabs, cells or friction all along are made finer."""

import numpy as np
import pytest
from diamond_scenes import AREA, RISE, at_once, pipes, shut
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
    exact = run(describe(scene), Resolution(5, 1e-9 / 20)).probes["far"].at(t).u
    for n in SLABS:
        found = run(describe(scene), Resolution(3, 1e-9 / n, fit=1e-6, exact=False)).probes["far"].at(t).u
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


T_END = 8.0
WAVES = {"shape": "sine", "amplitude": AREA / 4, "frequency": 0.1, "offset": -AREA}


def errors(scene, order: int, parts) -> np.ndarray:
    """Largest errors at whole delays, with so many slabs a delay, against a far finer run of a high order."""
    t, found = np.arange(1.0, T_END), []
    for s, n in ((8, 8), *((order, n) for n in parts)):
        found.append(run(describe(scene), Resolution(s, 1 / n, diamonds=True)).probes["valve"].at(t).u / RISE)
    return np.abs(np.array(found[1:]) - found[0]).max(axis=1)


def slope(parts, found) -> float:
    return -np.polyfit(np.log(parts), np.log(found), 1)[0]


@pytest.mark.parametrize("flow", [at_once(0.0), WAVES], ids=["front", "smooth"])
@pytest.mark.parametrize(("order", "declared"), [(2, 2), (3, 4), (4, 6)])
def test_whole_slabs(order, declared, flow):
    parts = [1, 2, 4] if order < 4 else [1, 2]
    scene = shut(flow, pipes(1.0, kind="darcy", factor=0.4), T_END)
    assert slope(parts, errors(scene, order, parts)) > declared - 0.1


@pytest.mark.parametrize("order", [2, 3, 4])
def test_any_delays_and_fronts_at_any_instant(order):
    """The root mean square over random ones: where a front lies in its slab changes from width to width."""
    parts, rng = [1, 2, 4, 8], np.random.default_rng(1)
    scenes = [shut(at_once(a), pipes(1.0, 1 + d, kind="darcy", factor=0.4), T_END) for a, d in rng.random((4, 2))]
    found = np.array([errors(scene, order, parts) for scene in scenes])
    assert slope(parts, np.sqrt((found**2).mean(axis=0))) > order - 0.4


CELLS_T_END, SLAB = 8.0, 1 / 64
WIDTHS = [1 / 2, 1 / 4, 1 / 8, 1 / 16]
RAMP = {"shape": "ramp", "from": -AREA, "to": -AREA / 2, "at": 0, "duration": 4.0}
FRICTION = {"kind": "darcy", "factor": 0.2}


def errors_of_cells(scene, widths) -> np.ndarray:
    """Largest errors over Joukowsky's rise, against diamonds of order 4, at instants beside fronts."""
    description, t = describe(scene), np.arange(1.0, CELLS_T_END, 0.5) + 0.01
    exact = run(description, Resolution(4, 4 * SLAB)).probes["valve"].at(t).u
    runs = [run(description, Resolution(2, SLAB, cell=w)) for w in widths]
    return np.array([np.abs(each.probes["valve"].at(t).u - exact).max() / RISE for each in runs])


@pytest.mark.parametrize("flow", [WAVES, RAMP])
@pytest.mark.parametrize("delays", [(1.0,), (1.0, 0.87 * 2**0.5)])
def test_second_order(flow, delays):
    found = errors_of_cells(shut(flow, pipes(*delays, **FRICTION), CELLS_T_END), WIDTHS)
    assert np.polyfit(np.log(WIDTHS), np.log(found), 1)[0] > 1.5
    assert found[-1] < 1e-3


@pytest.mark.parametrize(("instant", "delays"), [(0.0, (1.0,)), (0.373, (1.0, 0.87 * 2**0.5))])
def test_fronts_part_cells(instant, delays):
    """Else friction behind a front would begin up to a cell before it."""
    wide, narrow = errors_of_cells(shut(at_once(instant), pipes(*delays, **FRICTION), CELLS_T_END), [1 / 4, 1 / 16])
    assert narrow < min(wide / 2, 2e-3)
