"""Time and frequency answers agree: the Laplace integral of a run is the transfer function times that of its source."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_multiports import multiport_scenes
from random_scenes import random_scene

from tline import Scene, simulate
from tline.frequency.response import respond
from tline.solver.radau import gauss

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
DAMPING, T_END = 0.5, 60.0  # e^(-30) of what comes after the run counts
FREQUENCIES = np.array([0.0, 0.05, 0.13, 0.2, 0.31])


def transform(result, values_at, s):
    """Integral of values exp(-st) over the run, piece by piece."""
    probe, (x, weights) = result.probes["p"], gauss(12)
    a1, b2, way = probe.record.a1.breakpoints(), probe.record.b2.breakpoints(), probe.record.delay * probe.share
    edges = np.sort(np.concatenate([result.t, result.t + way, a1 + way, result.t - way, b2 + probe.record.delay - way]))
    edges = np.unique(edges[(edges >= 0) & (edges <= result.t[-1])])
    width = np.diff(edges)[:, None]
    t = edges[:-1, None] + width * x
    values = values_at(t)
    return np.array([(values * np.exp(-z * t) * weights * width).sum() for z in s])


@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_they_agree(seed):
    scene = random_scene(seed, sources=True, switches=False, solver={"order": 6, "slab": 0.1})
    agree(Scene(**scene.table() | {"t_end": T_END}))


@settings(max_examples=6, deadline=None)
@given(table=multiport_scenes())
def test_they_agree_past_multiports(table):
    sine = {"shape": "sine", "amplitude": 1, "frequency": 0.2, "until": 5.0}
    source = {"at": "e0", "kind": "voltage", "resistance": 0.5, "value": sine}
    loads = {name: load for name, load in table["loads"].items() if name != "e0"}
    agree(
        Scene(**table | {"t_end": T_END, "sources": {"s": source}, "loads": loads, "solver": {"order": 7, "slab": 0.1}})
    )


def agree(scene):
    """Of a source that is one period of a sine of 0.2 Hz."""
    result = simulate(scene)
    s = DAMPING + 2j * np.pi * FREQUENCIES
    omega = 2 * np.pi * 0.2
    source = omega * (1 - np.exp(-5 * s)) / (s**2 + omega**2)  # one period of the sine
    expected = respond(scene, s)["p"]
    seen = transform(result, lambda t: result.probes["p"].at(t).u, s)
    assert np.abs(seen - expected.u * source).max() < 1e-8 * np.abs(expected.u * source).max()
    flow = transform(result, lambda t: result.probes["p"].at(t).y, s)
    assert (
        np.abs(flow - expected.y * source).max()
        < 1e-8 * np.abs(expected.u * source).max() / result.lines[result.probes["p"].line].z0
    )
