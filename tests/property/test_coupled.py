"""Coupled conductors never create energy, at any order, slab and load; and turned round they are mirrored."""

import numpy as np
import pytest
from energy import InLoads, on_lines
from hypothesis import given, settings, strategies as st

from tline import Scene, simulate
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import Kernel

SLABS = 400
ROUNDING = 1e-14  # of the energy at the start, in a slab


@st.composite
def scenes(draw, losses):
    """Conductors with random L, C, ends of R, L and C, a source at one of them.

    Perhaps with a single line behind it; perhaps with losses, R in proportion to L and G to C, which share their modes.
    """
    k, rng = draw(st.integers(2, 4)), np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    mutual, skew = np.triu(rng.uniform(0, 0.3, (k, k)), 1), rng.normal(size=(k, k))
    C = np.diag(rng.uniform(0.1, 1, k) + (mutual + mutual.T).sum(axis=1)) - mutual - mutual.T
    L = skew @ skew.T + 0.2 * np.eye(k)
    near, far = ([f"{end}{j}" for j in range(k)] for end in "ab")

    def size() -> float:
        return float(rng.uniform(0.2, 5))

    def load(at: str) -> dict:
        kinds = [
            {"kind": "resistor", "resistance": size()}, {"kind": "open"}, {"kind": "short"},
            {"kind": "parallel", "resistance": size(), "capacitance": size()},
            {"kind": "series", "inductance": size(), "capacitance": size()},
        ]  # fmt: skip
        return {"at": at} | kinds[rng.integers(len(kinds))]

    loads = {at: load(at) for at in (*near[1:], *far)}
    wires = {"nodes1": near, "nodes2": far, "length": 1, "inductance": L.tolist(), "capacitance": C.tolist()}
    if draw(losses):
        r, g = rng.uniform(0.05, 1, 2)
        wires |= {"resistance": (r * L).tolist(), "conductance": (g * C).tolist()}
    lines = {"wires": wires}
    if draw(st.booleans()):
        lines["tail"] = {"nodes": [far[0], "end"], "z0": size(), "delay": size()}
    pulse = {"shape": "pulses", "high": 1, "at": 0.1, "width": 0.7, "rise": 0.2, "fall": 0.1}
    sources = {"s": {"at": near[0], "kind": "voltage", "resistance": size(), "value": pulse}}
    return {
        "medium": "electrical", "t_end": 25.0, "lines": lines, "sources": sources, "loads": loads,
        "probes": {at: {"at": at, "line": "wires"} for at in (*near, *far)},
    }  # fmt: skip


@settings(max_examples=15, deadline=None)
@given(table=scenes(st.booleans()), order=st.integers(1, 8), slabs=st.floats(1.0, 5.0), seed=st.integers(0, 2**32 - 1))
def test_stored_energy_never_grows(table, order, slabs, seed):
    whole = Scene(**table)
    slab = min(line.shortest for line in whole.single_lines.values()) / slabs
    silent = Scene(**table | {"solver": {"order": order, "slab": slab}, "t_end": 100 * slab})
    assembly, rng = assemble(describe(silent), set()), np.random.default_rng(seed)
    assembly.state.waves[:] = rng.normal(size=assembly.state.waves.shape)
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape)
    assembly.state.load[:] = rng.normal(size=assembly.state.load.shape)
    in_loads, nothing = InLoads(silent, assembly), np.zeros((len(assembly.excitations), order))
    kernel = Kernel(assembly.network, assembly.state)
    start = last = on_lines(assembly) + in_loads(assembly)
    for _ in range(SLABS):
        assert kernel.blocks(1, nothing, np.zeros((0, 2, 0)), 0) == -1
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + ROUNDING * start
        last = energy
    assert last < start


@settings(max_examples=4, deadline=None)
@given(table=scenes(st.just(False)))
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_turned_round_they_are_mirrored(table):
    wires = table["lines"]["wires"]
    turned = table["lines"] | {"wires": wires | {"nodes1": wires["nodes2"], "nodes2": wires["nodes1"]}}
    solver = {"order": 4, "slab": min(line.shortest for line in Scene(**table).single_lines.values()) / 4}
    one, other = (simulate(Scene(**table | {"lines": lines, "solver": solver})) for lines in (table["lines"], turned))
    for name, probe in one.probes.items():
        assert np.abs(probe.u - other.probes[name].u).max() < 1e-11
        assert np.abs(probe.y + other.probes[name].y).max() < 1e-10
