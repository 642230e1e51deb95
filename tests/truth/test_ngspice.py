"""ngspice, where it is installed, runs exported netlists and agrees within its own error, which falls with its step."""

import shutil

import pytest

from tline.charts import ngspice
from tline.charts.judge import Judge
from tline.charts.scenes import chart_scene
from tline.charts.work_precision import simulated

DEFAULT, REFINED = 20, 640  # steps in the shortest delay; the first is what an exported netlist asks for
ERRORS = {"rc": (0.03, 5e-5), "rlc": (0.04, 1e-3), "lossy": (2e-4, 3e-6)}  # twice what version 39.3 shows

pytestmark = pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")


@pytest.mark.parametrize("name", ERRORS)
def test_it_agrees_within_its_own_error(name):
    scene = chart_scene(name).scene
    judge = Judge(scene, 40)
    ours = simulated(scene, 1e-8)
    assert judge.errors(ours.t, ours.u)[0] < 3e-8
    for steps, bound in zip((DEFAULT, REFINED), ERRORS[name], strict=True):
        theirs = ngspice.run(scene, steps)
        assert judge.errors(theirs.t, theirs.u)[0] < bound
