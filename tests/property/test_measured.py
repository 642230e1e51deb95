"""A network with measured loads never gains energy, whatever was fitted, if it was proved passive."""

import re

import numpy as np
import pytest
from energy import on_lines, silent
from hypothesis import given, settings
from hypothesis import strategies as st
from touchstone_files import SHIPPED, frequencies, write

import tline.scene.touchstone as touchstone
from passivity import DelayedModel, SampledResponse, Status, check_samples, enforce, fit, fit_scattering
from tline import Scene, SceneError
from tline.solver.loop.march import Kernel

ROUNDING = 1e-12  # of the energy at the start; poles of 24 hold S to some 1e-13


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
