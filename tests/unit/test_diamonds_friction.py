"""Friction of diamonds: powers by table, and tangents."""

import numpy as np
import pytest

from tline.solver.assembly.diamonds import _power_table
from tline.solver.kernel.diamonds.full import bent, power


@pytest.mark.parametrize("n", [0.852, 1.0, 1 / 3, 2.0])
def test_powers_by_table_are_those_of_the_library(n):
    table = np.append(np.zeros(3), _power_table(n))  # at a place of its own
    x = np.append(np.exp(np.random.default_rng(1).uniform(-60, 60, 300)), [1.0, 2.0, np.nextafter(2.0, 0), 0.5])
    found = np.array([power(table, 3, each) for each in x])
    assert np.abs(found / x**n - 1).max() < 2e-14  # of n ln x, rounded
    assert power(table, 3, 0.0) == 0.0


def test_how_far_a_tangent_holds():
    """Of y² by three times what it is off, and not at all from rest, where its slope tells nothing."""
    base, away = 2.0, 0.1
    off = (base + away) ** 2 - (base**2 + 2 * base * away)
    assert off < bent(2 * base, base + away, base) < 3 * off
    assert bent(0.0, 1e-9, 0.0) > 1e200
    assert bent(0.0, 0.0, 0.0) == 0.0
