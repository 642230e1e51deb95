"""A passive scene never gains energy: any slab width, any order, any delays, any run length."""

import dataclasses

import numpy as np
import pytest
from energy import InLoads, on_lines
from hypothesis import given, settings
from hypothesis import strategies as st
from random_scenes import random_scene

from tline.scene.scene import Scene
from tline.solver.assemble import Assembly, assemble
from tline.solver.kernel import advance
from tline.solver.radau import Basis

SLABS, PART = 100_000, 2_000
# per slab each stored number is rounded a few times; the energies of 10⁵ slabs may drift by their sum at worst
ROUNDING = 1e-15 * PART


def silent(scene, seed: int) -> Assembly:
    """The scene without sources, its lines filled with random waves."""
    assembly = assemble(scene, set())
    rng = np.random.default_rng(seed)
    assembly.state.waves[:] = rng.normal(size=assembly.state.waves.shape)
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape)
    return assembly


def run(assembly: Assembly, slabs: int) -> None:
    for _, node, row in assembly.changes:
        assembly.network.step_row[node] = row
    status = advance(assembly.network, assembly.state, slabs, np.zeros((0, 0)), np.zeros((0, 2, 0)), 0)
    assert status == -1


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.02, 0.49))
def test_stored_energy_never_grows(seed, order, slab):
    scene = random_scene(seed, solver={"order": order, "slab": slab})
    assembly = silent(scene, seed)
    in_loads = InLoads(scene, assembly)
    start = last = on_lines(assembly) + in_loads(assembly)
    for _ in range(SLABS // PART):
        run(assembly, PART)
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + ROUNDING * start
        last = energy


def test_a_lossless_network_keeps_its_smooth_waves():
    """The theorem is no blanket damping: what slabs resolve stays."""
    scene = random_scene(3, loads=False, solver={"order": 6, "slab": 0.05})
    assembly = assemble(scene, set())
    assembly.state.waves[:] = 1.0
    assembly.state.before[:] = 1.0
    start = on_lines(assembly)
    run(assembly, 10_000)
    assert on_lines(assembly) == pytest.approx(start, rel=1e-11)


def interpolating(basis: Basis, f: float) -> tuple[np.ndarray, np.ndarray]:
    """The delayed wave read off pointwise, as interpolation does, in place of projection."""
    now, before = np.zeros((basis.s, basis.s)), np.zeros((basis.s, basis.s))
    for i, c in enumerate(basis.c):
        (now if c >= f else before)[i] = basis.evaluation([c - f if c >= f else c - f + 1.0])[0]
    return now, before


def two_lines(order: int, slab: float, *, interpolated: bool) -> Assembly:
    """Two lossless lines without common measure, closed at both ends."""
    scene = Scene(
        medium="electrical",
        t_end=1.0,
        solver={"order": order, "slab": slab},
        lines={
            "one": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0},
            "two": {"nodes": ["b", "c"], "z0": 2.0, "delay": 2**0.5 / 1.3},
        },
        probes={"p": {"at": "a"}},
    )
    assembly = silent(scene, 1)
    if not interpolated:
        return assembly
    delays = np.array([line.parameters.delay for line in scene.lines.values()])
    rests = delays / slab - assembly.network.delay
    shift = np.array([interpolating(assembly.basis, f) for f in rests])
    return dataclasses.replace(assembly, network=assembly.network._replace(shift=shift, shift_row=np.arange(2)))


def grows(assembly: Assembly, slabs: int = 10_000) -> bool:
    """Whether the energy on the lines reaches 10²⁰ times what it was."""
    start = on_lines(assembly)
    for _ in range(slabs // 100):
        run(assembly, 100)
        if on_lines(assembly) > 1e20 * start:
            return True
    return False


WIDTHS = (0.11, 0.17, 0.19, 0.3)


@pytest.mark.parametrize("order", range(2, 9))
def test_interpolation_in_its_place_blows_up(order):
    """For every order there are slab widths at which interpolation grows without end; projection at none."""
    assert any(grows(two_lines(order, slab, interpolated=True)) for slab in WIDTHS)
    for slab in WIDTHS:
        projected = two_lines(order, slab, interpolated=False)
        start = on_lines(projected)
        run(projected, 10_000)
        assert on_lines(projected) <= start * (1 + 1e-11)
