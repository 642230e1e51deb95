"""State spaces of many states whose passivity is known by construction: lossless, at the border, beyond it."""

from fractions import Fraction

import numpy as np
import pytest

from passivity import ExpressionError, StateSpace, Status, check_bounded_real, check_positive_real, verify


def lossless(seed, states, ports):
    """S of a network of reactances, x^T x stored: A + A^T + C^T C = 0, B + C^T D = 0."""
    rng = np.random.default_rng(seed)
    j, b = rng.integers(-9, 10, (states, states)), rng.integers(-1, 2, (states, ports)) * 2
    return j - j.T - b @ b.T // 2, b, -b.T, np.eye(ports, dtype=int)


def seen_otherwise(a, b, c, d, seed):
    """The same with other states T x, T and its inverse of whole numbers."""
    n, rng = len(a), np.random.default_rng(seed)
    lower = np.eye(n, dtype=int)
    lower[np.arange(1, n), np.arange(n - 1)] = rng.integers(-2, 3, n - 1)
    lower[1::2] = np.eye(n, dtype=int)[1::2] + (lower - np.eye(n, dtype=int))[1::2]
    lower[2::2] = np.eye(n, dtype=int)[2::2]  # then T - 1 has the square zero
    back = 2 * np.eye(n, dtype=int) - lower
    assert (lower @ back == np.eye(n)).all()
    return (lower @ a @ back, lower @ b, c @ back, d), back.T @ back


def system(a, b, c, d):
    return StateSpace.from_entries(*(x.tolist() for x in (a, b, c, d)))


@pytest.mark.parametrize(("states", "ports"), [(6, 2), (60, 4), (150, 8)])
def test_lossless_networks_are_proved_with_the_energy_that_they_store(states, ports):
    matrices, energy = seen_otherwise(*lossless(states, states, ports), states)
    verdict = check_bounded_real(system(*matrices))
    assert verdict.proved
    assert verdict.lossless
    assert verdict.certificate.storage.tolist() == energy.tolist()
    assert verify(verdict.certificate)


@pytest.mark.parametrize("place", [(0, 0), (3, 7)])
def test_a_network_that_is_nearly_lossless_is_not_called_so(place):
    """One entry of C by 2^-40 larger: S^H S = 1 no longer holds, and somewhere it is above."""
    a, b, c, d = lossless(1, 40, 2)
    entries = [[Fraction(int(x)) for x in row] for row in c]
    entries[place[0] % 2][place[1]] += Fraction(1, 2**40)
    verdict = check_bounded_real(StateSpace.from_entries(a.tolist(), b.tolist(), entries, d.tolist()))
    assert not verdict.proved
    assert not verdict.lossless


def with_gain(states, ports, gain):
    """Half of a lossless network, beside gain/(s + 1), with the ports of both mixed by a rotation."""
    a, b, c, d = lossless(2, states, ports)
    grown = [np.zeros((states + 1, states + 1)), np.zeros((states + 1, ports + 1)), np.zeros((ports + 1, states + 1))]
    for whole, (part, last) in zip(grown, ((a, -1.0), (b, 1.0), (0.5 * c, gain)), strict=True):
        whole[: part.shape[0], : part.shape[1]] = part
        whole[-1, -1] = last
    half = np.zeros((ports + 1, ports + 1))
    half[:ports, :ports] = 0.5 * d
    q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(ports + 1, ports + 1)))
    return StateSpace.from_entries(*(x.tolist() for x in (grown[0], grown[1] @ q, grown[2], half @ q)))


@pytest.mark.parametrize("states", [20, 80])
def test_a_largest_singular_value_a_millionth_below_one_is_proved_and_one_above_refuted(states):
    verdict = check_bounded_real(with_gain(states, 3, 1 - 1e-6))
    assert verdict.proved
    assert verify(verdict.certificate)
    beyond = check_bounded_real(with_gain(states, 3, 1 + 1e-4))
    assert beyond.refuted
    assert beyond.witness.re > 0
    assert beyond.witness.form < 0


def ladder(sections):
    """Nodal equations of coils in series and capacitors to ground, behind a source of current: sums at the nodes."""
    n = 2 * sections + 1  # currents of coils, voltages behind them, and at the port
    e, a = np.zeros((n, n), int), np.zeros((n, n), int)
    for k in range(sections):
        coil, node, before = k, sections + k, sections + k - 1 if k else n - 1
        e[coil, coil], a[coil, before], a[coil, node] = k % 3 + 1, 1, -1
        e[node, node], a[node, coil] = k % 5 + 1, 1
        if k + 1 < sections:
            a[node, coil + 1] = -1
    e[n - 1, n - 1], a[n - 1, 0] = 7, -1  # a capacitor at the port
    b = np.zeros((n, 1), int)
    b[n - 1] = 1
    return e, a, b, b.T, np.zeros((1, 1), int)


def by_continued_fraction(sections, s):
    y = Fraction(0)
    for k in reversed(range(sections)):
        y = 1 / ((k % 3 + 1) * s + 1 / ((k % 5 + 1) * s + y))
    return 1 / (7 * s + y)


def test_a_ladder_of_coils_and_capacitors_by_its_nodes():
    z = StateSpace.from_descriptor(*(x.tolist() for x in ladder(40)))
    s = Fraction(2, 3)
    value = (by_continued_fraction(40, s), Fraction(0))
    assert z.image(s, Fraction(0), [(Fraction(1), Fraction(0))]) == (value,)
    verdict = check_positive_real(z)
    assert verdict.proved
    assert verdict.lossless
    assert verify(verdict.certificate)


def test_what_algebraic_equations_leave_out():
    """A conductance alone has no states; a coil whose current is given has no state space."""
    static = StateSpace.from_descriptor([[0]], [[-4]], [[1]], [[1]], [[0]])
    assert static.states == 0
    assert str(static.d[0, 0]) == "1/4"
    with pytest.raises(ExpressionError, match="E: no state space"):
        StateSpace.from_descriptor([[0, 1], [0, 0]], [[1, 0], [0, 1]], [[0], [1]], [[1, 0]], [[0]])
    with pytest.raises(ExpressionError, match="E: wrong shape"):
        StateSpace.from_descriptor([[1]], [[1, 0], [0, 1]], [[0], [1]], [[1, 0]], [[0]])


def test_a_ladder_with_a_negative_capacitor_is_refuted():
    e, a, b, c, d = ladder(20)
    e[25, 25] *= -1
    assert (
        check_positive_real(StateSpace.from_descriptor(*(x.tolist() for x in (e, a, b, c, d)))).status is Status.REFUTED
    )
