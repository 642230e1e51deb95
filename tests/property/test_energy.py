"""A passive scene never gains energy: any slab width, any order, any delays, any run length."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from energy import InLoads, in_pieces, on_lines, silent
from hypothesis import given, settings, strategies as st
from random_scenes import random_scene

from tline.scene.scene import Scene
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.kernel.fronts.structures import LIVE
from tline.solver.loop.march import Kernel, Stepper
from tline.solver.radau import Basis

SLABS, PART, SINGLY = 100_000, 2_000, 200
ROUNDING = 1e-15  # of the energy at the start, per slab: each stored number is rounded a few times, either way
AT_ONCE = 1e-14  # in a single slab, where those roundings have no slabs to cancel over


def run(assembly: Assembly, kernel: Kernel, first: int, slabs: int) -> None:
    """Advance from slab `first` on, block by block; switches move at the starts of their slabs."""
    moves = {int(slab) for slab, _, _ in assembly.events if first <= int(slab) < first + slabs}
    edges = sorted({first, first + slabs} | moves)
    for low, high in pairwise(edges):
        for slab, node, row in assembly.events:
            if int(slab) == low:
                assembly.network.step_row[node] = row
        assert kernel.blocks(high - low, np.zeros((0, 0)), np.zeros((0, 2, 0)), 0) == -1


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.02, 0.49))
def test_stored_energy_never_grows(seed, order, slab):
    scene = random_scene(seed, solver={"order": order, "slab": slab})
    assembly = silent(scene, seed)
    in_loads, kernel = InLoads(scene, assembly), Kernel(assembly.network, assembly.state)
    start = last = on_lines(assembly) + in_loads(assembly)
    edges = [*range(SINGLY), *range(SINGLY, SLABS + 1, PART)]
    for low, high in pairwise(edges):
        run(assembly, kernel, low, high - low)
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + max(ROUNDING * (high - low), AT_ONCE) * start
        last = energy


@settings(max_examples=7, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.02, 0.49), lumped=st.integers(1, 4),
    sections=st.integers(1, 3),
)  # fmt: skip
def test_stored_energy_never_grows_in_lumped_lines(seed, order, slab, lumped, sections):
    scene = random_scene(seed, switches=False, solver={"order": order, "slab": slab})
    assembly = silent(scene, seed, {f"l{k}": sections for k in range(lumped)})
    in_loads, kernel = InLoads(scene, assembly), Kernel(assembly.network, assembly.state)
    assembly.state.load[:] = np.random.default_rng(seed).normal(size=assembly.state.load.shape)
    start = last = on_lines(assembly) + in_loads(assembly)
    edges = [*range(SINGLY), *range(SINGLY, SLABS // 10 + 1, PART)]
    for low, high in pairwise(edges):
        run(assembly, kernel, low, high - low)
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + max(ROUNDING * (high - low), AT_ONCE) * start
        last = energy
    assert last < start


@settings(max_examples=4, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.05, 0.49),
    settle=st.sampled_from([None, 0.02]),
)  # fmt: skip
def test_stored_energy_never_grows_with_fronts_under_way(seed, order, slab, settle):
    """Pulses whose edges hit no slab's, and switches, until t = 5 and 10; from the last pulse on, slab by slab.

    Or, without switches, lumped lines that are given some time to settle after each front.
    """
    silence, t_end = 5.0, 12.0
    table = random_scene(seed, switches=settle is None, sources=True, solver={"order": order, "slab": slab}).table()
    points = [[0, 1], [1.37, 1], [1.37, 0], [2.11, -1], [2.9, 0.3], [silence, 0]]
    table["sources"]["s"]["value"] = {"shape": "piecewise linear", "points": points}
    scene = Scene(**table | {"t_end": t_end})
    sections = {} if settle is None else {"l0": 1, "l1": 2}
    assembly = assemble(describe(scene), set(), resolution(describe(scene), sections=sections, settle=settle or 0.0))
    n = int(t_end / slab)
    steps, in_loads = Stepper(assembly, n, np.zeros((0, 2, n * order))), InLoads(scene, assembly)
    first, last, seen = int(silence / slab) + 1, np.inf, 0
    steps.advance(0, first)
    start = on_lines(assembly) + in_pieces(steps) + in_loads(assembly)
    for k in range(first, n):
        energy = on_lines(assembly) + in_pieces(steps) + in_loads(assembly)
        assert energy <= last + AT_ONCE * start
        last, seen = energy, seen + steps.fronts.counts[LIVE]
        steps.advance(k, k + 1)
    assert seen > 0


@pytest.mark.parametrize(("order", "lost"), [(4, 1e-6), (6, 1e-11), (8, 1e-11)])
def test_a_lossless_network_keeps_its_smooth_waves(order, lost):
    """The theorem is no blanket damping: what 10⁴ fractional shifts take from pulses falls with the order."""
    slab, slabs = 0.05, 10_000
    assembly = assemble(describe(random_scene(3, loads=False, solver={"order": order, "slab": slab})), set())
    net, s, c = assembly.network, assembly.basis.s, assembly.basis.c
    assembly.state.before[:] = 0.0
    for offset, delay in zip(net.offset, net.delay, strict=True):
        pulse = np.sin(np.pi * (np.arange(delay)[:, None] + c) / delay) ** 12
        assembly.state.waves[offset : offset + 2 * delay * s] = np.tile(pulse.ravel(), 2)
    start = on_lines(assembly)
    run(assembly, Kernel(assembly.network, assembly.state), 0, slabs)
    assert (1 - lost) * start < on_lines(assembly) < start * (1 + ROUNDING * slabs)


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
    kernel, start = Kernel(assembly.network, assembly.state), on_lines(assembly)
    for first in range(0, slabs, 100):
        run(assembly, kernel, first, 100)
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
        run(projected, Kernel(projected.network, projected.state), 0, 10_000)
        assert on_lines(projected) <= start * (1 + 1e-11)
