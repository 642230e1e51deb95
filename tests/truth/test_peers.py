"""Adapters of peers against exact solutions: they solve the same scene."""

import pytest

from tline.study.charts import inverse_fft
from tline.study.charts.measure import Judge
from tline.study.charts.scenes import chart_scene


@pytest.mark.parametrize("name", ["rc", "rlc"])
def test_scikit_rf_by_inverse_fft_converges(name):
    scene = chart_scene(name).scene
    assert inverse_fft.incompatibility(scene) is None
    judge = Judge(scene, 60)
    errors = [judge.errors(inverse_fft.run(scene, n))[1] for n in (50, 100, 200)]
    assert errors[2] < 5e-3
    assert errors[0] > 3 * errors[1] > 6 * errors[2]
