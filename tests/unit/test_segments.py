"""Segments of lossy lines: they dissipate, are their own mirror image, and are a mere delay where nothing is lost."""

import numpy as np
import pytest
from scipy.linalg import expm

from tline.loss import Foster
from tline.solver.assembly.lossy_segments import SegmentedLine, segment
from tline.solver.radau import basis

LOSSLESS = Foster(0, 1, [], [])


def circuit(seed: int, terms: int, size: float) -> Foster:
    random = np.random.default_rng(seed)
    strengths, rates_ = 10 ** random.uniform(-1.5, 0.5, terms), 10 ** random.uniform(-1, 1.5, terms)
    return Foster(size * random.random(), 1.0, size * strengths, rates_)


def whole(made) -> np.ndarray:
    """From (what a segment holds, what enters) to (what it holds then, what has left)."""
    nothing = np.zeros_like(made.back)
    at_once = np.block([[nothing, made.back], [made.back, nothing]])
    return np.block([[made.held, made.entered], [made.left, at_once]])


@pytest.mark.parametrize("s", [1, 2, 5, 8])
@pytest.mark.parametrize(("in_series", "across"), [(0, 0), (3, 0), (2, 3)])
def test_a_segment_creates_no_energy(s, in_series, across):
    """Stored are a²/4 + b²/4 + Σ r w²/(2 p) + Σ g q²/(2 p) over x, passed a²/4 or b²/4 over t; the norm is in these."""
    series, shunt = circuit(s, in_series, 0.3), circuit(s + 100, across, 0.1)
    made = segment(series, shunt, 1.0, s)
    weights = np.concatenate(
        [[0.25, 0.25], series.strengths / series.rates / 2, shunt.strengths / shunt.rates / 2, [0.25, 0.25]]
    )
    order = basis(s)
    gram = order.to_legendre.T @ np.diag(1 / (2 * np.arange(s) + 1)) @ order.to_legendre
    root = np.linalg.cholesky(np.kron(np.diag(weights), gram)).T
    assert np.linalg.norm(root @ whole(made) @ np.linalg.inv(root), 2) < 1 + 1e-12


def test_a_segment_of_a_lossless_line_hands_on_what_it_holds():
    s = 4
    made = segment(LOSSLESS, LOSSLESS, 1.0, s)
    mirror = basis(s).evaluation(1 - basis(s).c)  # from values over x to values over t of what leaves at the right
    nothing = np.zeros((s, s))
    assert np.allclose(made.left, np.block([[mirror, nothing], [nothing, np.eye(s)]]), atol=1e-12)
    assert np.allclose(made.entered, np.block([[mirror, nothing], [nothing, np.eye(s)]]), atol=1e-12)
    assert np.allclose(made.held, 0, atol=1e-12)
    assert np.allclose(made.back, 0, atol=1e-12)


def test_without_distortion_a_wave_is_only_attenuated():
    """exp(-t/10): a and b do not meet."""
    s = 9
    made = segment(Foster(0.1, 1, [], []), Foster(0.1, 1, [], []), 1.0, s)
    passed = np.block([made.left[:s, :s]]) @ made.entered[:s, :s] @ np.ones(s)
    assert passed == pytest.approx(np.exp(-0.1), abs=1e-12)
    assert np.allclose(made.back, 0, atol=1e-12)


def test_a_segment_is_its_own_mirror_image():
    s = 4
    made = segment(circuit(1, 2, 0.3), circuit(2, 1, 0.2), 1.0, s)
    flip = basis(s).evaluation(1 - basis(s).c)
    swap = np.array([[0, 1], [1, 0]])
    signs = np.diag([-1, -1, 1])  # flows turn round, efforts do not
    over_x = np.kron(np.block([[swap, np.zeros((2, 3))], [np.zeros((3, 2)), signs]]), flip)
    over_t = np.kron(swap, np.eye(s))
    assert np.allclose(over_x @ made.held @ over_x, made.held, atol=1e-11)
    assert np.allclose(over_x @ made.entered @ over_t, made.entered, atol=1e-11)
    assert np.allclose(over_t @ made.left @ over_x, made.left, atol=1e-11)


def lattice(series: Foster, shunt: Foster, s: int, N: int) -> np.ndarray:
    """The same to second order: N steps of travel by 1/N, with half a step without travel before and after each."""
    r, p, g, q = series.strengths, series.rates, shunt.strengths, shunt.rates
    n, order = 2 + len(p) + len(q), basis(s)
    u, v = np.eye(2, n)[0] / 2 + np.eye(2, n)[1] / 2, np.eye(2, n)[0] / 2 - np.eye(2, n)[1] / 2
    w, other = np.eye(n)[2 : 2 + len(p)], np.eye(n)[2 + len(p) :]
    v_t, u_t = r @ (w - v) - series.loss * v, g @ (other - u) - shunt.loss * u
    equations = np.vstack([u_t + v_t, u_t - v_t, p[:, None] * (v - w), q[:, None] * (u - other)])
    x = (np.arange(N) + 0.5) / N
    values, moments = order.evaluation(x), order.moments(x, np.full(N, 1 / N))
    given = np.kron(np.eye(n + 2), values).reshape(n + 2, N, -1)
    fields, entering, leaving = given[:n], given[n:], np.empty((2, N, (n + 2) * s))
    half = expm(equations / (2 * N))
    for k in range(N):
        fields = np.einsum("ij,jkc->ikc", half, fields)
        leaving[0, k], leaving[1, k] = fields[0, -1], fields[1, 0]
        fields[0, 1:], fields[1, :-1] = fields[0, :-1].copy(), fields[1, 1:].copy()
        fields[0, 0], fields[1, -1] = entering[0, k], entering[1, k]
        fields = np.einsum("ij,jkc->ikc", half, fields)
    return np.concatenate([moments @ fields, moments @ leaving]).reshape((n + 2) * s, -1)


@pytest.mark.parametrize("s", [1, 3, 5])
def test_lattices_converge_to_a_segment(s):
    """Their error is a series in 1/N^2."""
    series, shunt = Foster(0.1, 1, [0.5, 2.0], [3.0, 30.0]), Foster(0.05, 1, [0.3], [2.0])
    coarse, fine, finest = (lattice(series, shunt, s, N) for N in (64, 128, 256))
    made = whole(segment(series, shunt, 1.0, s))
    assert np.abs(fine - made).max() == pytest.approx(np.abs(coarse - made).max() / 4, rel=0.2)
    better = [(4 * b - a) / 3 for a, b in ((coarse, fine), (fine, finest))]
    assert np.abs((16 * better[1] - better[0]) / 15 - made).max() < 2e-8


def test_a_memory_too_short_to_matter_is_as_none():
    """r s/(s + p) adds r/p to the storage, at most; what a stiff circuit changes falls with 1/p."""
    without = whole(segment(Foster(0.1, 1, [], []), LOSSLESS, 1.0, 4))
    rest = np.r_[:8, 12:20]  # without the memory
    off = [
        np.abs(whole(segment(Foster(0.1, 1, [1.0], [p]), LOSSLESS, 1.0, 4))[np.ix_(rest, rest)] - without).max()
        for p in (1e7, 1e9)
    ]
    assert off[1] < 2e-8
    assert off[0] == pytest.approx(100 * off[1], rel=0.01)


def test_an_echo_is_what_an_end_sends_into_itself():
    """w = y + K (2u - w) means w = ŷ + 2 Q u."""
    made = SegmentedLine(3, segment(circuit(3, 1, 0.4), LOSSLESS, 1.0, 3), (1, 0))
    K, Q = made.segment.back, made.echo
    y, u = np.random.default_rng(0).normal(size=(2, 3))
    w = np.linalg.solve(np.eye(3) + K, y + 2 * K @ u)
    assert w == pytest.approx(np.linalg.solve(np.eye(3) + K, y) + 2 * Q @ u, abs=1e-12)
