"""Decks of coupled conductors against their matrix exponential by damped FFT, where ngspice is off itself."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from tline.interchange.spice import read_spice
from tline.solver.simulate import simulate

DECKS, SAMPLES = Path(__file__).parent.parent / "decks", 1 << 12
NS = 1e-9


def near(diagonal: float, beside: float, size: int) -> np.ndarray:
    """A matrix of equal conductors, each coupled with its neighbours."""
    return diagonal * np.eye(size) + beside * (np.eye(size, k=1) + np.eye(size, k=-1))


def exact(R, L, C, length, near_end, far_end, corners, t_end) -> tuple[np.ndarray, np.ndarray]:
    """Instants and voltages at both ends, the first conductor driven; what wraps around is exp(-12) of itself."""
    size, period, damping = len(L), 2 * t_end, 6 / t_end
    s = damping + 2j * np.pi * np.fft.rfftfreq(SAMPLES, period / SAMPLES)
    slopes = np.diff([0, *(np.diff([u for _, u in corners]) / np.diff([t for t, _ in corners])), 0])
    source = sum(k * np.exp(-s * t) for k, (t, _) in zip(slopes, corners, strict=True)) / s**2
    zero = np.zeros((len(s), size, size))
    matrix = np.concatenate([np.concatenate([zero, -(R + s[:, None, None] * L)], 2),
                             np.concatenate([-s[:, None, None] * C, zero], 2)], 1)  # fmt: skip
    chain = expm(matrix * length)  # of the near end's voltages and currents to the far end's
    G0, G1 = np.diag(1 / near_end), np.diag(1 / far_end)
    driven = G0[:, :1]  # current into the near end: G0 (e - u)
    A, B, D, E = chain[:, :size, :size], chain[:, :size, size:], chain[:, size:, :size], chain[:, size:, size:]
    u = np.linalg.solve(D - E @ G0 - G1 @ (A - B @ G0), (G1 @ B - E) @ driven)
    u = np.concatenate([u, (A - B @ G0) @ u + B @ driven], 1)[:, :, 0] * source[:, None]
    t = np.arange(SAMPLES) * period / SAMPLES
    taper = np.cos(np.linspace(0, np.pi / 2, len(s)))[:, None] ** 2
    return t, np.fft.irfft(u * taper, axis=0) * SAMPLES / period * np.exp(damping * t)[:, None]


def test_the_reference_is_a_matched_line_where_there_is_one():
    t, u = exact(0 * np.eye(1), 2.5e-7 * np.eye(1), 1e-10 * np.eye(1), 0.4, np.array([50.0]), np.array([50.0]),
                 [(0, 0), (1 * NS, 1)], 10 * NS)  # fmt: skip
    assert np.abs(u - 0.5 * np.clip(t[:, None] / NS - [0, 2], 0, 1))[t < 9 * NS].max() < 2e-3


PULSE = [(0, 0), (1.5 * NS, 1), (6 * NS, 1), (7.5 * NS, 0)]
STEPS = [(3 * NS, 0), (3.5 * NS, 4), (12 * NS, 4), (12.5 * NS, 0)]


@pytest.mark.parametrize(
    ("deck", "line", "ends", "corners"),
    [
        ("cpl_pair", (near(0.5, 0, 2), near(250e-9, 30e-9, 2), near(32e-12, -2.5e-12, 2), 0.3),
         ([50.0, 10.0], [100.0, 100.0]), PULSE),
        ("cpl_four", (near(0.3, 0, 4), near(9e-9, 5e-9, 4), near(3.5e-13, -3e-14, 4), 6),
         ([1e3] * 4, [1e6] * 4), STEPS),
    ],
)  # fmt: skip
def test_a_deck_of_coupled_conductors(deck, line, ends, corners):
    scene, _ = read_spice(DECKS / f"{deck}.cir")
    size = len(ends[0])
    nodes = ("a1", "a2", "b1", "b2") if size == 2 else tuple("2345") + tuple("6789")
    seen = simulate(scene.with_changes(probes={at: {"at": at} for at in nodes}), tol=1e-3)
    t, u = exact(*line, *map(np.array, ends), corners, float(scene.t_end))
    inside = t < 0.9 * float(scene.t_end)
    ours = np.array([seen.probes[at].at(t[inside]).u for at in nodes]).T
    assert np.abs(ours - u[inside]).max() < 2e-3 * max(level for _, level in corners)
