"""What holds for any parameters: energy is accounted for, friction takes it, left is like right, scales do not
matter.
"""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from friction import Coulomb, Karnopp, LuGre, Ramp, Sine, Spring, Status, Table, Testbench, simulate

TIMES = np.linspace(0.0, 4.0, 101)


def numbers(low, high):
    """Nothing or something: a speed of 1e-40 m/s carries no energy to speak of relative errors of."""
    return st.floats(low, high, allow_nan=False, width=32).map(lambda x: x if abs(x) > 1e-6 else 0.0)


forces = st.one_of(
    st.builds(Ramp, numbers(-2, 2), numbers(-2, 2)),
    st.builds(Sine, numbers(0.25, 4), numbers(0.125, 4), numbers(-1, 1), numbers(0, 6)),
    st.lists(numbers(-3, 3), min_size=2, max_size=6).map(
        lambda values: Table([0.5 * k for k in range(len(values))], values)
    ),
)
springs = st.one_of(st.none(), st.builds(Spring, numbers(1, 50), numbers(-1, 1)))
benches = st.builds(Testbench, forces, numbers(0.25, 4), numbers(-2, 2), springs)


@st.composite
def karnopps(draw):
    F_c = draw(numbers(0.25, 2))
    return Karnopp(F_c, F_c * (1.0 + draw(numbers(0, 1))), draw(numbers(0, 0.5)), draw(numbers(0.03125, 1)))


@st.composite
def lugres(draw):
    F_c = draw(numbers(0.25, 2))
    F_s = F_c * (1.0 + draw(numbers(0, 0.5)))
    return LuGre(
        F_c, F_s, draw(numbers(0.03125, 1)), draw(numbers(50, 5000)), draw(numbers(0, 20)), draw(numbers(0, 0.5))
    )


def mirrored(bench):
    force, spring = bench.force, bench.spring
    if isinstance(force, Ramp):
        force = Ramp(-force.slope, -force.offset)
    elif isinstance(force, Sine):
        force = Sine(-force.amplitude, force.frequency, -force.offset, force.phase)
    else:
        force = Table(force.times, [-f for f in force.values])
    return Testbench(force, bench.mass, -bench.v0, spring and Spring(spring.stiffness, -spring.speed))


@given(karnopps(), benches)
@settings(max_examples=7, deadline=None)
def test_static_laws_account_for_all_energy_and_only_take_it(model, bench):
    run = simulate(model, bench, 4.0, times=TIMES)
    assert run.status is Status.DONE
    assert abs(run.ledger.residual) < 1e-12
    assert np.diff(run.W_f, prepend=0.0).min() > -1e-12
    held = run.mode == 0
    assert np.all(np.abs(run.F_f[held]) <= model.F_s * (1.0 + 1e-9))
    assert np.all(run.v[held] == 0.0)
    assert np.all(run.mode[~held] * run.v[~held] >= -1e-13)


@given(lugres(), benches)
@settings(max_examples=6, deadline=None)
def test_lugre_accounts_for_all_energy(model, bench):
    run = simulate(model, bench, 4.0, times=TIMES)
    assert run.status is Status.DONE
    assert (
        abs(run.ledger.residual) < 1e-9
    )  # errors are weighed against m·v_s² too, so slow, small motions close less well
    assert np.all(model.sigma0 * np.abs(run.z) <= model.F_s * (1.0 + 1e-9))  # bristles never bend further


@given(karnopps(), benches)
@settings(max_examples=7, deadline=None)
def test_left_is_like_right(model, bench):
    run, mirror = simulate(model, bench, 4.0, times=TIMES), simulate(model, mirrored(bench), 4.0, times=TIMES)
    np.testing.assert_allclose(mirror.v, -run.v, atol=1e-9)


@given(numbers(0.25, 2), forces, st.sampled_from([2.0, 8.0, 0.25]))
@settings(max_examples=7, deadline=None)
def test_forces_and_mass_scale_together(F_c, force, scale):
    """Powers of two change no digits."""
    if isinstance(force, Ramp):
        larger = Ramp(scale * force.slope, scale * force.offset)
    elif isinstance(force, Sine):
        larger = Sine(scale * force.amplitude, force.frequency, scale * force.offset, force.phase)
    else:
        larger = Table(force.times, [scale * f for f in force.values])
    run = simulate(Coulomb(F_c), Testbench(force, 1.0, 0.5), 4.0, times=TIMES)
    other = simulate(Coulomb(scale * F_c), Testbench(larger, scale, 0.5), 4.0, times=TIMES)
    np.testing.assert_allclose(other.v, run.v, atol=1e-13)


@given(karnopps(), benches)
@settings(max_examples=5, deadline=None)
def test_moreau_follows_the_events(model, bench):
    exact = simulate(model, bench, 2.0, times=[2.0])
    rough = simulate(model, bench, 2.0, "moreau", h=1e-5)
    assert abs(rough.ledger.residual) < 1e-9
    assert abs(rough.x[-1] - exact.x[0]) < 0.05 * (1.0 + abs(exact.x[0]))
