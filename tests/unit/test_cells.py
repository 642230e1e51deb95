"""Cells of lossy lines: they dissipate, are their own mirror image, and are a mere delay where nothing is lost."""

import numpy as np
import pytest

from tline.loss import Foster
from tline.solver.cells import InCells, cell, rates
from tline.solver.radau import basis

LOSSLESS = Foster(0, 1, [], [])


def circuit(seed: int, terms: int, size: float) -> Foster:
    random = np.random.default_rng(seed)
    strengths, rates_ = 10 ** random.uniform(-1.5, 0.5, terms), 10 ** random.uniform(-1, 1.5, terms)
    return Foster(size * random.random(), 1.0, size * strengths, rates_)


def whole(made) -> np.ndarray:
    """From (what a cell holds, what enters) to (what it holds then, what has left)."""
    nothing = np.zeros_like(made.back)
    at_once = np.block([[nothing, made.back], [made.back, nothing]])
    return np.block([[made.held, made.entered], [made.left, at_once]])


@pytest.mark.parametrize("s", [1, 2, 5, 8])
@pytest.mark.parametrize(("in_series", "across"), [(0, 0), (3, 0), (2, 3)])
def test_a_cell_creates_no_energy(s, in_series, across):
    """Stored are a²/4 + b²/4 + Σ r w²/(2 p) + Σ g q²/(2 p) over x, passed a²/4 or b²/4 over t; the norm is in these."""
    series, shunt = circuit(s, in_series, 0.3), circuit(s + 100, across, 0.1)
    made = cell(rates(series, shunt, 1.0), s)
    weights = np.concatenate(
        [[0.25, 0.25], series.strengths / series.rates / 2, shunt.strengths / shunt.rates / 2, [0.25, 0.25]]
    )
    order = basis(s)
    gram = order.to_legendre.T @ np.diag(1 / (2 * np.arange(s) + 1)) @ order.to_legendre
    root = np.linalg.cholesky(np.kron(np.diag(weights), gram)).T
    assert np.linalg.norm(root @ whole(made) @ np.linalg.inv(root), 2) < 1 + 1e-12


def test_a_cell_of_a_lossless_line_hands_on_what_it_holds():
    s = 4
    made = cell(rates(LOSSLESS, LOSSLESS, 1.0), s)
    mirror = basis(s).evaluation(1 - basis(s).c)  # from values over x to values over t of what leaves at the right
    nothing = np.zeros((s, s))
    assert np.allclose(made.left, np.block([[mirror, nothing], [nothing, np.eye(s)]]), atol=1e-12)
    assert np.allclose(made.entered, np.block([[mirror, nothing], [nothing, np.eye(s)]]), atol=1e-12)
    assert np.allclose(made.held, 0, atol=1e-12)
    assert np.allclose(made.back, 0, atol=1e-12)


def test_without_distortion_a_wave_is_only_attenuated():
    """exp(-t/10): a and b do not meet."""
    s = 9
    made = cell(rates(Foster(0.1, 1, [], []), Foster(0.1, 1, [], []), 1.0), s)
    passed = np.block([made.left[:s, :s]]) @ made.entered[:s, :s] @ np.ones(s)
    assert passed == pytest.approx(np.exp(-0.1), abs=1e-12)
    assert np.allclose(made.back, 0, atol=1e-12)


def test_a_cell_is_its_own_mirror_image():
    s = 4
    made = cell(rates(circuit(1, 2, 0.3), circuit(2, 1, 0.2), 1.0), s)
    flip = basis(s).evaluation(1 - basis(s).c)
    swap = np.array([[0, 1], [1, 0]])
    signs = np.diag([-1, -1, 1])  # flows turn round, efforts do not
    over_x = np.kron(np.block([[swap, np.zeros((2, 3))], [np.zeros((3, 2)), signs]]), flip)
    over_t = np.kron(swap, np.eye(s))
    assert np.allclose(over_x @ made.held @ over_x, made.held, atol=1e-11)
    assert np.allclose(over_x @ made.entered @ over_t, made.entered, atol=1e-11)
    assert np.allclose(over_t @ made.left @ over_x, made.left, atol=1e-11)


def test_stiff_circuits_are_found_to_the_digits_asked_for():
    equations = rates(Foster(0.1, 1, [0.5, 2.0], [3.0, 200.0]), LOSSLESS, 1.0)
    close, closer = (whole(cell(equations, 3, digits)) for digits in (1e-7, 1e-12))
    assert np.abs(close - closer).max() < 1e-7


def test_an_echo_is_what_an_end_sends_into_itself():
    """w = y + K (2u - w) means w = ŷ + 2 Q u."""
    made = InCells(3, cell(rates(circuit(3, 1, 0.4), LOSSLESS, 1.0), 3), (1, 0))
    K, Q = made.cell.back, made.echo
    y, u = np.random.default_rng(0).normal(size=(2, 3))
    w = np.linalg.solve(np.eye(3) + K, y + 2 * K @ u)
    assert w == pytest.approx(np.linalg.solve(np.eye(3) + K, y) + 2 * Q @ u, abs=1e-12)
