"""Kernels against slow, obvious twins; every refusal says where and why."""

from math import inf, nan
from typing import Any

import numpy as np
import pytest

from friction import (
    METHODS,
    MODELS,
    PID,
    Coulomb,
    Dahl,
    ElastoPlastic,
    InputError,
    Karnopp,
    LuGre,
    MaxwellSlip,
    Ramp,
    Sine,
    Spring,
    Status,
    Steps,
    Table,
    Tanh,
    Testbench,
    dead_zone,
    euler_chatter,
    limits,
    lugre_drift,
    prescribe,
    simulate,
    tanh_creep,
)
from friction.kernel import law as kernel
from friction.kernel.automaton import automaton
from friction.kernel.roots import first_root
from friction.simulation import on_testbench
from tline.compiled.structure import pack

SMOOTH = [LuGre(sigma1=3.0), Dahl(), ElastoPlastic(sigma1=2.0), Tanh()]


@pytest.mark.parametrize("model", SMOOTH, ids=lambda model: model.name)
@pytest.mark.parametrize("v", [-0.7, -0.03, 0.0004, 0.08, 2.0])
@pytest.mark.parametrize("z", [-0.0019, 0.0005, 0.0018, 0.0023])
def test_derivatives_are_those_of_the_law(model, v, z):
    law, s = model.law, np.sign(v)
    derivatives = np.reshape(kernel.jacobian(law, s, v, z), (2, 2))
    for k, (dv, dz) in enumerate(derivatives):
        at = [kernel.respond(law, s, v + a, z + b)[k] for a, b in ((1e-7, 0), (-1e-7, 0), (0, 1e-9), (0, -1e-9))]
        assert (at[0] - at[1]) / 2e-7 == pytest.approx(dv, rel=1e-5, abs=0.02)
        assert (at[2] - at[3]) / 2e-9 == pytest.approx(dz, rel=1e-5, abs=1e-4)


@pytest.mark.parametrize("model", [cls() for cls in MODELS.values()], ids=lambda model: model.name)
def test_steady_sliding_meets_the_steady_force(model):
    for v in (-0.4, 0.05, 1.7):
        z = np.sign(v) * float(model.g(v)) / model.law.sigma0 if model.law.sigma0 else 0.0
        force, rate = kernel.friction(model.law, v, z, 0.0)
        assert force == pytest.approx(float(model.steady_force(v)), rel=1e-14)
        assert rate == pytest.approx(0.0, abs=1e-15)


def test_first_roots_are_those_of_the_companion_matrix():
    rng = np.random.default_rng(3)
    for _ in range(300):
        p = rng.normal(size=rng.integers(2, 12)) * 0.7 ** np.arange(1)
        p[0] = abs(p[0])
        roots = np.roots(p[::-1])
        real = roots[(abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real <= 2.0)].real
        got = first_root(p, 2.0, np.empty(p.size))
        assert got == pytest.approx(real.min() if real.size else inf, rel=1e-7)


def test_zeros_at_the_start_are_no_roots():
    q = np.empty(4)
    assert first_root(np.array([0.0, 1.0, -1.0]), 3.0, q) == pytest.approx(1.0)
    assert first_root(np.array([0.0, 0.0, 2.0]), 3.0, q) == inf
    assert first_root(np.array([0.0, -1.0, 2.0]), 3.0, q) == 0.0
    assert first_root(np.zeros(3), 3.0, q) == inf


@pytest.mark.parametrize(
    ("force", "t", "value"),
    [
        (Ramp(2.0, 1.0), 3.0, 7.0),
        (Sine(2.0, 0.25, offset=1.0), 1.0, 3.0),
        (Sine(2.0, 0.25, offset=1.0, slope=0.5), 1.0, 3.5),
        (Steps([1.0, 2.0], [5.0, -1.0]), 0.5, 0.0),
        (Steps([1.0, 2.0], [5.0, -1.0]), 1.0, 5.0),
        (Steps([1.0, 2.0], [5.0, -1.0]), 9.0, -1.0),
        (Table([1.0, 3.0], [2.0, 4.0]), 0.2, 2.0),
        (Table([1.0, 3.0], [2.0, 4.0]), 2.0, 3.0),
        (Table([1.0, 3.0], [2.0, 4.0]), 8.0, 4.0),
    ],
)
def test_forces(force, t, value):
    drive = Testbench(force, spring=Spring(3.0, 0.5)).drive
    assert kernel.applied(kernel.push_at(drive, t), t, 0.1)[0] == pytest.approx(value + 3.0 * (0.5 * t - 0.1))


def test_euler_does_what_its_formula_says():
    run, v, x = simulate(Coulomb(), Testbench(Ramp(0.5), mass=2.0), 1.0, "euler", h=0.1), 0.0, 0.0
    for k in range(10):
        x, v = x + 0.1 * v, v + 0.1 * (0.5 * 0.1 * k - np.sign(v)) / 2.0
        assert (run.x[k + 1], run.v[k + 1]) == (pytest.approx(x, abs=1e-15), pytest.approx(v, abs=1e-15))


def test_fixed_steps_are_thinned():
    run = simulate(Coulomb(), Testbench(), 10.0, "euler", h=1e-5)
    assert (run.t.size, run.steps, run.t[-1]) == (200_001, 1_000_000, 10.0)
    odd = simulate(Coulomb(), Testbench(), 10.0, "euler", h=10.0 / 200_003)
    assert (odd.t.size, odd.t[-1]) == (100_003, pytest.approx(10.0))


SENTENCES = [
    (lambda: Coulomb(F_c=-1.0), "model.F_c: too small, expected more than 0, got -1"),
    (lambda: Karnopp(F_c=1.0, F_s=0.9), "model.F_s: below F_c, expected at least F_c = 1, got 0.9"),
    (lambda: Karnopp(v_s=0.0), "model.v_s: too small, expected more than 0, got 0"),
    (lambda: Karnopp(delta=-1.0), "model.delta: too small, expected at least 0, got -1"),
    (lambda: LuGre(sigma0=0.0), "model.sigma0: too small"),
    (lambda: LuGre(sigma1=nan), "model.sigma1: not a finite number, expected a number, got nan"),
    (lambda: Dahl(F_c="1"), "model.F_c: not a finite number, expected a number, got '1'"),
    (lambda: ElastoPlastic(z_ba=0.01), "model.z_ba: too large, expected less than F_c/σ0 = 0.002, got 0.01"),
    (lambda: Tanh(epsilon=0.0), "model.epsilon: too small"),
    (lambda: Testbench(mass=-1.0), "bench.mass: too small, expected more than 0, got -1"),
    (lambda: Testbench(v0=inf), "bench.v0: not a finite number"),
    (lambda: Spring(-2.0, 1.0), "spring.stiffness: too small"),
    (lambda: Testbench(spring=Spring(1.0, 1.0), controller=PID(1.0)), "bench.controller: beside a spring"),
    (lambda: Testbench(Spring(1.0, 1.0)), "bench.force: something else, expected Ramp, Sine"),
    (lambda: Testbench(spring=2.0), "bench.spring: something else, expected Spring, got 2.0"),
    (lambda: PID(1.0, integral=-1.0), "controller.integral: too small"),
    (
        lambda: simulate(LuGre(), Testbench(controller=PID(1.0))),
        "method: 'taylor' knows no controller, expected events, with coulomb or karnopp",
    ),
    (lambda: simulate(LuGre(), Testbench(), budget=2 * 10**9), "budget: too large, expected at most 1,000,000,000"),
    (lambda: prescribe(LuGre(), velocity=lambda t: np.abs(t - 0.3)), "velocity: a formula with a corner, a jump"),
    (lambda: prescribe(LuGre(), position=lambda t: 1.0 / t), "position: no number at 0 s"),
    (
        lambda: prescribe(LuGre(), velocity=Sine(1.0, 1.0, slope=1.0)),
        "velocity: a sine on a slope, expected a sine and",
    ),
    (lambda: Sine(1.0, 0.0), "force.frequency: too small"),
    (lambda: Table([0.0, 1.0], [0.0, nan]), "force.values[1]: not a finite number"),
    (lambda: Table([0.0, 0.0], [0.0, 1.0]), "force.times[1]: times do not rise, expected more than 0, got 0"),
    (
        lambda: Table([0.0, 5e-324], [1.4, 0.4]),
        "force.times[1]: the force changes too fast, expected at most 1e+30 N/s, or steps",
    ),
    (lambda: Steps([0.0], []), "force: times and values do not match, expected as many values as times, got 0 values"),
    (lambda: simulate(Coulomb(), Testbench(), 0.0), "t_end: too small"),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, "euler", h=0.0), "h: too small, expected more than 0, got 0"),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, "euler"), "h: 'euler' needs a step, expected a number of seconds"),
    (
        lambda: simulate(Coulomb(), Testbench(), 1.0, "euler", h=1e-12),
        "h: too small, expected at most 5,000,000 steps",
    ),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, "euler", h=9.0), "h: longer than the run"),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, h=0.1), "h: 'events' chooses its own steps"),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, tol=0.1), "tol: the method 'events' is exact to rounding"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, tol=1.0), "tol: too large, expected at most 0.1, got 1"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, tol=1e-20), "tol: too small"),
    (
        lambda: simulate(LuGre(), Testbench(), 1.0, "events"),
        "method: 'events' does not fit the lugre model, expected rosenbrock",
    ),
    (lambda: simulate(Coulomb(), Testbench(), 1.0, "leapfrog"), "method: unknown, expected events or rosenbrock"),
    (lambda: simulate(Karnopp(delta=0.1), Testbench(), 1.0, "moreau", h=0.1), "method: 'moreau' knows no dead zone"),
    (lambda: simulate(Karnopp(F_v=9.0, delta=0.5), Testbench(), 1.0), "model.delta: friction at the border"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, times=[0.5, 0.2]), "times: not rising"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, times="soon"), "times: not numbers"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, times=range(10**9)), "times: not rising, expected 1 to 200000 rising"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, times=[0.5, 2.0]), "times: outside the run, expected 0 to 1"),
    (lambda: simulate(LuGre(), Testbench(), 1.0, "euler", h=0.1, tol=1e-3), "tol: 'euler' has fixed steps"),
    (lambda: limits(LuGre(), 1.0, 0.0), "mass: too small"),
    (lambda: limits(LuGre(), inf), "v: not a finite number"),
    (lambda: Coulomb(1e300), "model.F_c: too large, expected at most 1e+12, got 1e+300"),
    (lambda: euler_chatter(1.0, 0.0, 0.1), "slope: too small"),
    (lambda: dead_zone(0.1, 1.0, 0.1, F_a=1.0), "F_a: breaks away"),
    (lambda: tanh_creep(0.1, 2.0, 1.0), "F_a: breaks away"),
    (lambda: lugre_drift(LuGre(), 0.5, 1.3), "low, high: out of range"),
    (lambda: lugre_drift(Dahl(), 0.5, 0.6), "model: something else, expected LuGre, got Dahl("),
    (lambda: Tanh(F_c=10**400), "model.F_c: too large, expected at most 1e+12, got 1000"),
    (lambda: Steps(1.0, [5.0]), "force.times: not a sequence, expected numbers in a row, got 1.0"),
    (lambda: Steps([1.0], ["five"]), "force.values[0]: not a finite number, expected a number, got 'five'"),
    (lambda: MaxwellSlip(None, [1.0]), "model.stiffness: not a sequence"),
    (lambda: Coulomb().steady_force("fast"), "v: not numbers, expected a number or an array of them, got 'fast'"),
    (lambda: simulate("lugre", Testbench()), "model: something else, expected Coulomb, Karnopp, LuGre"),
    (lambda: simulate(LuGre(), Ramp()), "bench: something else, expected Testbench, got Ramp("),
    (
        lambda: prescribe(LuGre(), velocity=0.5),
        "velocity: something else, expected Ramp, Sine, Steps or Table",
    ),
]


@pytest.mark.parametrize(("wrong", "sentence"), SENTENCES, ids=[sentence[:40] for _, sentence in SENTENCES])
def test_mistakes_get_one_sentence(wrong, sentence):
    with pytest.raises(InputError) as caught:
        wrong()
    assert str(caught.value).startswith(sentence)
    assert "\n" not in str(caught.value)


def test_every_method_runs_on_every_model_it_declares():
    for method in METHODS.values():
        for kind in method.models:
            model = kind([1000.0], [1.0]) if kind is MaxwellSlip else kind()
            options = {"fixed": {"h": 1e-4}, "adaptive": {"budget": 1000}, "events": {}}[method.step]
            run = simulate(model, Testbench(Ramp(0.5), v0=-0.2), 1.0, method.name, **options)
            assert np.isfinite(run.v).all()
            assert run.status is Status.DONE or method.step == "adaptive"


def test_huge_and_tiny_numbers_end_soon():
    for model in (Coulomb(1e12), Karnopp(1e-300, 1e-300), LuGre(sigma0=1e12), Tanh(epsilon=1e-300)):
        for force in (Ramp(1e12), Sine(1e12, 1e12), Ramp(1e-300)):
            run = simulate(model, Testbench(force, mass=1e-200), 1e3, budget=1000, times=[1.0])
            assert isinstance(run.status, Status)


@pytest.mark.parametrize("gain", ["stiffness", "integral", "derivative", "speed"])
def test_a_controller_of_another_gain_is_doubted(gain, monkeypatch):
    right = Testbench.drive.fget
    bench = Testbench(Ramp(0.0), controller=PID(100.0, 200.0, 5.0, 0.01, 0.001))
    assert simulate(Karnopp(), bench, 20.0).status is Status.DONE
    monkeypatch.setattr(
        Testbench, "drive", property(lambda self: (d := right(self))._replace(**{gain: 1.01 * getattr(d, gain)}))
    )
    assert simulate(Karnopp(), bench, 20.0).status is Status.DOUBTED


def test_events_beyond_the_list_are_counted():
    """Those that fit are the same, whether or not all do."""
    bench, times = Testbench(Sine(2.0, 5.0)), np.array([10.0])
    whole, short = (on_testbench(Karnopp(), bench, 10.0, times, events)[1] for events in (1000, 21))
    assert automaton(pack(whole), 10_000) == automaton(pack(short), 10_000) == kernel.DONE
    np.testing.assert_array_equal(short.counts, whole.counts)
    assert 100 < whole.counts[2] < 1000
    np.testing.assert_array_equal(short.events[:20], whole.events[:20])


def test_what_has_the_same_numbers_is_equal():
    for kind in (Table, Steps, MaxwellSlip):
        times: Any = np.array([1.0, 2.0])
        one, other = kind([1.0, 2.0], [3.0, 4.0]), kind(times, (3.0, 4.0))
        assert one == other
        assert hash(one) == hash(other)
        assert one != kind([1.0, 2.0], [3.0, 5.0])
