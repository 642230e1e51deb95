"""Measured loads and multiports that were proved passive never add energy, whatever was fitted."""

import re
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from energy import on_lines, silent
from hypothesis import given, settings, strategies as st
from touchstone_files import FILTER, SHIPPED, frequencies, stretch, write, write_ports

import tline.scene.touchstone as touchstone
from passivity import (
    DelayedModel,
    PoleResidueModel,
    SampledResponse,
    Status,
    check_samples,
    enforce,
    fit,
    fit_scattering,
)
from tline import SceneError
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


def network(file, **solver):
    """Two lines without common measure, open at the other ends."""
    return Scene(
        medium="electrical",
        t_end="50 ns",
        solver=solver,
        lines={
            "one": {"nodes": ["a", "b"], "z0": 50, "delay": "1 ns"},
            "two": {"nodes": ["b", "c"], "z0": 85, "delay": 2**0.5 / 1.3 * 1e-9},
        },
        loads={"measured": {"at": "b", "kind": "touchstone", "file": str(file), "tolerance": 0.1}},
        probes={"p": {"at": "c"}},
    )


def check_never_gains(scene, seed, blocks=60, slabs=50):
    """Loads start at rest and are passive: what is on the lines never exceeds what was there at first."""
    assembly = silent(scene, seed)
    kernel, start = Kernel(assembly.network, assembly.state), on_lines(assembly)
    for _ in range(blocks):
        assert kernel.blocks(slabs, np.zeros((0, 0)), np.zeros((0, 2, 0)), 0) == -1
        assert on_lines(assembly) <= start * (1 + ROUNDING)
    return on_lines(assembly) / start


@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.02, 0.69))
def test_energy_never_grows_beside_an_antenna(seed, order, slab):
    left = check_never_gains(network(SHIPPED, order=order, slab=slab * 1e-9), seed)
    assert left < 0.1  # it radiates


@pytest.mark.parametrize(("order", "end"), [(k, (-1.0) ** (k // 4)) for k in range(4, 25, 4)])
def test_fits_of_a_plain_line_are_proved_or_refused(order, end, tmp_path, monkeypatch):
    """1 ns of 50 ohm, shorted or open, fitted without taking out its delay: |S| = 1, so every ripple is forbidden."""
    f = frequencies(order / 8 * 1e9, 100)
    samples = SampledResponse(f, end * np.exp(-4j * np.pi * f * 1e-9), "S")
    write(tmp_path / "line.s1p", f, samples.values[:, 0, 0])
    model = fit(samples, order)
    given = DelayedModel(0.0, model, model, samples)
    nearest = DelayedModel(0.0, enforce(model, samples).model, model, samples)
    for found in (given, nearest):
        monkeypatch.setattr("passivity.fit_scattering", lambda *_, found=found: found)
        touchstone.model_of.cache_clear()
        if found.verdict.status is Status.PROVED:
            check_never_gains(network(tmp_path / "line.s1p", order=4, slab="0.11 ns"), order)
        else:
            with pytest.raises(SceneError, match=re.escape("not proved passive: |S| > 1 ")):
                network(tmp_path / "line.s1p")
    touchstone.model_of.cache_clear()


@settings(max_examples=3, deadline=None)
@given(delay=st.floats(0.2, 3.0), end=st.sampled_from([-1.0, 1.0, 0.5]))
def test_a_plain_line_is_its_delay(delay, end):
    f = frequencies(2e9, 100)
    response = SampledResponse(f, end * np.exp(-4j * np.pi * f * delay * 1e-9), "S")
    assert check_samples(response).status is not Status.REFUTED
    found = fit_scattering(response, 1e-6, nearest=True)
    assert found.order == 0
    assert found.delay == pytest.approx(delay * 1e-9, abs=1e-17)
