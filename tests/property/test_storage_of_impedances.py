"""Strictly passive impedances with many states and ports are proved by a storage function, others never."""

import numpy as np
import pytest
from flint import fmpq_mat

from passivity import Kind, StateSpace, Status, check_positive_real, verify
from passivity.floats.axis import analyse
from passivity.floats.system import FloatSystem
from passivity.verdict import StorageCertificate


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
