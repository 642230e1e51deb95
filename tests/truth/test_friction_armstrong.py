"""Armstrong's law: dwell and lag against closed forms of its paper's equations."""

import numpy as np
import pytest

from friction import Armstrong, InputError, Ramp, Sine, Steps, prescribe

LAW = Armstrong(F_c=1.0, F_s=1.5, F_v=0.2, v_s=0.05, sigma0=1e4, lag=0.004, dwell=0.3)


def test_a_steady_motion_breaks_away_and_settles():
    """From long rest: a spring up to F_s, then full stiction until the lag has seen the velocity."""
    v, start = 0.02, 1.5 / 1e4 / 0.02
    run = prescribe(LAW, velocity=Ramp(0.0, v), times=np.array([0.5, 0.999]) * start)
    np.testing.assert_allclose(run.F_f, 1e4 * run.x, rtol=1e-13)
    run = prescribe(LAW, velocity=Ramp(0.0, v), times=[1.001 * start, 0.02])
    np.testing.assert_allclose(run.F_f, 1.0 + 0.2 * v + 0.5 / (1.0 + (v / 0.05) ** 2), rtol=1e-13)


@pytest.mark.parametrize("frequency", [0.5, 2.0, 10.0])
def test_a_swinging_velocity_sees_friction_late(frequency):
    """Friction is larger while v grows, as R. Hess and A. Soom measured, J. Tribology 112 (1990) 147."""
    run = prescribe(LAW, velocity=Sine(0.04, frequency, 0.06), t_end=3.0, times=np.linspace(1.0, 3.0, 401))
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
        prescribe(LAW, velocity=Ramp(), z0=1.0)
