"""Runs grow at the rates, and from the boundaries on, that theory predicts without running anything."""

import numpy as np
import pytest

from tline.errors import InputError
from tline.study.baseline import BASELINES
from tline.study.charts.growth import compare, exact, light_line
from tline.study.charts.maps import MAPS, rate
from tline.study.charts.stability import QUICK, stability


def strip(name: str, label: str):
    return next(strip for strip in MAPS[name](QUICK).strips if strip.label == label)


@pytest.mark.parametrize(
    ("name", "label", "stable", "unstable"),
    [
        ("courant", "upwind", 0.98, 1.02),
        ("courant", "Lax-Wendroff", 0.98, 1.02),
        ("courant", "FDTD leapfrog", 0.98, 1.02),
        ("load_rate", "forward Euler", 1.95, 2.05),
        ("fraction", "MOC, linear", 0.02, -0.02),
        ("fraction", "MOC, linear", 0.98, 1.02),
        ("fraction", "MOC, cubic", 0.02, -0.02),
        ("fraction", "MOC, cubic", 0.98, 1.02),
        ("order_pointwise", "s = 3", 0.48, 0.5),
        ("order_pointwise", "s = 4", 0.42, 0.4),
        ("order_pointwise", "s = 8", 0.47, 0.43),
        ("loop_gain", "MOC, Courant 1", 0.98, 1.02),
        ("loop_gain", "FDTD leapfrog", 0.6, 0.65),
        ("loop_gain", "slabs, s = 5", 0.98, 1.02),
    ],
)
def test_a_method_fails_beyond_its_boundary_and_not_before(name, label, stable, unstable):
    chosen, level = strip(name, label), MAPS[name](QUICK).level
    assert rate(*chosen.run(stable)) <= level
    grown = rate(*chosen.run(unstable))
    assert grown > level
    assert grown == pytest.approx(chosen.predict(unstable), rel=0.15)  # where several waves grow, they beat


@pytest.mark.parametrize("x", [0.6, 1.0, 1.7])
def test_forward_euler_makes_a_passive_load_active(x):
    """Beside a lossless line it grows at every step, however small: |R| > 1 at the Nyquist frequency."""
    chosen = strip("load_rate", "forward Euler, lossless source")
    assert chosen.predict(x) > 0.05
    assert rate(*chosen.run(x)) == pytest.approx(chosen.predict(x), rel=0.03)


@pytest.mark.parametrize("x", [0.7, 1.3])
@pytest.mark.parametrize("label", ["slabs, s = 1", "slabs, s = 5", "slabs, s = 8"])
def test_slabs_reproduce_true_growth(label, x):
    """ln|H_s H_2|/(2T) of a negative resistance."""
    assert rate(*strip("loop_gain", label).run(x)) == pytest.approx(np.log(x) / 2, rel=1e-3)


def test_sections_explode_beside_any_negative_resistance():
    """Far beyond the true growth of ln(1.3)/2: the chain's own eigenvalue, where its impedance tends to infinity."""
    chosen = strip("loop_gain", "T sections")
    assert chosen.predict(1.3) > 10
    assert rate(*chosen.run(1.3)) == pytest.approx(chosen.predict(1.3), rel=0.02)


@pytest.mark.parametrize("f", [0.1, 0.37, 0.5, 0.83])
@pytest.mark.parametrize("s", [2, 5, 8])
def test_projection_stays(s, f):
    chosen = strip("order_projected", f"s = {s}")
    assert abs(chosen.predict(f)) < 1e-12
    assert rate(*chosen.run(f)) < 2e-3  # 300 transits, of which the later half is seen


def test_a_map_knows_its_boundaries():
    with pytest.raises(InputError, match="map: unknown, expected courant or load_rate"):
        stability("curant")
    rows = stability("fraction", quick=True).differences()
    assert max(difference for *_, difference in rows) < 0.02
    assert {label for label, predicted, *_ in rows if np.isnan(predicted)} == {
        "slabs, s = 1",
        "slabs, s = 5",
        "slabs, s = 8",
    }


def test_the_pulse_that_errors_are_counted_against():
    """MOC at Courant 1 is exact on this line, and so the formula must agree with it."""
    scene = light_line(100)
    t, u, _ = BASELINES["moc_trapezoid"].run(scene, 16)
    for m in (0, 7, 49):
        window = slice(32 * m, 32 * (m + 1))
        assert np.abs(u["far"][window] - exact(scene, t[window])).max() < 1e-13


def test_damping_phase_and_dispersion_are_told_apart():
    t = np.arange(64) / 32
    wave = np.exp(2 * np.cos(np.pi * t))
    assert compare(wave, wave) == pytest.approx((0, 0, 0, 0), abs=1e-12)
    error, damping, phase, dispersion = compare(0.5 * np.roll(wave, 4), wave)
    assert (damping, phase) == pytest.approx((0.5, 0.125), abs=1e-12)
    assert dispersion < 1e-12 < 0.5 < error
    assert compare(wave + 0.1 * np.cos(9 * np.pi * t), wave)[3] > 0.01
