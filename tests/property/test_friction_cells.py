"""Friction in cells never creates energy, whatever its strength, the order, the delays and the waves."""

import numpy as np
import pytest
from diamond_scenes import pipes

from tline.scene.scene import Scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.ledger.ledger import stored
from tline.solver.loop.march import Kernel

SLABS, PART, ROUNDED = 600, 7, 1e-15  # of the energy in a slab


def closed(strength: float, delays) -> Scene:
    """Pipes one after the other, shut at the far end, whose friction is that many times Joukowsky's rise at 1 m/s."""
    source = {"at": "reservoir", "kind": "pressure", "value": 0, "resistance": 1e5}
    lines, ends = pipes(*delays, kind="darcy", factor=strength / 10), {"valve": {"at": "valve"}}
    return Scene(medium="hydraulic", t_end=1.0, lines=lines, sources={"s": source}, probes=ends)


@pytest.mark.parametrize("order", [2, 3, 5, 8])
@pytest.mark.parametrize("strength", [1e-6, 0.1, 10.0])
@pytest.mark.parametrize("delays", [(20.0, 33.0, 7.0), (9.0, 31.3, 2**0.5)])
def test_energy_only_falls(order, strength, delays):
    scene = describe(closed(strength, delays))
    assembly = assemble(scene, set(), Resolution(order, 1.0, cell=8.0))
    assert assembly.network.diamonds.cell.max() > 4
    rng, flow = np.random.default_rng(order), assembly.lines["pipe0"].z0 * np.pi * 0.25**2
    smooth = np.sin(np.linspace(0, 9, assembly.state.waves.size)) + 1e-3 * rng.normal(size=assembly.state.waves.size)
    assembly.state.waves[:] = (rng.normal(size=smooth.size) if order % 2 else smooth) * flow
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape) * flow
    kernel, seen = Kernel(assembly.network, assembly.state), [stored(assembly, None).sum()]
    for _ in range(SLABS // PART):
        excitation = np.zeros((len(assembly.excitations), PART * order))
        assert kernel.blocks(PART, excitation, np.zeros((2, 2, 0)), 0) < 0
        seen.append(stored(assembly, None).sum())
    assert (np.diff(seen) / seen[0]).max() < PART * ROUNDED * len(assembly.lines)
    assert seen[-1] < seen[0]
