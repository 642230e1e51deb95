"""Friction all along never creates energy: whatever its strength, order, slabs, delays and waves."""

import numpy as np
import pytest

from tline.scene.scene import Scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.loop.march import Kernel
from tline.solver.radau import basis

PIPE = {"diameter": 0.5, "wave_speed": 1000, "density": 1000}
SLABS, PART, ROUNDED = 500, 50, 1e-15  # of the energy in a slab


def closed(strength: float, delays) -> Scene:
    """A star of pipes, all ends but one shut; friction is that many times Joukowsky's rise at 1 m/s."""
    friction = {"kind": "darcy", "factor": strength}
    lines = {
        f"pipe{k}": PIPE | {"nodes": ["joint", f"end{k}"], "length": 1000.0 * d, "friction": friction}
        for k, d in enumerate(delays)
    }
    source = {"at": "end0", "kind": "pressure", "value": 0, "resistance": 1e5}
    return Scene(medium="hydraulic", t_end=1.0, lines=lines, sources={"s": source}, probes={"end": {"at": "end1"}})


def energy(assembly) -> float:
    """Under way, over the length of a slab: slabs in the buffers, and rests that have not arrived."""
    network, state, s = assembly.network, assembly.state, assembly.basis.s
    weight, total = basis(s).A[-1], 0.0
    for k, line in enumerate(assembly.lines.values()):
        waves = state.waves[network.offset[k] :][: 2 * network.delay[k] * s].reshape(-1, s)
        tails = state.before[2 * k : 2 * k + 2]
        total += (waves**2 @ weight).sum() / line.z0 + network.diamonds.rest[k] * (tails**2 @ weight).sum() / line.z0
    return total


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("strength", [1e-6, 0.1, 10.0])
@pytest.mark.parametrize("delays", [(1.0, 2.0, 3.0), (1.0, 1.3, 2**0.5)])
def test_energy_only_falls(order, strength, delays):
    assembly = assemble(describe(closed(strength, delays)), set(), Resolution(order, 1.0, diamonds=True))
    rng, flow = np.random.default_rng(order), assembly.lines["pipe0"].z0 * np.pi * 0.25**2
    assembly.state.waves[:] = rng.normal(size=assembly.state.waves.shape) * flow
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape) * flow
    kernel, seen = Kernel(assembly.network, assembly.state), [energy(assembly)]
    for _ in range(SLABS // PART):
        excitation = np.zeros((len(assembly.excitations), PART * order))
        assert kernel.blocks(PART, excitation, np.zeros((2, 2, 0)), 0) < 0
        seen.append(energy(assembly))
    growth = np.diff(seen) / seen[0]
    assert growth.max() < PART * ROUNDED * len(assembly.lines)
    assert seen[-1] < seen[0]
