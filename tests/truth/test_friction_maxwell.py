"""Maxwell slip and Armstrong's law: play operators, Masing's rules, dwell and lag in closed form."""

from math import pi, sin

import numpy as np
import pytest

from friction import Armstrong, InputError, MaxwellSlip, Ramp, Sine, Steps, Table, prescribe

LAW = MaxwellSlip([1000.0, 500.0, 200.0], [0.4, 0.6, 0.3])
SUM = 1.3  # N, of the limits


def virgin(x):
    """The first loading curve: each element a spring up to its limit."""
    return sum(np.minimum(k * x, w) for k, w in zip(LAW.stiffness, LAW.limits, strict=True))


def at_places(places, law=LAW):
    """Force where a motion by straight lines between places arrives."""
    times = np.arange(len(places), dtype=float)
    return prescribe(law, position=Table(times, places), t_end=times[-1], times=times).F_f


def test_masings_rules():
    """Behind a turn every branch is the first curve, twice as large: F = F_turn - 2·F_0((x_turn - x)/2)."""
    times, a = np.linspace(0.0, 1.25, 501), 1.7e-3
    run = prescribe(LAW, position=Sine(a, 1.0), t_end=1.25, times=times)
    down, up = (times >= 0.25) & (times <= 0.75), times >= 0.75
    np.testing.assert_allclose(run.F_f[times <= 0.25], virgin(run.x[times <= 0.25]), atol=1e-14)
    np.testing.assert_allclose(run.F_f[down], virgin(a) - 2.0 * virgin(0.5 * (a - run.x[down])), atol=1e-14)
    np.testing.assert_allclose(run.F_f[up], -virgin(a) + 2.0 * virgin(0.5 * (run.x[up] + a)), atol=1e-14)
    assert run.F_f[-1] == pytest.approx(virgin(a), abs=1e-14)  # the loop closes


def test_memory_is_not_local():
    """Two histories of the same place, force and direction go on differently; a loop that is closed is forgotten."""
    turn, low, inner, far = 1e-3, -0.2e-3, 0.5e-3, 2.2e-3
    closed = at_places([0.0, turn, low, inner, low, turn, far])
    plain = at_places([0.0, turn, low, turn, far])
    np.testing.assert_allclose(closed[[2, 4, 5, 6]], [plain[2], plain[2], plain[3], plain[4]], atol=1e-14)
    np.testing.assert_allclose(plain[3:], virgin(np.array([turn, far])), atol=1e-14)  # and the outer loop likewise
    inside = at_places([0.0, turn, low, inner])[-1]
    x = np.linspace(0.0, turn, 100001)
    fresh = x[np.argmin(np.abs(virgin(x) - inside))]  # the first curve has that force elsewhere; go on by the same way
    more, other = at_places([0.0, turn, low, inner, inner + 3e-4])[-1], at_places([0.0, fresh, fresh + 3e-4])[-1]
    assert abs(more - other) > 0.05


@pytest.mark.parametrize("seed", range(6))
def test_elements_are_play_operators(seed):
    """Random turns, against force clipped from turn to turn; the sum of all limits is never exceeded."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 9))
    law = MaxwellSlip(10.0 ** rng.uniform(2.0, 5.0, n), rng.uniform(0.1, 1.0, n))
    places = np.append(0.0, 1e-3 * rng.normal(size=60))
    held, exact = np.zeros(n), [0.0]
    for step in np.diff(places):
        held = np.clip(held + np.array(law.stiffness) * step, -np.array(law.limits), law.limits)
        exact.append(held.sum())
    np.testing.assert_allclose(at_places(places, law), exact, atol=1e-12 * sum(law.limits))


def test_limits_that_fall_with_velocity():
    """Elements stepped 20,000 times a second: they stick until their limit, and slide at it until v turns."""
    law, n = MaxwellSlip([2000.0, 500.0], [0.6, 0.4], peak=1.5, v_s=0.01, F_v=0.5), 20_000
    run = prescribe(law, velocity=Sine(0.02, 1.0), times=np.linspace(0.0, 1.0, 401))
    held, slides, way, exact = np.zeros(2), np.zeros(2, bool), 1.0, [0.0]
    for k in range(n):
        t = (k + 1) / n
        step = 0.02 * (np.cos(2.0 * pi * k / n) - np.cos(2.0 * pi * t)) / (2.0 * pi)
        v = 0.02 * sin(2.0 * pi * t)
        if step * way < 0.0:
            way, slides = -way, np.zeros(2, bool)
        limit = (1.0 + 0.5 * np.exp(-((v / 0.01) ** 2))) * np.array([0.6, 0.4])
        held = np.where(slides, way * limit, held + np.array([2000.0, 500.0]) * step)
        slides |= way * held >= limit
        if (k + 1) % 50 == 0:
            exact.append(held.sum() + 0.5 * v)
    assert np.abs(run.F_f - exact).max() < 4e-3  # a step moves an element by up to 2e-3 N


def test_steady_and_rest():
    run = prescribe(LAW, velocity=Steps([0.0, 0.5], [0.1, 0.0]), times=[0.4, 0.9])
    assert run.F_f == pytest.approx([SUM, SUM])
    fast = MaxwellSlip([1e3], [1.0], peak=2.0, v_s=0.1)
    assert prescribe(fast, velocity=Ramp(0.0, 0.1), times=[1.0]).F_f[0] == pytest.approx(1.0 + 1.0 / np.e)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (([1.0], [1.0, 2.0]), "model.limits: not one for each stiffness, expected 1, got 2"),
        (([], []), "model.limits: not one"),
        (([1.0, -1.0], [1.0, 2.0]), r"model.stiffness\[1\]: too small"),
        (([1.0], [1.0], 0.5), "model.peak: too small, expected at least 1"),
    ],
)
def test_mistakes(given, sentence):
    with pytest.raises(InputError, match=sentence):
        MaxwellSlip(*given)


ARMSTRONG = Armstrong(F_c=1.0, F_s=1.5, F_v=0.2, v_s=0.05, sigma0=1e4, lag=0.004, dwell=0.3)


def test_a_steady_motion_breaks_away_and_settles():
    """From long rest: a spring up to F_s, then full stiction until the lag has seen the velocity."""
    v, start = 0.02, 1.5 / 1e4 / 0.02
    run = prescribe(ARMSTRONG, velocity=Ramp(0.0, v), times=np.array([0.5, 0.999]) * start)
    np.testing.assert_allclose(run.F_f, 1e4 * run.x, rtol=1e-13)
    run = prescribe(ARMSTRONG, velocity=Ramp(0.0, v), times=[1.001 * start, 0.02])
    np.testing.assert_allclose(run.F_f, 1.0 + 0.2 * v + 0.5 / (1.0 + (v / 0.05) ** 2), rtol=1e-13)


@pytest.mark.parametrize("frequency", [0.5, 2.0, 10.0])
def test_a_swinging_velocity_sees_friction_late(frequency):
    """Friction is larger while v grows, as R. Hess and A. Soom measured, J. Tribology 112 (1990) 147."""
    run = prescribe(ARMSTRONG, velocity=Sine(0.04, frequency, 0.06), t_end=3.0, times=np.linspace(1.0, 3.0, 401))
    late = 0.06 + 0.04 * np.sin(2.0 * np.pi * frequency * (run.t - 0.004))
    np.testing.assert_allclose(run.F_f, 1.0 + 0.2 * run.v + 0.5 / (1.0 + (late / 0.05) ** 2), rtol=1e-12)
    grows = np.cos(2.0 * np.pi * frequency * run.t) > 0.1
    falls = np.cos(2.0 * np.pi * frequency * run.t) < -0.1
    middle = np.abs(run.v - 0.06) < 0.01
    assert run.F_f[grows & middle].mean() > run.F_f[falls & middle].mean()


@pytest.mark.parametrize("waited", [0.003, 0.03, 0.3, 3.0, 300.0])
def test_stiction_grows_with_the_time_of_rest(waited):
    """It breaks away at F_c + P_a + (F_s − F_c − P_a)·t_2/(t_2 + dwell), but for 5 mN from sample to sample."""
    fast, slow = 1.0, 1e-3
    law = Armstrong(F_c=1.0, F_s=1.5, F_v=0.0, v_s=0.05, sigma0=1e6, dwell=0.3)
    run = prescribe(
        law, velocity=Steps([0.0, 1.0, 1.0 + waited], [fast, 0.0, slow]), t_end=1.1 + waited,
        times=1.0 + waited + np.linspace(0.0, 0.1, 20_001),
    )  # fmt: skip
    left = 0.5 / (1.0 + (fast / 0.05) ** 2)  # the velocity jumps to 0: P_a is that of the sliding
    rest = run.t[run.F_f.argmax()] - 1.0
    foretold = 1.0 + left + (0.5 - left) * rest / (rest + 0.3)
    assert foretold - 0.005 <= run.F_f.max() <= foretold + 1e-12


def test_what_no_law_has_is_refused():
    with pytest.raises(InputError, match=r"model\.F_s: below F_c"):
        Armstrong(F_s=0.5)
    with pytest.raises(InputError, match=r"model\.lag: too small"):
        Armstrong(lag=-1.0)
    with pytest.raises(InputError, match="no bristles"):
        prescribe(ARMSTRONG, velocity=Ramp(), z0=1.0)
