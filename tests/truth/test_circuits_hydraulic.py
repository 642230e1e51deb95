"""The hydraulic scenes with circuits against their equations written by hand."""

from pathlib import Path

import pytest
from hydraulic_by_hand import HYDRAULIC

from tline.scene.file import read_scene
from tline.solver.simulate import simulate

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", HYDRAULIC)
def test_a_scene_is_its_delay_equations(name):
    """SciPy's DOP853 at 1e-13, from corner to corner and from event to event."""
    result = simulate(read_scene(SCENES / f"{name}.toml"), tol=1e-9)
    at_slab_ends = HYDRAULIC[name].differences(result.probes)
    assert max(at_slab_ends.values()) < 1e-9, at_slab_ends
    inside = HYDRAULIC[name].differences(result.probes, inside=500)
    assert max(inside.values()) < 1e-8, inside
