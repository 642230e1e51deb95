"""The reference with friction: its limit without any, what it says of its error, and other programs' answers."""

from importlib.util import find_spec

import numpy as np
import pytest

from tline import InputError, Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state
from tline.study.charts.scenes import chart_scene
from tline.study.programs import rthym, tsnet
from tline.study.reference import lattice
from tline.study.reference.friction import FrictionSolution

T = np.linspace(0, 20, 1001)
BOTH = pytest.mark.parametrize(("name", "finest"), [("friction", 256), ("network", 64)])


def changed(name: str = "friction", **parts) -> Scene:
    return Scene(**chart_scene(name).scene.table() | parts)


def with_factor(name: str, factor: float) -> Scene:
    lines = chart_scene(name).scene.table()["lines"]
    friction = {"kind": "darcy", "factor": factor}
    return changed(name, lines={key: pipe | {"friction": friction} for key, pipe in lines.items()})


def lossless(name: str) -> Scene:
    """What is shut is drawn the other way, from rest: without friction that adds to a steady state of no efforts."""
    given = chart_scene(name).scene.table()
    lines = {key: {k: v for k, v in pipe.items() if k != "friction"} for key, pipe in given["lines"].items()}
    (key,) = (key for key, draw in given["sources"].items() if isinstance(draw["value"], dict))
    ramp = given["sources"][key]["value"]
    drawn = ramp | {"from": 0, "to": ramp["from"].removeprefix("-")}
    return changed(name, lines=lines, sources={key: given["sources"][key] | {"value": drawn}}, start="rest")


def largest(solution: FrictionSolution, scene: Scene, wanted=None) -> float:
    """Largest effort at the probes, or largest difference to wanted ones."""
    efforts = {probe: solution.at(probe, T) for probe in scene.probes}
    return max(np.abs(efforts[probe] - (wanted[probe] if wanted else 0)).max() for probe in efforts)


@BOTH
def test_without_friction_it_is_the_exact_lattice(name, finest):
    scene = lossless(name)
    exact = {probe: np.array(lattice(scene, T.tolist(), probe, float)[0]) for probe in scene.probes}
    scale = max(np.abs(u).max() for u in exact.values())
    errors = [largest(FrictionSolution(with_factor(name, f), finest), scene, exact) / scale for f in (2e-6, 1e-6)]
    assert errors[1] < 1e-4
    assert errors[0] == pytest.approx(2 * errors[1], rel=1e-3)  # so it tends to zero with the factor


@BOTH
def test_its_error_falls_with_the_third_power_and_is_not_less_than_it_says(name, finest):
    scene = chart_scene(name).scene
    *grids, best = (FrictionSolution(scene, finest * 2**k) for k in range(4))
    errors = [each.error for each in (*grids, best)]
    assert -np.polyfit(range(4), np.log2(errors), 1)[0] > 2.8  # at least: where flows turn is on no grid
    wanted = {probe: best.at(probe, T) for probe in scene.probes}
    for rough in grids:
        assert largest(rough, scene, wanted) < rough.error
    assert best.error < 3e-8 * largest(best, scene)


@pytest.mark.parametrize("name", ["friction", "network"])
def test_before_anything_moves_it_is_the_steady_state(name):
    """The solver's own has nothing in common with it."""
    scene = chart_scene(name).scene
    efforts, _ = steady_state(describe(scene))
    solution = FrictionSolution(scene, 128)
    for probe in scene.probes.values():
        assert solution.at(str(probe.at), np.zeros(1)) == pytest.approx(efforts[str(probe.at)], rel=1e-12)


@pytest.mark.parametrize(("name", "counts"), [("friction", (16, 32)), ("network", (4, 8))])
@pytest.mark.parametrize("peer", [rthym, tsnet])
def test_other_programs_converge_to_it(peer, name, counts):
    scene = chart_scene(name).scene
    if why := peer.incompatibility(scene):
        pytest.skip(why)
    solution, errors = FrictionSolution(scene, 256), []
    for n in counts:
        run = peer.run(scene, n)
        exact = {probe: solution.at(probe, run.t) for probe in scene.probes}
        scale = max(np.abs(u).max() for u in exact.values())
        errors.append(max(np.abs(run.u[probe] - exact[probe]).max() for probe in exact) / scale)
    assert errors[1] < 4e-3
    assert errors[0] > 1.7 * errors[1]  # they are of the first order


@pytest.mark.skipif(not find_spec("rthym_moc"), reason="pip install 'tline[peers]'")
def test_the_factor_of_rthym_moc_is_that_of_the_scene_at_the_start():
    scene = chart_scene("friction").scene
    assert rthym.run(scene, 4).u["far"][0] == pytest.approx(FrictionSolution(scene, 256).at("far", T[:1])[0], rel=1e-12)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"start": "rest"}, "scene: has links, or does not start"),
        ({"lines": chart_scene("hammer").scene.table()["lines"]}, "lines.pipe: not with Darcy's friction alone"),
        ({"loads": {"tank": {"at": "tank", "kind": "resistor", "resistance": 1}}}, "loads.tank: holds no pressure"),
        ({"sources": {"p": {"at": "far", "kind": "pressure", "value": 1}}}, "sources.p: no flow of straight pieces"),
    ],
)
def test_what_it_cannot_do(parts, sentence):
    with pytest.raises(InputError, match=sentence):
        FrictionSolution(changed(**parts))


def test_corners_have_to_be_on_the_grid():
    with pytest.raises(InputError, match="corners of flows lie between points"):
        FrictionSolution(chart_scene("friction").scene, 24)
