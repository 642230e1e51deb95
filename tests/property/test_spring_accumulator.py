"""What an accumulator on a spring holds, and the waves before it, only lose, at its stops as well."""

from itertools import pairwise

import numpy as np
from energy import in_pieces, on_lines, silent
from hypothesis import given, settings
from hypothesis import strategies as st

from tline.scene.scene import Scene
from tline.solver.loop.march import Stepper

AT_ONCE = 2e-14  # of the energy at the start, in one slab: roundings


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    order=st.integers(1, 7),
    slab=st.floats(0.05, 0.49),
    preload=st.floats(-0.5, 0.5),
    stroke=st.floats(0.05, 0.5),
    stiffness=st.floats(0.1, 10),
)
def test_stored_energy_never_grows(seed, order, slab, preload, stroke, stiffness):
    accumulator = {"kind": "spring accumulator", "piston_diameter": 1.0, "stiffness": stiffness, "preload": preload}
    scene = Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b", "stroke": stroke} | accumulator},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": slab},
    )
    assembly = silent(scene, seed)
    n = int(scene.t_end / slab)
    steps, laws = Stepper(assembly, n, np.zeros((0, 2, n * order))), assembly.network.laws
    energies = []
    for low, high in pairwise(range(n)):
        waiting = 0.0 if steps.fronts is None else in_pieces(steps)
        spring = laws.constants[1] * assembly.state.load[laws.state_at[0]] ** 2 / 2
        energies.append(on_lines(assembly) + waiting + spring)
        assert energies[-1] <= energies[max(len(energies) - 2, 0)] + AT_ONCE * energies[0]
        steps.advance(low, high)
