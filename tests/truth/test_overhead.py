"""Overhead lines over lossy earth, against Carson's integral, its limits and inverse Laplace of the formulas."""

import math

import mpmath
import numpy as np
import pytest
from one_line import FAR, one_line
from scipy.special import ive
from talbot import original

from tline import Scene, simulate
from tline.line.electrical import LIGHT, MU0
from tline.loss import ConstantLoss, EarthReturn, RoundWire, realise

HEIGHT, RADIUS, RESISTIVITY, RESISTANCE, LENGTH = 10.0, 0.01, 100.0, 1e-4, 10e3
INDUCTANCE = MU0 / (2 * math.pi) * math.acosh(HEIGHT / RADIUS)
DELAY = LENGTH / LIGHT
BEHIND = np.array([0.0101, 0.0203, 0.0717, 0.31, 0.83, 1.37, 1.9])  # delays


def carson(q: complex) -> mpmath.mpc:
    """2 ∫ exp(-2x)/(x + sqrt(x² + q²)) dx: his integral over λ = x/h, with q = h sqrt(s µ0/ρ)."""
    parts = [0, abs(q) / 3, 2 * abs(q), 2 * abs(q) + 3, 2 * abs(q) + 20]
    return mpmath.quad(lambda x: 2 * mpmath.exp(-2 * x) / (x + mpmath.sqrt(x * x + q * q)), parts)


@pytest.mark.parametrize("resistivity", [10, 100, 1000])
@pytest.mark.parametrize("height", [5, 10, 30])
def test_the_complex_depth_is_within_three_per_cent_of_carsons_integral(height, resistivity):
    for f in np.logspace(1, 6, 6):
        s = 2j * np.pi * f
        expected = s * MU0 / (2 * np.pi) * complex(carson(height * np.sqrt(s * MU0 / resistivity)))
        found = complex(EarthReturn(height, resistivity).at(s))
        assert abs(found / expected - 1) < 0.026
        assert found.real / expected.real == pytest.approx(1, abs=0.034)
        external = s * MU0 / (2 * np.pi) * np.log(2 * height / RADIUS)
        assert abs((found + external) / (expected + external) - 1) < 0.01


def test_resistance_at_low_frequency_is_carsons():
    """ω µ0/8, whatever the height and the earth."""
    w = 2 * np.pi * 1e-6
    assert EarthReturn(HEIGHT, RESISTIVITY).at(1j * w).real == pytest.approx(w * MU0 / 8, rel=1e-4)


def test_at_high_frequency_the_current_is_below_the_wire_in_the_skin_of_the_earth():
    s = 2e13j * np.pi
    surface = np.sqrt(s * MU0 * RESISTIVITY) / (2 * np.pi * HEIGHT)
    assert abs(EarthReturn(HEIGHT, RESISTIVITY).at(s) / surface - 1) < 1e-3


@pytest.mark.parametrize("s", [1.0, 1e5 + 3e4j, 1e6j, -1e4 + 1e5j])
def test_earth_is_relaxations_of_positive_strength(s):
    """s ∫ r(x)/(s + x) dx, in x = exp(v), with r(x) = µ0/2π² arctan(sqrt(ρ/(x µ0))/h) > 0."""

    def density(v):
        x = mpmath.exp(v)
        return mpmath.atan(mpmath.sqrt(RESISTIVITY / (x * MU0)) / HEIGHT) * x / (s + x)

    found = s * MU0 / (2 * mpmath.pi**2) * mpmath.quad(density, range(-40, 121, 8))
    assert abs(complex(found) / complex(EarthReturn(HEIGHT, RESISTIVITY).at(s)) - 1) < 1e-10


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_its_circuits_are_proved_positive_real_and_within_the_tolerance(tolerance):
    law = EarthReturn(HEIGHT, RESISTIVITY) + ConstantLoss(0, INDUCTANCE)
    found = realise(law, (10, 1e6), tolerance)
    assert found.verdict.status == "proved"
    assert found.errors(np.logspace(1, 6, 777)).max() < 1.05 * tolerance


def series(s):
    """Wire, field and earth."""
    z = RADIUS * np.sqrt(s * MU0 / (np.pi * RADIUS**2 * RESISTANCE))
    depth = np.sqrt(RESISTIVITY / (s * MU0))
    wire = RESISTANCE / 2 * z * ive(0, z) / ive(1, z)
    return wire + s * INDUCTANCE + s * MU0 / (2 * np.pi) * np.log((HEIGHT + depth) / HEIGHT)


def answer(t: float, source: float, load: float, waveform) -> float:
    """At the far end, pass by pass, each without its delay."""

    def passed(k, s):
        z, y = np.sqrt(series(s)), np.sqrt(s / (INDUCTANCE * LIGHT**2))
        zc = z / y
        first = 2 * load / (load + zc) * zc / (zc + source)
        back = (source - zc) / (source + zc) * (load - zc) / (load + zc)
        return first * back**k * np.exp(-(2 * k + 1) * (z * y * LENGTH - s * DELAY)) * waveform(s)

    passes = [k for k in range(2) if t > (2 * k + 1) * DELAY]
    return sum(original(lambda s, k=k: passed(k, s), t - (2 * k + 1) * DELAY) for k in passes)


def overhead(value) -> Scene:
    """10 km between 300 and 600 ohm."""
    line = {"length": "10 km", "height": "10 m", "wire_diameter": "2 cm", "earth": "100 ohm m"}
    return one_line("120 us", line | {"wire": {"resistance": "0.1 ohm/km"}}, value, 300, 600, probes=FAR)


@pytest.mark.parametrize("tol", [1e-4, 1e-6])
def test_a_step_into_ten_kilometres_of_overhead_line(tol):
    scene = overhead({"shape": "step", "to": 1})
    result = simulate(scene, tol=tol)
    t = DELAY * np.append(1 + BEHIND, [3.0102, 3.2, 3.5])
    expected = [answer(float(x), 300, 600, lambda s: 1 / s) for x in t]
    assert scene.lines["line"].parameters.delay == pytest.approx(DELAY, rel=1e-12)
    assert result.accuracy.met
    assert result.resolution.convolved
    assert np.abs(result.probes["far"].at(t).u - expected).max() < tol


def test_a_ramp_into_ten_kilometres_of_overhead_line():
    rise = 1.2e-6
    result = simulate(overhead({"shape": "ramp", "to": 1, "duration": rise}), tol=1e-6)
    t = DELAY * np.append(1 + BEHIND[3:], [3.3, 3.5])

    def ramp(x):
        return answer(x, 300, 600, lambda s: 1 / s**2) / rise

    expected = [ramp(float(x)) - ramp(float(x) - rise) for x in t]
    assert result.accuracy.met
    assert np.abs(result.probes["far"].at(t).u - expected).max() < 1e-6


def test_a_step_in_segments_by_circuits_of_the_laws():
    scene = overhead({"shape": "step", "to": 1}).with_changes(solver={"order": 6, "slab": DELAY / 32})
    result = simulate(scene)
    t = DELAY * np.append(1 + BEHIND[3:], [3.2, 3.5])
    expected = [answer(float(x), 300, 600, lambda s: 1 / s) for x in t]
    assert not result.resolution.convolved
    assert np.abs(result.probes["far"].at(t).u - expected).max() < 1e-6


def test_the_laws_of_the_line_are_wire_earth_and_field():
    exact = overhead(1).lines["line"].losses.exact
    law = EarthReturn(HEIGHT, RESISTIVITY) + RoundWire.of_resistance(RADIUS, RESISTANCE) + ConstantLoss(0, INDUCTANCE)
    s = 2j * np.pi * np.logspace(0, 6, 7)
    np.testing.assert_allclose(exact.series.at(s), law.at(s), rtol=1e-12)
    np.testing.assert_allclose(exact.series.at(s), series(s), rtol=1e-12)
