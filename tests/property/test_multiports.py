"""Lossless multiports between lines and loads never create energy, at any order and slab."""

import numpy as np
from energy import InLoads, on_lines
from hypothesis import given, settings, strategies as st
from random_multiports import multiport_scenes

from tline.scene.scene import Scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import Kernel

SLABS = 300
ROUNDING = 1e-14  # of the energy at the start, in a slab


@settings(max_examples=30, deadline=None)
@given(table=multiport_scenes(), order=st.integers(1, 8), slabs=st.floats(1.0, 5.0), seed=st.integers(0, 2**32 - 1))
def test_stored_energy_never_grows(table, order, slabs, seed):
    slab = min(line["delay"] for line in table["lines"].values()) / slabs
    scene = Scene(**table | {"solver": {"order": order, "slab": slab}, "t_end": 100 * slab})
    assembly, rng = assemble(describe(scene), set()), np.random.default_rng(seed)
    for part in (assembly.state.waves, assembly.state.before, assembly.state.load):
        part[:] = rng.normal(size=part.shape)
    in_loads, nothing = InLoads(scene, assembly), np.zeros((len(assembly.excitations), order))
    kernel = Kernel(assembly.network, assembly.state)
    start = last = on_lines(assembly) + in_loads(assembly)
    for _ in range(SLABS):
        assert kernel.blocks(1, nothing, np.zeros((0, 2, 0)), 0) == -1
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + ROUNDING * start
        last = energy
