"""Random trees, bundles and laws beside lines that remember, against BDF2's quadrature of their own admittances."""

import pytest
from random_memory import judge, random_memory

from tline.scene.scene import Scene
from tline.solver.simulate import simulate


@pytest.mark.parametrize(("seed", "tol"), [(0, 1e-3), (8, 1e-3), (18, 1e-3), (12, 1e-5)])
def test_what_is_told_of_a_tree_or_a_bundle_is_no_less_than_a_third_of_the_error(seed, tol):
    """Beyond what two grids of BDF2 differ by; `python -m benchmarks.attack memory` has more seeds, and laws."""
    found = judge(random_memory(seed), tol)
    assert found.met
    assert found.over < 3
    assert found.knows < tol


def test_laws_in_silence_find_their_flow():
    """Tables as large as 1 under waves that are rounding: what is left of these is no residual."""
    scene = random_memory(11).scene
    result = simulate(Scene.model_validate(scene.table() | {"t_end": 1.0}), tol=1e-2)
    assert result.accuracy.met
