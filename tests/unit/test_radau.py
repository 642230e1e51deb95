"""The matrices of the slab basis do to polynomials what they say; a state space of poles is the function fitted."""

import numpy as np
import pytest

from passivity import PoleResidueModel
from tline.solver.description.circuit import reflection_of_poles
from tline.solver.radau import basis, gauss

ORDERS = range(1, 17)
EPS = 1e-12  # condition numbers of the bases are below 10


def polynomial(s: int, seed: int = 0) -> np.polynomial.Polynomial:
    return np.polynomial.Polynomial(np.random.default_rng(seed).normal(size=s))


def test_points_of_low_order():
    assert basis(1).c == pytest.approx([1.0])
    assert basis(2).c == pytest.approx([1 / 3, 1.0], abs=1e-15)
    assert basis(3).c == pytest.approx([(4 - 6**0.5) / 10, (4 + 6**0.5) / 10, 1.0], abs=1e-15)


def test_radau_iia_of_order_two_stages():
    """Hairer and Wanner II, table IV.5.5."""
    assert pytest.approx(np.array([[5, -1], [9, 3]]) / 12, abs=1e-15) == basis(2).A


@pytest.mark.parametrize("s", ORDERS)
def test_collocation_integrates_polynomials_exactly(s):
    p, order = polynomial(s), basis(s)
    assert order.A @ p(order.c) == pytest.approx(p.integ()(order.c), abs=EPS)


@pytest.mark.parametrize("s", ORDERS)
def test_evaluation_and_restriction(s):
    p, order, x = polynomial(s), basis(s), np.linspace(0, 1, 7)
    assert order.evaluation(x) @ p(order.c) == pytest.approx(p(x), abs=EPS)
    assert order.restriction(0.3, 0.7) @ p(order.c) == pytest.approx(p(0.3 + 0.4 * order.c), abs=EPS)


@pytest.mark.parametrize("s", ORDERS)
def test_projection_of_a_piece_has_the_moments_of_the_piece(s):
    p, order = polynomial(s), basis(s)
    projected = order.projection(0.2, 0.9) @ p(0.2 + 0.7 * order.c)
    x, weights = gauss(s)
    for m in range(s):
        moment = weights @ ((order.evaluation(x) @ projected) * x**m)
        primitive = (p * np.polynomial.Polynomial.basis(m)).integ()
        assert moment == pytest.approx(primitive(0.9) - primitive(0.2), abs=EPS)


@pytest.mark.parametrize("s", ORDERS)
@pytest.mark.parametrize("f", [1e-9, 0.37, 1 - 1e-9])
def test_a_delayed_polynomial_stays_itself(s, f):
    """One polynomial over both slabs is delayed without error."""
    p, order = polynomial(s), basis(s)
    now, before = order.shift(f)
    assert now @ p(order.c) + before @ p(order.c - 1) == pytest.approx(p(order.c - f), abs=1e-11)


@pytest.mark.parametrize("s", range(1, 9))
@pytest.mark.parametrize("f", [0.01, 0.37, 0.5, 0.99])
def test_delay_adds_no_energy(s, f):
    """In the norm of L2 the two matrices, with what they leave for the next slab, never exceed 1."""
    order = basis(s)
    weight = order.to_legendre.T @ np.diag(1 / (2 * np.arange(s) + 1)) @ order.to_legendre
    root = np.linalg.cholesky(weight).T
    now, before = order.shift(f)
    late = np.sqrt(f) * root @ order.restriction(1 - f, 1.0) @ np.linalg.inv(root)
    incoming = np.hstack([root @ now @ np.linalg.inv(root), root @ before @ np.linalg.inv(root)])
    kept = np.hstack([late, np.zeros((s, s))])  # of this slab, delivered with the next
    owed = np.hstack([np.zeros((s, s)), late])  # of the slab before, delivered with this one
    whole = np.hstack([np.eye(s), np.zeros((s, s))])
    gain = incoming.T @ incoming + kept.T @ kept - owed.T @ owed - whole.T @ whole
    assert np.linalg.eigvalsh(gain).max() < EPS


W = np.linspace(0, 10, 21)


@pytest.mark.parametrize("ratio", [1.0, 0.2, 30.0])
@pytest.mark.parametrize("constant", [0.3, -1.0, 1.0])
def test_reflection_against_another_impedance(ratio, constant):
    model = PoleResidueModel([-2, -1 + 3j, -0.5], [-0.4 * constant, (0.2 - 0.1j) * constant, 0.0], constant, 0, "S")
    A, b, c, d = reflection_of_poles(model, ratio)
    assert A.shape == (4, 4)
    seen = np.array([(c @ np.linalg.solve(1j * w * np.eye(4) - A, b) + d)[0, 0] for w in W])
    S = model.at(W)
    # (Z - z)/(Z + z) of Z = z0 (1 + S)/(1 - S) and ratio = z0/z
    expected = (ratio * (1 + S) - (1 - S)) / (ratio * (1 + S) + (1 - S))
    assert np.abs(seen - expected).max() < 1e-14
