"""Curves between slab ends: dense, two-sided at jumps; corners and turns of polynomials that are known by hand."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from one_line import one_line

from tline.solver.convolution.families import summed
from tline.solver.convolution.layers import corners_of
from tline.solver.description.description import describe
from tline.solver.radau import basis
from tline.solver.result.dense_output import curve, search
from tline.solver.result.result import Result
from tline.solver.result.wave import Pieces, Wave
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.solver.tolerance.kinks import Cuts

Z0, DELAY = 50.0, 5e-9


def cable(value: dict[str, Any], **solver: Any) -> Result:
    """A cable from 50 ohm into 150 ohm: nothing comes back a second time, and the far end sees 3/4 of the source."""
    probes = {"near": {"at": "near"}, "far": {"at": "far"}, "third": {"line": "line", "position": "30 %"}}
    scene = one_line("20 ns", {"z0": Z0, "delay": DELAY}, value, Z0, 3 * Z0, solver=solver, probes=probes)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        return simulate(scene)


def test_both_sides_of_a_jump_are_there() -> None:
    result = cable({"shape": "step", "to": "1 V", "at": "2 ns"}, slab="0.5 ns")
    for name, instant, after in (("near", 2e-9, 0.5), ("far", 7e-9, 0.75), ("third", 3.5e-9, 0.5)):
        seen = curve(result.probes[name])
        here = np.abs(seen.t - instant) < 1e-18
        assert here.sum() == 2
        np.testing.assert_allclose(seen.u[here], [0.0, after], atol=1e-12)  # rounding
        assert np.all(np.diff(seen.t) >= 0)


def test_a_smooth_wave_is_followed_inside_slabs() -> None:
    result = cable({"shape": "sine", "amplitude": "1 V", "frequency": "200 MHz"}, slab="0.5 ns", order=8)
    for name, delay in (("near", 0.0), ("third", 0.3 * DELAY)):
        seen = curve(result.probes[name])
        early = seen.t < 2 * DELAY - delay  # before the reflection
        expected = 0.5 * np.sin(2 * np.pi * 200e6 * np.maximum(seen.t - delay, 0.0))
        assert early.sum() > 1000
        # a tenth of a period a slab: interpolation errs by 0.63^8/8!/2^15 = 2e-11, edges taken 1e-8 slabs late by 6e-9
        np.testing.assert_allclose(seen.u[early], expected[early], atol=1e-8)


@pytest.mark.parametrize("order", [1, 2, 5, 8])
@pytest.mark.parametrize("at", [2.1e-9, 2.27e-9, 2.4e-9])
def test_a_jump_inside_a_slab_is_a_jump(order: int, at: float) -> None:
    """Both sides at its instant, and no value between; 1e-9 for rounding."""
    result = cable({"shape": "step", "to": "1 V", "at": at}, slab="0.5 ns", order=order)
    assert result.notes == ()
    for name, instant, after in (("near", at, 0.5), ("far", at + DELAY, 0.75), ("third", at + 0.3 * DELAY, 0.5)):
        seen = curve(result.probes[name])
        here = np.abs(seen.t - instant) < 1e-18
        np.testing.assert_allclose(seen.u[here], [0.0, after], atol=1e-9)
        np.testing.assert_allclose(seen.u[seen.t < instant - 1e-18], 0.0, atol=1e-9)
        early = (seen.t > instant + 1e-18) & (seen.t < at + 1.5 * DELAY)
        np.testing.assert_allclose(seen.u[early], after, atol=1e-9)
        assert np.all(np.diff(seen.t) >= 0)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_a_front_that_is_not_followed_is_a_straight_line(order: int) -> None:
    result = cable({"shape": "step", "to": "1 V", "at": "2.27 ns"}, slab="0.5 ns", order=order)
    probe = result.probes["far"]
    record = probe.record
    kept = {name: getattr(record, name) for name in ("a1", "b1", "a2", "b2")}
    lost = {name: replace(wave, values=projected(wave), pieces=no_pieces(order)) for name, wave in kept.items()}
    seen = curve(replace(probe, record=replace(record, **lost, smeared=True)))
    assert seen.u.max() <= 0.75 + 1e-9  # no overshoot; 1e-9 for rounding
    assert seen.u.min() >= -1e-9
    between = (seen.u > 1e-9) & (seen.u < 0.75 - 1e-9)
    assert between.any()
    assert np.ptp(seen.t[between]) <= 0.5e-9  # within one slab


def no_pieces(order: int) -> Pieces:
    return Pieces(np.empty(0, int), np.empty((0, 2)), np.empty((0, order)))


def projected(wave: Wave) -> np.ndarray:
    """Values with the slabs in pieces projected."""
    values = wave.values.copy()
    values[wave.pieces.slab] = 0.0
    for slab, (start, stop), own in zip(*wave.pieces, strict=True):
        values[slab] += wave.basis.projection(start, stop) @ own
    return values


def test_oscillations_too_fast_for_the_slabs_are_not_hidden() -> None:
    result = cable({"shape": "sine", "amplitude": "1 V", "frequency": "3 GHz"}, slab="0.5 ns", order=3)
    seen, probe = curve(result.probes["near"]), result.probes["near"]
    inside = np.abs(seen.t / 0.5e-9 % 1 - 0.5) < 0.4
    np.testing.assert_allclose(seen.u[inside], probe.at(seen.t[inside]).u, atol=1e-13)  # rounding


def test_order_one_is_a_staircase() -> None:
    result = cable({"shape": "step", "to": "1 V", "at": "2 ns"}, slab="0.5 ns", order=1)
    assert set(curve(result.probes["far"]).u.round(12)) == {0.0, 0.75}


def test_extremes_are_the_first_of_a_plateau() -> None:
    edges, flat = np.arange(6.0), np.array([1.0, 1.0 + 1e-15, -2.0, -2.0 - 1e-15, 0.0])
    low, high = search(0.0, edges, flat[:, None], basis(1))
    assert (low, high) == ((pytest.approx(-2.0), 2.0), (pytest.approx(1.0), 0.0))
    assert search(0.0, edges, 0.0 * flat[:, None], basis(1)) == ((0.0, 0.0), (0.0, 0.0))


ORDER, N = basis(5), 12
PLACES = np.arange(N)[:, None] + ORDER.c


def bent(t):
    """Two waves with one corner, in the sixth slab."""
    return np.stack([np.where(t < 5.37, t**2, t**2 + (t - 5.37) * (3 - t)), np.where(t < 5.37, t, 10.74 - t)])


def test_a_corner_is_found_where_two_polynomials_meet():
    found = corners_of(bent(PLACES), 1e-6, ORDER)
    assert found.slab.tolist() == [5]
    assert found.at[0] == pytest.approx(0.37, abs=1e-3)
    np.testing.assert_allclose(found.before[:, 0], np.stack([PLACES[5] ** 2, PLACES[5]]), rtol=1e-10)
    np.testing.assert_allclose(found.behind[1, 0], 10.74 - PLACES[5], rtol=1e-10)


def test_smooth_waves_and_jumps_have_no_corner():
    assert not len(corners_of(np.sin(PLACES)[None] / 10, 1e-6, ORDER).slab)
    assert not len(corners_of(np.where(PLACES < 5.37, 0.0, 1.0)[None], 1e-6, ORDER).slab)


@pytest.mark.parametrize("least", [0.0, 1e-5])
def test_records_on_two_grids_add_up(least):
    """A smooth wave on the scene's slabs, and one that bends at 4.7, on slabs that begin 0.3 of one earlier."""
    late = np.arange(N + 1)[:, None] + ORDER.c - 0.3

    def wave(t):
        return np.exp(-t / 3) + np.maximum(t - 4.7, 0.0) ** 2

    records = [np.sin(PLACES / 3).reshape(1, 1, -1).repeat(2, 1), wave(late).reshape(1, 1, -1).repeat(2, 1)]
    whole, noted = summed(iter(records), np.array([0.0, 0.3]), N, ORDER, least)
    assert len(np.unique(noted.slab)) == (1 if least else N)
    error = whole[0, 0].reshape(N, -1) - np.sin(PLACES / 3) - wave(PLACES)
    assert np.abs(error).max() < max(least, 1e-5)
    place = noted.slab[:, None] + noted.span[:, :1] + np.diff(noted.span) * ORDER.c
    np.testing.assert_allclose(noted.values[:, 0], np.sin(place / 3) + wave(place), atol=1e-5)


FREQUENCY = 0.6  # Hz


def test_turns_are_those_of_a_sine():
    """In a matched pipe with next to no friction the flow follows the sine: at once, and 1 s later at the far end."""
    pipe = {"length": 1000, "radius": 0.0265, "wave_speed": 1000, "density": 900}
    pipe |= {"friction": {"kind": "darcy", "factor": 1e-9}}
    sine, solver = {"shape": "sine", "amplitude": 2e5, "frequency": FREQUENCY}, {"order": 4, "slab": 1 / 32}
    scene = one_line(2.5, pipe, sine, 0, {"kind": "matched"}, medium="hydraulic", solver=solver)
    result = simulate(scene)
    cuts = Cuts(describe(scene)).turns(result)
    half = 0.5 / FREQUENCY
    assert cuts["nodes.near"] == pytest.approx([half, 2 * half], abs=1e-4)  # as well as slabs of 1/32 resolve it
    assert cuts["nodes.far"] == pytest.approx([1 + half], abs=1e-4)
