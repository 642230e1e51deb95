"""What runs of bristle laws tell of their errors, against references that share no code with them."""

import numpy as np
import pytest
from friction_by_scipy import reference as by_scipy
from friction_scales import FORCES, judge, random_case, true_errors
from friction_series import reference

from friction import Dahl, ElastoPlastic, LuGre, Ramp, Sine, Status, Table, Testbench, simulate

SLOW = LuGre(v_s=1.8, sigma0=6e4, sigma1=330.0)
NOISE = Table(np.linspace(0.0, 9.0, 200).tolist(), (1e-5 * np.random.default_rng(1).normal(size=200)).tolist())


@pytest.mark.parametrize(("force", "tol"), [(Ramp(0.08), 1e-2), (Ramp(1e-4), 0.1), (NOISE, 1e-2)])
def test_motion_that_is_small_against_v_s_is_as_good_as_told(force, tol):
    bench = Testbench(force, mass=45.0)
    run = simulate(SLOW, bench, tol=tol)
    true = true_errors(run, reference(SLOW, bench, run.t))
    assert run.status is Status.DONE
    assert max(true.values()) <= tol
    assert all(true[name] <= 3.0 * run.errors[name] + 1e-12 for name in true)


def test_told_errors_do_not_depend_on_where_one_looks():
    """An oscillation that both of two runs lose is over at the end."""
    bench = Testbench(Ramp(1e-4), mass=45.0)
    told = simulate(SLOW, bench, tol=0.1, times=[10.0]).errors
    assert told["v"] > 0.1 * simulate(SLOW, bench, tol=0.1).errors["v"]


def test_runs_over_wide_scales_are_as_good_as_told():
    runs = [judge(n, seed=32) for n in range(120)]
    assert sum(run.status is Status.DONE for run, _, _ in runs) >= 115
    assert max(share for run, share, _ in runs if run.status is Status.DONE) <= 1.0
    assert max(over for run, _, over in runs if run.status is Status.DONE) <= 3.0


@pytest.mark.parametrize(
    ("model", "bench"),
    [
        (LuGre(sigma0=1e3, sigma1=20.0), Testbench(Sine(1.5, 1.0))),
        (Dahl(sigma0=1e3), Testbench(Ramp(0.6, 0.1), v0=-0.3)),
        (ElastoPlastic(sigma0=1e3, sigma1=5.0, z_ba=6e-4), Testbench(Sine(1.4, 2.0), 0.5)),
    ],
)
def test_the_reference_agrees_with_scipys(model, bench):
    times = np.linspace(0.0, 2.0, 41)
    series, other = reference(model, bench, times), by_scipy(model, bench, times)
    assert np.all(np.abs(series - other) <= 1e-9 * np.abs(other).max(axis=0))


def test_cases_cover_the_scales():
    cases = [random_case(np.random.default_rng((31, n)), FORCES[n % len(FORCES)]) for n in range(600)]
    v_s = [getattr(model, "v_s", 1.0) for model, *_ in cases]
    masses, tols = [bench.mass for _, bench, *_ in cases], [tol for *_, tol in cases]
    assert min(v_s) < 2e-3 < 50.0 < max(v_s)
    assert min(masses) < 0.02 < 500.0 < max(masses)
    assert min(tols) < 2e-9 < 0.05 < max(tols)
