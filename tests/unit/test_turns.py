"""Instants at which the flow turns at an end of a pipe, which finer runs cut."""

import pytest
from one_line import one_line

from tline import simulate
from tline.solver.description.description import describe
from tline.solver.tolerance.kinks import Cuts

FREQUENCY = 0.6  # Hz


def test_turns_are_those_of_a_sine():
    """In a matched pipe with next to no friction the flow follows the sine: at once, and 1 s later at the far end."""
    pipe = {"length": 1000, "radius": 0.0265, "wave_speed": 1000, "density": 900}
    pipe |= {"friction": {"kind": "darcy", "factor": 1e-9}}
    sine, solver = {"shape": "sine", "amplitude": 2e5, "frequency": FREQUENCY}, {"order": 4, "slab": 1 / 32}
    scene = one_line(2.5, pipe, sine, 0, {"kind": "matched"}, medium="hydraulic", solver=solver)
    result = simulate(scene)
    cuts = Cuts(describe(scene), 1.0).ahead(result, result.resolution, later=True, stuck=False)
    half = 0.5 / FREQUENCY
    assert cuts["nodes.near"] == pytest.approx([half, 2 * half], abs=1e-4)  # as well as slabs of 1/32 resolve it
    assert cuts["nodes.far"] == pytest.approx([1 + half], abs=1e-4)
