"""A state space of poles is the function that was fitted, seen from any impedance."""

import numpy as np
import pytest

from passivity import PoleResidueModel
from tline.solver.description.load_step import reflection_of_poles

W = np.linspace(0, 10, 21)


@pytest.mark.parametrize("ratio", [1.0, 0.2, 30.0])
@pytest.mark.parametrize("constant", [0.3, -1.0, 1.0])
def test_reflection_against_another_impedance(ratio, constant):
    model = PoleResidueModel([-2, -1 + 3j, -0.5], [-0.4 * constant, (0.2 - 0.1j) * constant, 0.0], constant, 0, "S")
    A, b, c, d = reflection_of_poles(model, ratio)
    assert A.shape == (4, 4)
    seen = np.array([(c @ np.linalg.solve(1j * w * np.eye(4) - A, b) + d)[0, 0] for w in W])
    S = model.at(W)
    # (Z - z)/(Z + z) of Z = z0 (1 + S)/(1 - S) and ratio = z0/z
    expected = (ratio * (1 + S) - (1 - S)) / (ratio * (1 + S) + (1 - S))
    assert np.abs(seen - expected).max() < 1e-14
