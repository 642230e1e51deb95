"""Storage functions of large systems prove no more than the exact test does, and hold when they are verified."""

import numpy as np
import pytest
from flint import fmpq_mat
from hypothesis import given, settings, strategies as st

import passivity
from passivity import Kind, SampledResponse, StateSpace, Status, check_positive_real, fit_scattering, verify
from passivity.floats.axis import analyse
from passivity.floats.storage import proves, strict_storage
from passivity.floats.system import FloatSystem
from passivity.sampled.model import PoleResidueModel
from passivity.verdict import StorageCertificate


def random_model(seed, ports, pairs, size):
    """With a largest singular value of about `size` at the resonances."""
    rng = np.random.default_rng(seed)
    poles = -(10.0 ** rng.uniform(-3, 0, pairs)) + 1j * rng.uniform(0.1, 10, pairs)
    R = (rng.normal(size=(2, pairs, ports, ports)) * -poles.real[:, None, None] / ports) @ np.diag(
        rng.uniform(0.1, 1, ports)
    )
    model = PoleResidueModel(poles, R[0] + 1j * R[1], rng.normal(size=(ports, ports)) / 10)
    w = np.concatenate([[0.0], poles.imag, np.linspace(0, 20, 4000)])
    return model.over(float(np.linalg.norm(model.at(w), 2, axis=(1, 2)).max()) / size)


def system_of(model):
    return StateSpace.from_entries(*(x.tolist() for x in model.realised()))


@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), ports=st.integers(1, 3), pairs=st.integers(1, 3), size=st.floats(0.3, 1.1))
def test_what_is_proved_is_passive(seed, ports, pairs, size):
    model = random_model(seed, ports, pairs, size)
    matrix = passivity.RationalMatrix(
        tuple(tuple(model.entry(i, k).rational() for k in range(ports)) for i in range(ports))
    )
    exact = passivity.check_bounded_real(matrix).status
    storage = strict_storage(system_of(model))
    if size < 0.99 and exact is Status.PROVED:
        assert storage is not None
    if storage is not None:
        assert exact is Status.PROVED


def test_another_matrix_proves_nothing():
    system = system_of(random_model(1, 2, 3, 0.9))
    storage = strict_storage(system)
    assert proves(system, storage)
    assert not proves(system, storage * 100)
    assert not proves(system, storage * -1)


@pytest.mark.parametrize("size", [0.9, 1.5])
def test_six_ports(size):
    """More ports than the exact test takes in seconds."""
    model, w = random_model(6, 6, 4, size), np.linspace(0, 20, 200)
    samples = SampledResponse(w / (2 * np.pi), model.at(w), "S")
    if size > 1:
        worst = np.linalg.norm(samples.values, 2, axis=(1, 2)).max()
        samples = SampledResponse(samples.f, samples.values / worst, "S")  # passive at the samples, hardly between
    found = fit_scattering(samples, 5e-2, nearest=True)
    assert found.verdict.status is Status.PROVED
    assert verify(found.verdict.certificate)
    assert found.error <= 5e-2


def port_hamiltonian(seed, states, ports, unit):
    """x' = (J - R) x + B u, y = B^T x + D u with R > 0 and D + D^T > 0: passive by construction."""
    rng = np.random.default_rng(seed)
    j, r, b = (rng.integers(-9, 10, shape) for shape in ((states, states), (states, states), (states, ports)))
    a = j - j.T - r @ r.T - np.eye(states)
    d = unit * (np.eye(ports) + np.triu(rng.integers(-3, 4, (ports, ports)), 1) * np.sqrt(1 / 64))
    d = unit * np.eye(ports) + (d - d.T)
    return StateSpace.from_entries(a.tolist(), b.tolist(), b.T.tolist(), d.tolist())


@pytest.mark.parametrize(("seed", "states", "ports", "unit"), [(0, 12, 3, 1.0), (1, 20, 8, 1.0), (2, 14, 2, 2.0**20)])
def test_passive_impedances_are_proved(seed, states, ports, unit):
    z = port_hamiltonian(seed, states, ports, unit)
    verdict = check_positive_real(z)
    assert verdict.status is Status.PROVED
    assert isinstance(verdict.certificate, StorageCertificate)
    assert verify(verdict.certificate)
    assert not verify(StorageCertificate(Kind.PR, z, verdict.certificate.storage * -1))
    assert not verify(StorageCertificate(Kind.BR, z, verdict.certificate.storage))


@pytest.mark.parametrize("seed", range(3))
def test_with_more_than_the_margin_taken_away_they_are_not(seed):
    """The smallest eigenvalue on the axis, in floats, and a hundredth more."""
    z = port_hamiltonian(seed, 12, 2, 1.0)
    least = analyse(FloatSystem.of(Kind.PR, z)).value
    taken = fmpq_mat(2, 2, [round(least * 1.01 * 1000 + 1) if i == k else 0 for i in range(2) for k in range(2)]) / 1000
    assert check_positive_real(StateSpace(z.a, z.b, z.c, z.d - taken)).status is Status.REFUTED
