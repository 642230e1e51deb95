"""Laws against published numbers, other formulas for the same, and mpmath."""

import math

import mpmath
import numpy as np
import pytest
from flint import acb, ctx
from scipy.special import bei, beip, ber, berp

from tline.line.electrical import MU0
from tline.loss import (
    ChangingLaminarFriction,
    ConstantLoss,
    DielectricLoss,
    LaminarFriction,
    LossyLine,
    RoundWire,
    SkinEffect,
    TurbulentFriction,
    hagen_poiseuille,
    kelvin_voigt_wall,
    realise,
    smooth_pipe_resistance,
)

UNIT = LaminarFriction(density=math.pi, viscosity=math.pi, radius=1)  # ρ/A = ν = R = 1


def value(law, s, digits=30):
    """F(s) for mpmath."""
    with ctx.workprec(5 * digits):
        point = acb(str(s.real), str(s.imag)).mid()
    ball = law.at_precision(point, digits)
    return mpmath.mpc(*(str(part.mid().str(digits + 5, radius=False)) for part in (ball.real, ball.imag)))


def weighting(law, tau):
    """W(τ): s W(s) is a quarter of what friction adds to the steady one, in units where ρ/A = ν = R = 1."""
    with mpmath.workdps(30):
        return mpmath.invertlaplace(lambda s: (value(law, s) - s - law.loss) / (4 * s), tau, method="talbot", degree=24)


@pytest.mark.parametrize("tau", [0.05, 0.1, 0.2])
def test_zielkes_exponentials(tau):
    # the first was printed too low, as 26.3744: the zero of J2 is 5.13562, its square 26.3746
    rates = [26.3744, 70.8493, 135.0198, 218.9216, 322.5544]
    assert float(weighting(UNIT, tau)) == pytest.approx(sum(math.exp(-n * tau) for n in rates), rel=5e-5)


@pytest.mark.parametrize("tau", [1e-5, 1e-4, 1e-3])
def test_zielkes_powers(tau):
    m = [0.282095, -1.25, 1.057855, 0.9375, 0.396696, -0.351563]
    published = sum(m[i] * tau ** ((i - 1) / 2) for i in range(6))
    assert float(weighting(UNIT, tau)) == pytest.approx(published, rel=3e-6)  # 6 digits


@pytest.mark.parametrize("womersley", [0.1, 1, 3.34, 10, 100])
def test_womersleys_bessel_functions_of_the_first_kind(womersley):
    z = womersley * mpmath.exp(0.75j * mpmath.pi)
    s = 1j * womersley**2
    expected = s / (1 - 2 * mpmath.besselj(1, z) / (z * mpmath.besselj(0, z)))
    assert abs(complex(UNIT.at(s)) / complex(expected) - 1) < 1e-13


def test_the_first_relaxations_of_laminar_friction_are_the_zeros_of_j2():
    """The exact sum has rates j² for the zeros of J2 and strengths 4; those below the band's top are found."""
    found = realise(UNIT, (0.1, 1e3), 1e-9).circuit
    rates = [float(mpmath.besseljzero(2, k)) ** 2 for k in (1, 2)]
    np.testing.assert_allclose(found.rates[:2], rates, rtol=1e-6)
    np.testing.assert_allclose(found.strengths[:2], 4, rtol=1e-5)


@pytest.mark.parametrize("over_depth", [0.1, 1, 3, 20])
def test_a_round_wire_by_kelvin_functions(over_depth):
    """Ramo, Whinnery, Van Duzer (1994)."""
    q = math.sqrt(2) * over_depth
    wire = RoundWire(1, 1, 1)
    s = 2j * over_depth**2  # radius over skin depth sqrt(2/(ω µ σ))
    expected = q / 2 / math.pi * (ber(q) + 1j * bei(q)) / (beip(q) - 1j * berp(q))
    assert abs(wire.at(s) / expected - 1) < 1e-12


def test_a_round_wire_at_both_ends_of_the_spectrum():
    wire = RoundWire(radius=1e-3, conductivity=5.8e7)
    low, high = 1.0, 1e15
    assert wire.at(1j * low).imag / low == pytest.approx(MU0 / (8 * math.pi), rel=1e-8)
    depth = math.sqrt(2 / (high * MU0 * 5.8e7))
    surface = 1 / (5.8e7 * depth * 2 * math.pi * 1e-3)
    assert abs(wire.at(1j * high) / (surface * (1 + 1j)) - 1) < 1.1 * depth / (2e-3)  # a/δ + 1/4 + ...


def test_skin_effect_at_both_ends_of_the_spectrum():
    law = SkinEffect(resistance=2, surface=3e-4)
    assert law.at(0) == 2
    f = 1e18
    assert law.at(2j * math.pi * f).real == pytest.approx(3e-4 * math.sqrt(math.pi * f), rel=1e-9)


SMOOTH = 1 / (2 * math.sqrt(math.pi))


@pytest.mark.parametrize(
    ("reynolds", "roughness", "A", "B"),
    [
        (2e3, 0.0, SMOOTH, 2e3 ** math.log10(15.29 / 2e3**0.0567) / 12.86),
        (1e8, 0.0, SMOOTH, 1e8 ** math.log10(15.29 / 1e8**0.0567) / 12.86),
        (1e5, 2e-3, SMOOTH, 1e5 ** math.log10(15.29 / 1e5**0.0567) / 12.86),  # Re·ε/d·sqrt(f/8) is 5
        (1e6, 2e-2, 0.0103 * 1e3 * 1e-2**0.39, 0.352 * 1e6 * 1e-2**0.41),  # and 690
    ],
)
def test_turbulent_friction_is_the_transform_of_its_weighting_function(reynolds, roughness, A, B):
    law = TurbulentFriction(math.pi, math.pi, 1, reynolds, roughness)
    for s in (1.0, 100.0, 1e4):
        weighted = lambda root, s=s: 2 * A * mpmath.exp(-(B + s) * root**2)  # noqa: E731
        W = mpmath.quad(weighted, [0, 1 / math.sqrt(B + s), mpmath.inf])  # over sqrt(τ)
        assert complex(law.at(s)).real == pytest.approx(float(s + 4 * s * W), rel=1e-12)


def test_laminar_friction_is_the_steady_part_and_what_changes_add():
    water = {"density": 1000, "viscosity": 1e-3, "radius": 0.01}
    s = np.array([1e-6, 1e-2, 1.0, 30j, 1e3 + 1e5j])
    whole, steady = LaminarFriction(**water).at(s), hagen_poiseuille(**water).loss
    assert ChangingLaminarFriction(**water).at(s) == pytest.approx(whole - steady, rel=1e-12, abs=1e-12 * steady)


@pytest.mark.parametrize(("reynolds", "published"), [(1e4, 0.0309), (1e5, 0.0180), (1e6, 0.0116), (1e7, 0.0081)])
def test_slope_of_prandtls_law(reynolds, published):
    """Friction factors: F. M. White, Fluid Mechanics, table of smooth-pipe friction factors, to the digits printed."""

    def factor(Re):
        return mpmath.findroot(lambda x: x - 2 * mpmath.log10(Re / x) + 0.8, 8) ** -2

    assert float(factor(reynolds)) == pytest.approx(published, abs=6e-5)

    def gradient(Q):  # ρ = 1000, µ = 1e-3, R = 0.01
        V = Q / (math.pi * 1e-4)
        return factor(V * 0.02 / 1e-6) * 1000 * V * V / 0.04

    with mpmath.workdps(30):
        slope = mpmath.diff(gradient, reynolds * 1e-6 / 0.02 * math.pi * 1e-4)
    assert smooth_pipe_resistance(1000, 1e-3, 0.01, reynolds) == pytest.approx(float(slope), rel=1e-10)


def test_dielectric_loss_is_flat_and_falls_as_causality_asks():
    law = DielectricLoss(1e-10, 0.02, 1e9, (1e4, 1e14))
    f = np.geomspace(1e7, 1e11, 41)
    c = law.at(2j * np.pi * f) / (2j * np.pi * f)
    assert np.abs(c.imag / (-0.02 * 1e-10) - 1).max() < 2e-3  # ends of its band are three decades away
    per_decade = (c.real[0] - c.real[-1]) / 4
    assert per_decade == pytest.approx(2 / math.pi * math.log(10) * 0.02 * 1e-10, rel=0.002)


def test_dielectric_loss_is_its_sum_of_relaxations():
    law = DielectricLoss(1e-10, 0.02, 1e9, (1e6, 1e11))
    s = mpmath.mpc(0, 3e9)
    edges = [2 * math.pi * 10**k for k in range(6, 12)]
    relaxed = mpmath.quad(lambda p: 1 / (s + p), edges) * law.spread
    assert abs(complex(law.at(3e9j)) / complex(s * (law.storage + relaxed)) - 1) < 1e-12


def test_the_creep_of_a_wall_under_a_steady_pressure():
    """Y/s² is the volume taken up per metre under a unit step of pressure: C + A ψ d/e Σ J (1 - exp(-t/τ))."""
    creep = [(1e-10, 0.05), (1.1e-10, 0.5)]
    wall = kelvin_voigt_wall(1.2e-11, 0.025, 6e-3, creep, restraint=0.8)
    for t in (0.01, 0.3, 2.0):
        with mpmath.workdps(30):
            found = mpmath.invertlaplace(lambda s: value(wall, s) / s**2, t, method="talbot", degree=30)
        strain = sum(J * -math.expm1(-t / tau) for J, tau in creep) * 0.8 * 0.05 / (2 * 6e-3)
        expected = 1.2e-11 + 2 * strain * math.pi * 0.025**2
        assert float(found) == pytest.approx(expected, rel=1e-12)


def test_a_low_loss_line_attenuates_by_half_the_resistance_over_z0():
    line = LossyLine(ConstantLoss(1e-3, 250e-9), ConstantLoss(1e-7, 100e-12), 1)
    gamma, zc = line.gamma(1e10j), line.zc(1e10j)
    assert gamma.real == pytest.approx(1e-3 / 100 + 1e-7 * 50 / 2, rel=1e-9)
    assert gamma.imag == pytest.approx(1e10 * 5e-9, rel=1e-9)
    assert abs(zc - 50) < 1e-4


def test_the_chain_matrix_against_mpmath():
    wire = RoundWire(0.5e-3, 5.8e7) + ConstantLoss(0, 250e-9)
    line = LossyLine(wire, DielectricLoss(1e-10, 0.02, 1e9, (1e4, 1e12)), 0.7)
    s = 3e9j
    z, y = complex(wire.at(s)), complex(line.shunt.at(s))
    total, zc = mpmath.sqrt(z * y) * 0.7, mpmath.sqrt(z / y)
    expected = [[mpmath.cosh(total), zc * mpmath.sinh(total)], [mpmath.sinh(total) / zc, mpmath.cosh(total)]]
    np.testing.assert_allclose(line.chain(s), np.array(expected, complex), rtol=1e-12)
