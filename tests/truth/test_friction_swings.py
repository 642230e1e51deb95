"""Swings by harmonic balance against runs from event to event, and against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad

from friction import PID, Coulomb, Dahl, InputError, Karnopp, Ramp, Testbench, harmonic_damping, simulate, swings


@pytest.mark.parametrize("v", [0.01, 0.1, 3.0])
def test_damping_is_the_first_harmonic_of_friction(v):
    law = Karnopp(F_c=1.0, F_s=1.7, F_v=0.3, v_s=0.1)
    first, _ = quad(lambda x: law.steady_force(v * np.sin(x)) * np.sin(x), 0.0, np.pi, epsabs=1e-13, limit=200)
    assert harmonic_damping(law, v) == pytest.approx(2.0 * first / (np.pi * v), rel=1e-10)


def test_a_continuous_controller_by_hand():
    """ω = √(P/m) and N(V) = I·m/P − D."""
    (found,) = swings(Coulomb(F_c=2.0, F_v=0.5), Testbench(Ramp(0.0), 2.0, controller=PID(50.0, 200.0, 3.0)))
    assert found == pytest.approx((4.0 * 2.0 / (np.pi * 4.5) / 5.0, 2.0 * np.pi / 5.0, False), rel=1e-12)
    assert swings(Coulomb(), Testbench(Ramp(0.0), controller=PID(50.0, 100.0, 3.0))) == []


@pytest.mark.parametrize(("law", "pid"), [
    (Karnopp(0.2, 0.3, 0.6, 0.05), PID(100.0, limit=10.0, period=0.02, delay=0.03, target=0.5)),
    (Karnopp(0.2, 0.3, 1.0, 0.05), PID(100.0, 20.0, 2.0, limit=5.0, period=0.01, delay=0.08, target=0.5)),
    (Coulomb(0.1, 0.3), PID(50.0, limit=2.0, period=0.01, delay=0.02, target=0.5)),
])  # fmt: skip
def test_a_late_and_limited_controller_hunts_as_foretold(law, pid):
    """A balance of first harmonics alone: its period is within 10 %, its amplitude within 15 % here."""
    bench = Testbench(Ramp(0.0), controller=pid)
    small, large = swings(law, bench)
    assert (small.attracts, large.attracts) == (False, True)
    cycle = simulate(law, bench, 60.0).cycle
    assert cycle is not None
    assert cycle.slips == 2
    assert cycle.period == pytest.approx(large.period, rel=0.1)
    assert cycle.span == pytest.approx(2.0 * large.amplitude, rel=0.15)


def test_a_controller_whose_swings_none_holds_comes_to_rest():
    law, bench = Karnopp(1.0, 1.5, 0.3, 0.05), Testbench(Ramp(0.0), controller=PID(400.0, 0.0, 5.0, 0.5, limit=6.0))
    assert swings(law, bench) == []
    run = simulate(law, bench, 20.0)
    assert run.cycle is None
    assert run.mode[-1] == 0
    with pytest.raises(InputError, match="no harmonic balance"):
        swings(Dahl(), bench)  # type: ignore[arg-type]
