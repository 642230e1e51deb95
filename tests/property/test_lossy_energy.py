"""Losses never create energy, whatever their kind, order, slabs and delays: in cells, all along, by convolution."""

from itertools import product
from math import floor

import numpy as np
import pytest
from energy import InLoads, on_lines
from hypothesis import given, settings, strategies as some, strategies as st
from random_scenes import random_scene
from remembering_scenes import SCENES

from tline import Scene, simulate
from tline.loss import ConstantLoss, DielectricLoss, EarthReturn, LaminarFriction, LossyLine, RoundWire, SkinEffect
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature, gain
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.loop.march import Kernel
from tline.solver.radau import basis
from tline.solver.stability.scattering import carried

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


LENGTH = 0.2
WATER = LaminarFriction(density=1000, viscosity=1e-3, radius=0.01)
LINES = {
    "skin": (SkinEffect(5, 1e-3) + ConstantLoss(0, 250e-9), ConstantLoss(0, 100e-12)),
    "surface": (SkinEffect(0, 3e-4) + ConstantLoss(0, 250e-9), ConstantLoss(1e-3, 100e-12)),
    "wire": (RoundWire(0.1e-3, 5.8e7) + ConstantLoss(0, 250e-9), DielectricLoss(100e-12, 0.02, 1e9, (1e4, 1e12))),
    "heavy": (SkinEffect(5000, 1e-2) + ConstantLoss(0, 250e-9), ConstantLoss(0, 100e-12)),
    "earth": (EarthReturn(10, 1000) + ConstantLoss(0, 1.5e-6), ConstantLoss(0, 7.4e-12)),
    "pipe": (WATER, ConstantLoss(0, 1 / (WATER.storage * 1000**2))),
}


def line_of(name: str) -> tuple[LossyLine, float, float]:
    """With the impedance and the delay of a front."""
    line = LossyLine(*LINES[name], LENGTH)
    inductance, capacitance = line.series.storage, line.shunt.storage
    return line, float(np.sqrt(inductance / capacitance)), LENGTH * float(np.sqrt(inductance * capacitance))


@settings(deadline=None, max_examples=15)
@given(
    name=some.sampled_from(sorted(LINES)),
    s=some.integers(1, 8),
    delay=some.floats(0.3, 40.0),
    moved=some.booleans(),
    seed=some.integers(0, 10**6),
)
def test_no_energy_comes_of_a_line(name, s, delay, moved, seed):
    """Of random polynomials on 60 slabs, summed up to every slab; waves moved by whole slabs, or by exp(-sT) alone."""
    (line, z0, T), order, n = line_of(name), basis(s), 60
    rule, slabs = Quadrature(order, T / delay, n), floor(delay) * moved
    into = np.random.default_rng(seed).normal(size=(n, s, 2))
    across, back = carried(line, z0, rule.points, slabs * rule.late)
    waves = rule.forward(into)
    out = rule.backward(across[:, None] * waves[:, ::-1] + back[:, None] * waves)
    power = np.einsum("nik,i->n", into**2 - out**2, order.A[-1])
    assert np.cumsum(power).min() > -1e-9 * (into**2).sum()


@pytest.mark.parametrize("name", sorted(LINES))
@pytest.mark.parametrize("s", [1, 2, 3, 5, 8])
def test_the_norm_of_a_line_is_at_most_one(name, s):
    line, z0, T = line_of(name)
    for delay in (1.0, 2.7, 16.0, 333.3, 5000.0):
        for slabs in (0.0, float(floor(delay))):
            assert gain(line, z0, basis(s), T / delay, slabs) <= 1 + 1e-9


def test_a_line_that_feeds_waves_would_be_found():
    """A negative resistance, which no scene can have, makes the norm larger than one."""
    line, z0, T = line_of("skin")
    line.series.laws[0].beyond = lambda s, arithmetic: 0 * s - 5.0
    assert gain(line, z0, basis(4), T / 16, 16.0) > 1.001


@pytest.mark.parametrize("name", ["two_clamps", "tree_with_clamps", "breaker_beside_rg58", "lightning_and_arrester"])
@pytest.mark.parametrize(("s", "slabs"), [(1, 1.7), (3, 7.3), (5, 40.0)])
def test_a_rest_gives_laws_no_more_than_it_took(name, s, slabs):
    """Of random waves from all laws over 40 slabs, summed up to every slab; and at once: the norm of S_0."""
    description = describe(SCENES[name]())
    rest, order, n = LinearRest(description), basis(s), 40
    rule = Quadrature(order, min(line.delay for line in description.lines.values()) / slabs, n)
    lines = [*description.lines.values()]
    whole = np.array([floor(line.delay / rule.h) for line in lines])
    nowhere, nothing, at = np.empty(0, int), np.zeros((len(rule.points), 0, 0)), rule.points * rest.second
    _, from_laws = rest.efforts(at, nowhere, nothing, nothing, rest.admittances(at, np.outer(rule.late, whole)))
    weights = rule.weights(2 * rest.ports @ from_laws - np.eye(len(rest.laws)))
    share = np.tile(order.A[-1], len(rest.laws)) / np.repeat(rest.impedances, s)
    scale = np.sqrt(share)
    assert np.linalg.norm(weights[0] * scale[:, None] / scale, 2) <= 1 + 1e-9
    sent = np.random.default_rng(s).normal(size=(n, len(share))) / scale
    arrived = np.array([sum(weights[k - j] @ sent[j] for j in range(k + 1)) for k in range(n)])
    assert np.cumsum((share * (sent**2 - arrived**2)).sum(axis=1)).min() > -1e-9 * (share * sent**2).sum()


PIPE = {"diameter": 0.5, "wave_speed": 1000, "density": 1000}


def closed(strength: float, delays) -> Scene:
    """A star of pipes from a reservoir, other ends shut; friction is that many times Joukowsky's rise at 1 m/s."""
    friction = {"kind": "darcy", "factor": strength}
    lines = {
        f"pipe{k}": PIPE | {"nodes": ["joint", f"end{k}"], "length": 1000.0 * d, "friction": friction}
        for k, d in enumerate(delays)
    }
    source = {"at": "end0", "kind": "pressure", "value": 0, "resistance": 0}
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


ANY, WHOLE = (1.0, 1.3, 2**0.5), (1.0, 2.0, 3.0)  # delays over the width of a slab
SHORT = [*product([1, 2, 3, 5, 8], [1e-6, 0.1, 10.0], [WHOLE, ANY], [500]), *product([4, 6, 7], [10.0], [ANY], [500])]
LONG = [(1, 10.0, WHOLE, 100_000), (2, 1e-6, ANY, 100_000)]


@pytest.mark.parametrize(("order", "strength", "delays", "slabs"), SHORT + LONG)
def test_energy_only_falls(order, strength, delays, slabs):
    """From one part of the run to the next, by the energy at that time."""
    assembly = assemble(describe(closed(strength, delays)), set(), Resolution(order, 1.0, diamonds=True))
    rng, flow = np.random.default_rng(order), assembly.lines["pipe0"].z0 * np.pi * 0.25**2
    assembly.state.waves[:] = rng.normal(size=assembly.state.waves.shape) * flow
    assembly.state.before[:] = rng.normal(size=assembly.state.before.shape) * flow
    kernel, last, part = Kernel(assembly.network, assembly.state), energy(assembly), slabs // 10
    for _ in range(10):
        excitation = np.zeros((len(assembly.excitations), part * order))
        assert kernel.blocks(part, excitation, np.zeros((2, 2, 0)), 0) < 0
        now = energy(assembly)
        assert now < last
        last = now
