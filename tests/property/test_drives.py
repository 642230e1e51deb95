"""What holds for any coupled drives: no growth, energy in balance, passive ports, alike from both ends."""

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq_mat
from hypothesis import given, settings, strategies as st

from drives import Belt, CoupledDrives, Pulley, Spool, Torque, simulate
from drives.energy import open_torques, powers, storage
from passivity import RationalFunction, StateSpace, Status, check_positive_real, verify

sizes = st.floats(-3, 3).map(lambda x: float(f"{10**x:.6g}"))
spools, belts = st.builds(Spool, sizes, sizes | st.just(0.0), sizes), st.builds(Belt, sizes, sizes | st.just(0.0))
mechanisms = st.builds(CoupledDrives, spools, spools, belts, belts, st.builds(Pulley, sizes, st.floats(0.01, 1.56)))
torques = st.builds(
    lambda times, values: Torque.table(sorted(times), values[: len(times)]),
    st.lists(st.integers(0, 2000).map(lambda k: k / 1000), min_size=1, max_size=4, unique=True),
    st.lists(st.floats(-5, 5), min_size=4, max_size=4),
)


@pytest.mark.parametrize("seed", range(4))
def test_nothing_grows(seed):
    rng = random.Random(seed)
    for _ in range(500):
        spools, belts = ([[10 ** rng.uniform(-3, 3) for _ in range(n)] for _ in range(2)] for n in (3, 2))
        pulley = Pulley(10 ** rng.uniform(-3, 3), rng.uniform(0.01, 1.56))
        drives = CoupledDrives(Spool(*spools[0]), Spool(*spools[1]), Belt(*belts[0]), Belt(*belts[1]), pulley)
        found = drives.state_space().poles
        assert len(found) == 6
        assert found[-1] == 0
        assert all(z.real < 0 for z in found[:-1])


@settings(max_examples=15, deadline=None)
@given(mechanisms)
def test_nothing_grows_without_friction_either(drives):
    found = drives.state_space().poles
    assert len(found) == len(drives.states)
    assert max(z.real for z in found) == 0


@settings(max_examples=10, deadline=None)
@given(mechanisms, torques, torques, st.sampled_from([1e-6, 1e-3, 0.1, 1.0]))
def test_energy_is_in_balance(drives, T1, T2, step):
    start = dict.fromkeys(drives.states[1:], 0.5)
    run = simulate(drives, T1, T2, t_end=30 * step, step=step, initial=start)
    energy = run.energy
    # what flows forth and back can be far larger than what is left of it
    speeds = np.abs(run.outputs["w1"]).max() + np.abs(run.outputs["w2"]).max()
    turnover = energy.stored.max() + energy.dissipated.max() + np.abs(energy.supplied).max() + 10 * speeds * run.t[-1]
    assert np.abs(energy.imbalance).max() < 1e-12 * turnover
    assert (np.diff(energy.dissipated) >= 0).all()


@settings(max_examples=7, deadline=None)
@given(mechanisms)
def test_power_balances_exactly(drives):
    # d/dt x'Hx = supplied - heat as polynomials in states and torques: nothing is left to rounding
    model, (heat, work) = drives.state_space(), powers(drives, open_torques(drives))
    n = len(drives.states)
    joined = [[*a, *b, 0, 0] for a, b in zip(model.a.tolist(), model.b.tolist(), strict=True)]
    rate, pad = fmpq_mat(joined), fmpq_mat([[int(i == k) for k in range(n + 4)] for i in range(n)])
    half = pad.transpose() * storage(drives) * rate
    assert half + half.transpose() == work - heat


@settings(max_examples=4, deadline=None)
@given(mechanisms)
def test_ports_from_torque_to_speed_are_passive(drives):
    # power enters as (-T1) w1 + T2 w2
    model = drives.state_space(("w1", "w2"))
    a, b, c = (
        [[Fraction(int(x.p), int(x.q)) for x in row] for row in matrix.tolist()]
        for matrix in (model.a, model.b, model.c)
    )
    b = [[-row[0], row[1]] for row in b]
    ports = StateSpace.from_entries(a, b, c, [[0, 0], [0, 0]])
    verdict = check_positive_real(ports)
    assert verdict.status is Status.PROVED
    h = drives.transfer("w1", "T1")
    one = RationalFunction.from_coefficients([-x for x in h.numerator], h.denominator)
    single = check_positive_real(one)
    assert single.status is Status.PROVED
    assert verify(single.certificate)


@settings(max_examples=7, deadline=None)
@given(mechanisms)
def test_reciprocal_and_alike_from_both_ends(drives):
    there, back = drives.transfer("w2", "T1"), drives.transfer("w1", "T2")
    assert (there.p, there.q) == (-1 * back.p, back.q)
    turned = CoupledDrives(drives.right, drives.left, drives.right_belt, drives.left_belt, drives.pulley)
    for output in ("x_k", "tension"):
        one, other = drives.transfer(output, "T1"), turned.transfer(output, "T2")
        assert (one.p, one.q) == (other.p, other.q)


@settings(max_examples=7, deadline=None)
@given(mechanisms, st.floats(-3, 3))
def test_values_and_phase_agree(drives, exponent):
    h, w = drives.transfer("w1", "T1"), 10.0**exponent
    value, phase = h(1j * w), float(h.phase(w))
    assert math.isclose(math.remainder(np.angle(value) - phase, 2 * math.pi), 0, abs_tol=1e-12)
