"""The electrical scenes with circuits against their equations written by hand, and against ngspice."""

from pathlib import Path

import pytest
from electrical_by_hand import ELECTRICAL

from tline.scene.file import read_scene
from tline.solver.simulate import simulate

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ELECTRICAL)
def test_a_scene_is_its_delay_equations(name):
    """SciPy's DOP853 at 1e-13, from corner to corner, of which steps halved show 2e-11."""
    result = simulate(read_scene(SCENES / f"{name}.toml"), tol=1e-9)
    at_slab_ends = ELECTRICAL[name].differences(result.probes)
    assert max(at_slab_ends.values()) < 1e-9, at_slab_ends
    inside = ELECTRICAL[name].differences(result.probes, inside=500)
    assert max(inside.values()) < 1e-8, inside
