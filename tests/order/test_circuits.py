"""The error at slab ends of circuits between lines falls at twice the order of the method, less one."""

import numpy as np
import pytest
from bounces import COILS, SERIES, closed_form, scene_of

from tline.solver.simulate import simulate

SLABS = np.array([0.125, 0.0625, 0.03125])
INSTANTS = np.arange(0.5, 10, 0.5)[3::2]  # halfway between echoes


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("link", [SERIES, COILS], ids=["series RLC", "coupled coils"])
def test_the_error_falls_at_twice_the_order_less_one(link, order):
    exact = closed_form(link, INSTANTS)
    errors = []
    for slab in SLABS:
        probes = simulate(scene_of(link, order, slab)).probes
        ends = np.round(INSTANTS / slab).astype(int)
        assert np.abs(probes["far"].t[ends] - INSTANTS).max() < 1e-12
        errors.append(
            max(np.abs(probes[name].u[ends] - u).max() for name, u in zip(("near", "far"), exact, strict=True))
        )
    assert np.polyfit(np.log(SLABS), np.log(errors), 1)[0] > 2 * order - 1.3
