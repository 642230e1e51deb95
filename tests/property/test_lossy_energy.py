"""Losses never create energy, whatever their kind, order, slabs and fractional delays."""

import numpy as np
import pytest
from energy import InLoads, on_lines
from hypothesis import given, settings
from hypothesis import strategies as st
from random_scenes import random_scene

from tline import Scene, simulate
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import Kernel

SLABS, PART = 2_000, 50
SILENT, UNRECORDED = np.zeros((0, 0)), np.zeros((0, 2, 0))


def lossy(seed: int, **scene) -> Scene:
    """A random network with resistance, conductance, skin effect or insulation losses on most lines."""
    table = random_scene(seed, switches=False).table() | scene
    rng = np.random.default_rng(seed)
    for line in table["lines"].values():
        line["length"] = 1.0
        strength = float(10 ** rng.uniform(-2, 1))
        choices = {
            "resistance": strength,
            "conductance": strength,
            "skin": {"resistance": strength, "frequency": 1.0},
            "loss_tangent": {"value": 0.05, "frequency": 1.0, "low": 0.01, "high": 100.0},
        }
        line |= {key: value for key, value in choices.items() if rng.random() < 0.4}
    return Scene(**table)


def with_friction(seed: int, **scene) -> Scene:
    """The same topology as pipes, with friction of several kinds and walls that creep."""
    table = random_scene(seed, loads=False).table() | scene
    rng = np.random.default_rng(seed)
    viscous = {"viscosity": float(10 ** rng.uniform(-3, 0))}
    kinds = [{"kind": "darcy", "factor": 0.02}, {"kind": "laminar", **viscous}, {"kind": "zielke", **viscous}]
    pipe = {"radius": 0.1, "density": 1000.0, "wave_speed": 1000.0, "wall_thickness": 0.005}
    lines = {}
    for name, line in table["lines"].items():
        creep = [{"compliance": 1e-10, "time": float(rng.uniform(0.1, 3))}] if rng.random() < 0.5 else None
        friction = kinds[int(rng.integers(3))]
        length = 1000.0 * line["delay"]
        lines[name] = {"nodes": line["nodes"], "length": length, "friction": friction, **pipe}
        lines[name] |= {"creep": creep} if creep else {}
    return Scene(**table | {"medium": "hydraulic", "lines": lines})


def in_losses(assembly: Assembly) -> float:
    """Half the sum of squares of the circuits' states, over z0."""
    diamonds, total = assembly.network.diamonds, 0.0
    memory, z0 = diamonds.memory, [line.z0 for line in assembly.lines.values()]
    for row, (line, k) in enumerate(zip(diamonds.line.tolist(), diamonds.cell.tolist(), strict=True)):
        for c in range(memory.first[row], memory.first[row + 1]):
            n = memory.modes[c] * (2 * (assembly.network.delay[line] // k) - 1)
            total += float(np.sum(assembly.state.memory[memory.state_at[c] :][:n] ** 2)) / (2 * z0[line])
    return total


@settings(max_examples=6, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    make=st.sampled_from([lossy, with_friction]),
    order=st.integers(1, 6),
    slab=st.floats(0.05, 0.49),
    size=st.sampled_from([1.0, 1e7]),
)
def test_energy_never_grows(seed, make, order, slab, size):
    scene = make(seed, solver={"order": order, "slab": slab})
    assembly = assemble(describe(scene), set())
    state = assembly.state
    rng = np.random.default_rng(seed)
    for part in (state.waves, state.before, state.memory):
        part[:] = size * rng.normal(size=part.shape)
    state.memory[:] *= 1e-2  # of the size that waves bring about, or less
    in_loads, kernel = InLoads(scene, assembly), Kernel(assembly.network, state)
    start = last = on_lines(assembly) + in_loads(assembly) + in_losses(assembly)
    for _ in range(SLABS // PART):
        assert kernel.blocks(PART, SILENT, UNRECORDED, 0) == -1
        now = on_lines(assembly) + in_loads(assembly) + in_losses(assembly)
        assert now <= last + 1e-12 * start  # roundings of so many slabs
        last = now


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # of fronts, smeared at loss elements
@pytest.mark.parametrize("seed", range(4))
def test_a_line_turned_round_gives_the_same(seed):
    scene = lossy(seed, solver={"order": 3, "slab": 0.25}, t_end=8.0)
    table = scene.table() | {"sources": {"s": {"at": "n0", "kind": "voltage", "value": 1, "resistance": 0.7}}}
    turned = {name: line | {"nodes": line["nodes"][::-1]} for name, line in table["lines"].items()}
    one, other = (simulate(Scene(**table | {"lines": lines})) for lines in (table["lines"], turned))
    scale = np.abs(one.probes["p"].u).max()
    assert np.abs(one.probes["p"].u - other.probes["p"].u).max() <= 1e-9 * scale
