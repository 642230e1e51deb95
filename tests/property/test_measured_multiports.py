"""Lines never gain energy from a measured multiport that was proved passive, whatever was fitted."""

from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from energy import on_lines, silent
from hypothesis import given, settings
from hypothesis import strategies as st
from touchstone_files import FILTER, frequencies, stretch, write_ports

from passivity import PoleResidueModel, SampledResponse, Status, fit_scattering
from tline.scene.scene import Scene
from tline.scene.touchstone import MeasuredMultiport
from tline.solver.loop.march import Kernel

ROUNDING = 1e-12  # of the energy at the start


def random_samples(seed: int, ports: int, pairs: int) -> SampledResponse:
    """Of a random model whose largest singular value at the samples is 1."""
    rng, f = np.random.default_rng(seed), frequencies(2e9, 60)
    poles = (-rng.uniform(0.1, 0.5, pairs) + 1j * rng.uniform(0.1, 1, pairs)) * 2e9 * np.pi
    R = rng.normal(size=(2, pairs, ports, ports)) * 1e9
    S = PoleResidueModel(poles, R[0] + 1j * R[1], rng.normal(size=(ports, ports))).at(2 * np.pi * f)
    return SampledResponse(f, S / np.linalg.norm(S, 2, axis=(1, 2)).max(), "S")


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), ports=st.integers(2, 3), pairs=st.integers(1, 3))
def test_changed_models_are_passive(seed, ports, pairs):
    """What is not passive between or beyond the samples is changed until it is, and no further."""
    samples = random_samples(seed, ports, pairs)
    found = fit_scattering(samples, 0.2, nearest=True)
    assert found.verdict.status is Status.PROVED
    assert found.error < 0.2
    w = np.concatenate([[0.0], np.geomspace(1e8, 1e12, 2000)])
    assert np.linalg.norm(found.model.at(w), 2, axis=(1, 2)).max() < 1 + 1e-12
    if found.cost:
        assert found.seen.value == pytest.approx(1, abs=1e-4)


@cache
def block(which: int) -> tuple[MeasuredMultiport, TemporaryDirectory]:
    """The shipped filter, a short line without losses, and random networks of three ports."""
    folder, nodes = TemporaryDirectory(), ["p0", "p1", "p2"][: 2 + (which > 1)]
    file, f = f"{folder.name}/x.s{len(nodes)}p", frequencies(20e9, 100)
    if which == 1:
        write_ports(file, f, stretch(f, 75, 20e-12))
    if which > 1:
        samples = random_samples(which, 3, 2)
        write_ports(file, samples.f, samples.values)
    given = {"nodes": nodes, "file": file if which else str(FILTER), "tolerance": 0.1, "nearest": True}
    return MeasuredMultiport(**given), folder


@settings(max_examples=10, deadline=None)
@given(which=st.integers(0, 4), seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.02, 0.69))
def test_energy_never_grows_beside_a_measured_multiport(which, seed, order, slab):
    """Lines without common measure, open at their other ends; the block is at rest at first."""
    link, _ = block(which)
    lines = {
        at: {"nodes": [f"e{k}", at], "z0": 30 + 40 * k, "delay": (1, 2**0.5 / 1.3, 3**0.5)[k] * 1e-9}
        for k, at in enumerate(link.nodes)
    }
    scene = Scene(
        medium="electrical", t_end="50 ns", lines=lines, links={"x": link}, probes={"p": {"at": "e0"}},
        solver={"order": order, "slab": slab * 1e-9},
    )  # fmt: skip
    assembly = silent(scene, seed)
    kernel, start = Kernel(assembly.network, assembly.state), on_lines(assembly)
    for _ in range(40):
        assert kernel.blocks(1, np.zeros((0, 0)), np.zeros((0, 2, 0)), 0) == -1
        assert on_lines(assembly) <= start * (1 + ROUNDING)
    for _ in range(10):
        assert kernel.blocks(100, np.zeros((0, 0)), np.zeros((0, 2, 0)), 0) == -1
        assert on_lines(assembly) <= start * (1 + ROUNDING)
