"""A steady start is steady: random circuits with multiports, driven by a constant source, stay as they began."""

import numpy as np
import pytest
from random_circuits import random_circuit

from tline.scene.scene import Scene
from tline.solver.simulate import simulate

ROUNDING = 1e-9  # over six decades of time constants; of 900 such circuits one, coupled by 0.9999, moved by 1.6e-9


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # what does not move needs no resolution
def test_nothing_moves_from_a_steady_start(seed):
    table = random_circuit(seed, 1 + seed % 8, laws=bool(seed % 2))
    ends = {at: name for name, line in table["lines"].items() for at in line["nodes"]}
    driven = {"at": next(iter(ends)), "kind": "pressure", "value": 1.7, "resistance": 0.8}
    probes = {at: {"at": at, "line": name} for at, name in ends.items()}
    result = simulate(Scene(**table | {"start": "steady", "sources": {"s": driven}, "probes": probes}))
    for probe in result.probes.values():
        assert np.abs(probe.u - probe.u[0]).max() < ROUNDING
