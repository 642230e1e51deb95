"""Right behind fronts, where loads and lines far faster than slabs answer: no error is larger than told, anywhere."""

from functools import cache

import numpy as np
import pytest

from tline import Scene, simulate
from tline.study.charts.measure import Judge
from tline.study.charts.scenes import chart_scene
from tline.study.charts.work_precision import simulated

ROUNDING = 1e-13
pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")


@cache
def judge(name: str) -> Judge:
    return Judge(chart_scene(name).scene, 200)


@pytest.mark.parametrize("name", ["stiff", "stub"])
@pytest.mark.parametrize("tol", [1e-3, 1e-6, 1e-8, 1e-9, 1e-10])
def test_errors_anywhere_are_as_told(name, tol):
    done = simulated(judge(name).scene, tol)
    assert done.estimated <= tol
    assert judge(name).errors(done)[0] <= 3 * max(done.estimated, ROUNDING)


@pytest.mark.parametrize("order", [3, 6, 12])
def test_of_a_given_order_narrower_slabs_are_cut_elsewhere(order):
    """Pieces at the same instants would hold the same polynomials, and tell of no error."""
    stiff = judge("stiff")
    fixed = Scene(**stiff.scene.table() | {"solver": {"order": order}})
    for tol in (1e-3, 1e-6, 1e-9):
        done = simulated(fixed, tol)
        assert stiff.errors(done)[0] <= 3 * done.estimated


def test_how_far_off_lumped_lines_are_is_told_where_lines_would_take_long():
    scene = chart_scene("stub").scene
    result = simulate(Scene(**scene.table() | {"t_end": "100 ns"}), tol=1e-6)
    assert result.accuracy.met
    assert 1e-5 < result.accuracy.behind_fronts < 1e-3
    (note,) = (note for note in result.notes if "lumped" in note)
    assert note.endswith("no tolerance is asked there")
    late = result.probes["far"].at(2e-9 + np.array([1e-15, 1e-13])).u  # the ramp has just begun
    assert 1e-5 < np.abs(late).max() < 1e-3
