"""Runs to a tolerance keep it on random networks, by solutions that owe the solver nothing."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_scenes import random_scene

from tline import Scene, simulate
from tline.study.reference import exact

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
TOL = 1e-7


@settings(max_examples=7, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_effort_and_flow_are_within_the_tolerance(seed):
    scene = random_scene(seed, lines=3, sources=True, switches=False)
    scene = Scene(**scene.table() | {"t_end": 6.0})
    result = simulate(scene, tol=TOL)
    seen = result.probes["p"].samples
    few = np.linspace(1, len(seen.t) - 1, 25).astype(int)
    few = few[seen.t[few] <= 6.0]
    true, z0 = exact(scene, seen.t[few].tolist(), "p"), result.probes["p"].record.z0
    for found, expected in ((seen.u[few], true.efforts), (z0 * seen.y[few], z0 * true.flows)):
        amplitude = max(np.abs(true.efforts).max(), z0 * np.abs(true.flows).max())
        assert np.abs(found - expected).max() <= 3 * TOL * amplitude
