"""Lossless multiports between lines and loads never create energy, at any order and slab."""

import numpy as np
from energy import InLoads, on_lines
from hypothesis import given, settings
from hypothesis import strategies as st

from tline.scene.scene import Scene
from tline.solver.assemble import assemble
from tline.solver.kernel import advance

SLABS = 300
ROUNDING = 1e-14  # of the energy at the start, in a slab


@st.composite
def scenes(draw):
    """A line to each port of a random junction, gyrator, transformer or pair of windings, with loads at all ends."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def size() -> float:
        return float(rng.uniform(0.2, 5))

    k = draw(st.integers(2, 4))
    q, _ = np.linalg.qr(rng.normal(size=(k, k)))
    kinds = [{"kind": "junction", "z0": size(), "scattering": q.tolist()}]
    if k == 2:
        kinds += [
            {"kind": "gyrator", "resistance": size()}, {"kind": "transformer", "ratio": float(rng.normal())},
            {"kind": "coupled inductors", "inductance": [size(), size()], "coupling": float(rng.uniform(-0.99, 0.99))},
        ]  # fmt: skip
    ports = [f"p{j}" for j in range(k)]
    lines = {f"l{j}": {"nodes": [f"e{j}", at], "z0": size(), "delay": size()} for j, at in enumerate(ports)}
    if draw(st.booleans()):
        del lines["l1"]  # that port has its load alone
    loads = [
        {"kind": "parallel", "resistance": size(), "capacitance": size()},
        {"kind": "series", "inductance": size(), "capacitance": size()}, {"kind": "resistor", "resistance": size()},
    ]  # fmt: skip
    if "l1" not in lines:  # nothing but inductors at a node would leave its effort open
        del loads[1]
    places = [*ports, *(line["nodes"][0] for line in lines.values())]
    loaded = {at: {"at": at} | loads[rng.integers(len(loads))] for at in places if at == "p1" or rng.random() > 0.3}
    return {
        "medium": "electrical", "t_end": 25.0, "lines": lines, "probes": {"p": {"at": "e0"}}, "loads": loaded,
        "links": {"x": {"nodes": ports} | kinds[rng.integers(len(kinds))]},
    }  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(table=scenes(), order=st.integers(1, 8), slabs=st.floats(1.0, 5.0), seed=st.integers(0, 2**32 - 1))
def test_stored_energy_never_grows(table, order, slabs, seed):
    slab = min(line["delay"] for line in table["lines"].values()) / slabs
    scene = Scene(**table | {"solver": {"order": order, "slab": slab}, "t_end": 100 * slab})
    assembly, rng = assemble(scene, set()), np.random.default_rng(seed)
    for part in (assembly.state.waves, assembly.state.before, assembly.state.load):
        part[:] = rng.normal(size=part.shape)
    in_loads, nothing = InLoads(scene, assembly), np.zeros((len(assembly.drives), order))
    start = last = on_lines(assembly) + in_loads(assembly)
    for _ in range(SLABS):
        assert advance(assembly.network, assembly.state, 1, nothing, np.zeros((0, 2, 0)), 0) == -1
        energy = on_lines(assembly) + in_loads(assembly)
        assert energy <= last + ROUNDING * start
        last = energy
