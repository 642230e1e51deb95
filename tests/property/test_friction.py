"""What holds for any parameters of friction: energy, mirrors, scales, events, and mechanisms put together at random."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_friction import KINDS, random_run, sound

import friction
from friction import Coulomb, Karnopp, Kind, LuGre, Ramp, Sine, Spring, Status, Table, Tanh, Testbench, simulate

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


SMOOTH = [
    LuGre(sigma0=1e5),
    LuGre(sigma0=1e4, sigma1=20.0),
    friction.ElastoPlastic(sigma0=1e4, z_ba=5e-5),
    friction.Dahl(),
    Tanh(),
]


@pytest.mark.parametrize("kind", KINDS)
def test_events_depend_neither_on_the_end_nor_on_samples(kind):
    for seed in range(25):
        rng = np.random.default_rng((7, seed))
        model, bench, t_end = random_run(rng, kind)
        t_end, part = min(t_end, 1e2), float(rng.uniform(0.1, 1.0)) * min(t_end, 1e2)
        run = simulate(model, bench, t_end, times=[t_end])
        again = simulate(model, bench, part, times=np.unique(rng.uniform(0.0, part, 7)))
        assert run.status is again.status is Status.DONE
        assert again.events == [event for event in run.events if event.t <= part]
        assert sound(run.events)


@pytest.mark.parametrize(
    ("bench", "t_end"),
    [
        (Testbench(Ramp(1000.0)), 100.0),
        (Testbench(Ramp(2.0)), 1e5),
        (Testbench(Sine(2.0, 50.0)), 100.0),
        (Testbench(Ramp(0.0), spring=Spring(1000.0, 0.05)), 600.0),
        (Testbench(Table(1e-3 * np.arange(20_000), 2.0 * np.random.default_rng(2).normal(size=20_000))), 20.0),
    ],
    ids=["steep", "long", "fast sine", "stiff rig", "noise"],
)
def test_runs_that_did_not_end_do(bench, t_end):
    run = simulate(Karnopp(), bench, t_end)
    assert run.status is Status.DONE
    assert sound(run.events)
    assert abs(run.ledger.residual) < 1e-12


def test_a_ramp_breaks_away_once_wherever_its_run_ends():
    rng = np.random.default_rng(11)
    for _ in range(300):
        model = Karnopp(F_c=1.0, F_s=1.0 + rng.random(), F_v=rng.random(), v_s=10.0 ** rng.uniform(-3, 0))
        slope, mass, t_end = 10.0 ** rng.uniform(-3, 4), 10.0 ** rng.uniform(0, 2), 10.0 ** rng.uniform(3.2, 4)
        (event,) = simulate(model, Testbench(Ramp(slope), mass), t_end, times=[t_end]).events
        assert event.kind is Kind.BREAK_AWAY
        assert event.t == pytest.approx(model.F_s / slope, rel=1e-15)


@pytest.mark.parametrize("ratio", [5.9, 6.005, 8.0, 20.0, 27.0, 100.0, 1e4, 1e150])
def test_far_from_the_stribeck_peak_it_comes_to_rest(ratio):
    """Where the peak is a number so small that it has few digits, or none."""
    model = Karnopp(F_v=0.0, v_s=0.3 / ratio)
    stop, away = simulate(model, Testbench(Ramp(-0.7), v0=0.3), 10.0, budget=1000).events
    assert (stop.kind, away.kind) == (Kind.STOP, Kind.BREAK_AWAY)
    assert away.t == pytest.approx(1.2 / 0.7, rel=1e-14)


def test_a_stop_that_nothing_holds_is_a_reversal_whatever_is_rounded():
    """A clock of two floats may fall by half a bit when nothing is added to it."""
    bench = Testbench(Ramp(-7.459493256668211, 5.115062655362707), 0.5076137511574723, -0.5970605310303789)
    run = simulate(Coulomb(1.027946492061409), bench, 2.9)
    assert [event.kind for event in run.events] == [Kind.REVERSAL] * 2


@pytest.mark.parametrize("amplitude", [1.0, 1.0 + 2.3e-16, 1.0 + 1e-13, 1.0 - 1e-16, 1.0 + 1e-9])
def test_a_force_that_touches_friction_breaks_away_or_not_but_goes_on(amplitude):
    run = simulate(Coulomb(), Testbench(Sine(amplitude, 3.0)), 50.0)
    assert run.status is Status.DONE
    assert sound(run.events)
    assert run.event_count <= 600


@given(st.integers(0, 10_000), st.sampled_from(SMOOTH))
@settings(max_examples=6, deadline=None)
def test_events_of_smooth_laws_come_from_the_integrator(seed, model):
    rng = np.random.default_rng(seed)
    bench = Testbench(Sine(rng.uniform(1.5, 3.0), rng.uniform(0.5, 5.0)), rng.uniform(0.5, 2.0))
    runs = [simulate(model, bench, 3.0, tol=1e-8, times=times) for times in ([3.0], np.linspace(0.0, 3.0, 37))]
    assert [event.kind for event in runs[0].events] == [event.kind for event in runs[1].events]
    near = [abs(one.t - other.t) for one, other in zip(runs[0].events, runs[1].events, strict=True)]
    assert max(near, default=0.0) <= 2e-8 * 3.0
    part = simulate(model, bench, 2.0, tol=1e-8, times=[1.9])
    assert len(part.events) == sum(event.t <= 2.0 for event in runs[0].events)
    assert all(a.t < b.t and (a.kind is Kind.STOP) == (b.kind is Kind.BREAK_AWAY) for a, b in pairwise(runs[0].events))


def test_every_stop_of_lugre_is_told():
    """Of 100 periods, with 11 samples: in each, it breaks away and stops twice."""
    run = simulate(LuGre(sigma0=1e5), Testbench(Sine(2.0, 5.0)), 20.0, tol=1e-6, times=np.linspace(0.0, 20.0, 11))
    assert run.event_count == len(run.events) == 399  # the last slip is still under way
    stops = [event.t for event in run.events if event.kind is Kind.STOP]
    assert np.diff(stops[150:]) == pytest.approx(0.1, abs=1e-5)


def test_events_of_fixed_steps_are_not_thinned_with_the_samples():
    dense = simulate(Coulomb(), Testbench(Ramp(0.5)), 1.9, "euler", h=1e-5)
    thinned = simulate(Coulomb(), Testbench(Ramp(0.5)), 19.0, "euler", h=1e-5)
    assert (dense.t.size, thinned.t.size) == (190_001, 190_001)
    assert thinned.events[: len(dense.events)] == dense.events
    assert np.sum(dense.v[1:] * dense.v[:-1] < 0.0) == sum(event.kind is Kind.REVERSAL for event in dense.events)
