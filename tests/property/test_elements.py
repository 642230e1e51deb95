"""Non-linear elements take energy and give none; a steady state stays; the inlined laws are their plain twins."""

from itertools import pairwise

import numpy as np
from energy import in_pieces, on_lines, silent
from hypothesis import given, settings
from hypothesis import strategies as st
from random_elements import random_elements

from tline.scene.law import KINDS
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.description.description import describe
from tline.solver.kernel.stores import gas, rotor, tank
from tline.solver.loop.march import Stepper
from tline.solver.simulate import simulate

AIR, GAS, TANK, VAPOUR = (KINDS[name].number for name in ("air", "gas", "tank", "vapour"))
AT_ONCE = 2e-14  # of the energy at the start, in one slab: roundings of waves and of the laws' solutions


def in_elements(assembly: Assembly) -> float:
    """Energy in gas and in surge tanks: half the square of the state, times what makes it J."""
    laws, total = assembly.network.laws, 0.0
    for kind, at, place in zip(laws.kind, laws.at, laws.state_at, strict=True):
        if place >= 0:
            c = laws.constants[at:]
            if kind == VAPOUR:
                total -= c[0] * assembly.state.load[place]
                continue
            if kind == AIR:
                volume, air = assembly.state.load[place : place + 2]
                total += c[1] * (air * np.log(air / volume) + volume - air) if air else 0.0
                continue
            unit = c[2] * c[3] if kind == GAS else c[2]
            stored = (gas if kind == GAS else tank if kind == TANK else rotor).stored
            total += unit * stored(laws.constants, at, assembly.state.load[place])[0] ** 2 / 2
    return total


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.06, 0.49))
def test_stored_energy_never_grows(seed, order, slab):
    """Any order, any slab, any delays, openings that move: waves, gas and tanks together only lose."""
    scene = random_elements(seed, solver={"order": order, "slab": slab})
    assembly = silent(scene, seed)
    n = int(scene.t_end / 2 / slab)  # openings move until then
    steps = Stepper(assembly, n, np.zeros((0, 2, n * order)))
    energies = []
    for low, high in pairwise(range(n)):
        waiting = 0.0 if steps.fronts is None else in_pieces(steps)
        energy = on_lines(assembly) + waiting + in_elements(assembly)
        energies.append(energy)
        assert energy <= energies[max(len(energies) - 2, 0)] + AT_ONCE * energies[0]
        steps.advance(low, high)


@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 6), slab=st.floats(0.1, 0.49))
def test_nothing_moves_where_nothing_is_operated(seed, order, slab):
    scene = random_elements(seed, operated=False, driven=True, start="steady", solver={"order": order, "slab": slab})
    scene = type(scene)(**scene.table() | {"t_end": 60.0})
    result = simulate(scene, record=list(scene.lines))
    scale = max(abs(wave.before) for line in result.lines.values() for wave in (line.a1, line.b1))
    for line in result.lines.values():
        for wave in (line.a1, line.b1, line.a2, line.b2):
            assert np.abs(wave.values - wave.before).max() <= 1e-9 * scale


def test_the_tests_cover_every_kind():
    """Random scenes hold each kind of law that stores or takes energy."""
    kinds = {law.kind for seed in range(60) for law in random_elements(seed).laws.values()}
    assert kinds == {"quadratic", "relief", "leak", "demand", "diode", "table", "gas", "tank", "vapour", "air"}
    assert assemble(describe(random_elements(3)), set()).network.laws.kind.size
