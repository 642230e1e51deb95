"""The reference with friction: its limit without any, what it says of its error, and other programs' answers."""

from importlib.util import find_spec

import numpy as np
import pytest

from tline.charts import rthym, tsnet
from tline.charts.scenes import chart_scene
from tline.errors import InputError
from tline.reference import Solution
from tline.reference.friction import FrictionSolution
from tline.scene.scene import Scene

T = np.linspace(0, 20, 1001)


def changed(**parts) -> Scene:
    return Scene(**chart_scene("friction").scene.table() | parts)


def with_factor(factor: float) -> Scene:
    pipe = chart_scene("friction").scene.table()["lines"]["pipe"]
    return changed(lines={"pipe": pipe | {"friction": {"kind": "darcy", "factor": factor}}})


def test_without_friction_it_is_the_lossless_pipe():
    """Stopped from 200 L/s to 0 is the steady state and a draw from 0 to -200 L/s from rest."""
    drawn = chart_scene("hammer").scene.table()["sources"]["draw"]["value"] | {"to": "200 L/s"}
    sources = {"draw": {"at": "far", "kind": "flow", "value": drawn}}
    lossless = Scene(**chart_scene("hammer").scene.table() | {"sources": sources})
    exact = np.array(Solution(lossless, "far").at(T.tolist(), 18).efforts, float)
    scale = np.abs(exact).max()
    errors = [np.abs(FrictionSolution(with_factor(f), 256).at(T) - exact).max() / scale for f in (2e-6, 1e-6)]
    assert errors[1] < 1e-4
    assert errors[0] == pytest.approx(2 * errors[1], rel=1e-3)  # so it tends to zero with the factor


def test_its_error_falls_with_the_third_power_and_is_not_less_than_it_says():
    scene = chart_scene("friction").scene
    grids = [FrictionSolution(scene, n) for n in (512, 1024, 2048)]
    assert grids[1].error < grids[0].error / 7
    scale = np.abs(grids[2].at(T)).max()
    for rough in grids[:2]:
        assert np.abs(rough.at(T) - grids[2].at(T)).max() < rough.error
    assert grids[2].error < 2e-8 * scale


@pytest.mark.parametrize("peer", [rthym, tsnet])
def test_other_programs_converge_to_it(peer):
    scene = chart_scene("friction").scene
    if why := peer.misfit(scene):
        pytest.skip(why)
    solution = FrictionSolution(scene, 1024)
    errors = []
    for n in (16, 32):
        run = peer.run(scene, n)
        exact = solution.at(run.t)
        errors.append(np.abs(run.u["far"] - exact).max() / np.abs(exact).max())
    assert errors[1] < 3e-3
    assert errors[0] > 1.7 * errors[1]  # they are of the first order


@pytest.mark.skipif(not find_spec("rthym_moc"), reason="pip install 'tline[peers]'")
def test_the_factor_of_rthym_moc_is_that_of_the_scene_at_the_start():
    scene = chart_scene("friction").scene
    assert rthym.run(scene, 4).u["far"][0] == pytest.approx(FrictionSolution(scene, 256).at(T[:1])[0], rel=1e-12)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"start": "rest"}, "lines.pipe: not with Darcy's friction alone"),
        ({"loads": {"tank": {"at": "tank", "kind": "resistor", "resistance": 1}}}, "loads.tank: holds no pressure"),
        ({"sources": {"p": {"at": "far", "kind": "pressure", "value": 1}}}, "sources.p: no flow of straight pieces"),
    ],
)
def test_what_it_cannot_do(parts, sentence):
    with pytest.raises(InputError, match=sentence):
        FrictionSolution(changed(**parts))


def test_corners_have_to_be_on_the_grid():
    with pytest.raises(InputError, match="corners of the flow lie between points"):
        FrictionSolution(chart_scene("friction").scene, 24)
