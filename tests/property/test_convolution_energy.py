"""A line by convolution quadrature gives no more energy than it has taken, whatever comes to its ends."""

from math import floor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from remembering_scenes import SCENES

from tline.loss import ConstantLoss, DielectricLoss, EarthReturn, LaminarFriction, LossyLine, RoundWire, SkinEffect
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature, gain
from tline.solver.description.description import describe
from tline.solver.radau import basis
from tline.solver.stability.scattering import carried

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
    found = rest.efforts(at, nowhere, nothing, nothing, rest.admittances(at, np.outer(rule.late, whole)))
    weights = rule.weights(2 * rest.ports @ found.from_laws - np.eye(len(rest.laws)))
    share = np.tile(order.A[-1], len(rest.laws)) / np.repeat(rest.impedances, s)
    scale = np.sqrt(share)
    assert np.linalg.norm(weights[0] * scale[:, None] / scale, 2) <= 1 + 1e-9
    sent = np.random.default_rng(s).normal(size=(n, len(share))) / scale
    arrived = np.array([sum(weights[k - j] @ sent[j] for j in range(k + 1)) for k in range(n)])
    assert np.cumsum((share * (sent**2 - arrived**2)).sum(axis=1)).min() > -1e-9 * (share * sent**2).sum()
