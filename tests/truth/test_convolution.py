"""Lines that remember, by convolution quadrature, against inverse Laplace of the textbook's formulas by mpmath."""

import mpmath as mp
import numpy as np
import pytest
from lossy_scenes import cable, pipe
from one_line import FAR, one_line

from tline import Scene, simulate

DELAY, PIPE = 1e-9, 36.09 / 1324
SKIN = {"resistance": 60, "frequency": "10 GHz"}
BEHIND = 1 + np.array([0.0101, 0.0203, 0.0717, 0.31, 0.83, 1.37])  # delays
PASSES = 3


def inverse(passes, delay: float, t: float) -> float:
    """Of the sum of exp(-s late) F(s), by Talbot's contour, each pass without its delay."""
    with mp.workdps(30):
        found = [
            mp.invertlaplace(F, mp.mpf(t) - late * delay, method="talbot", degree=40)
            for late, F in passes
            if t > late * delay
        ]
        return float(mp.fsum(found))


def between_resistances(Z, Y, length, delay, source, load):
    """What arrives of a step of 1 V, pass by pass: shapes and how many delays each is late."""

    def passed(k):
        def F(s):
            gamma, zc = mp.sqrt(Z(s)) * mp.sqrt(Y(s)) * length, mp.sqrt(Z(s)) / mp.sqrt(Y(s))
            first = 2 * load / (load + zc) * zc / (zc + source)
            back = (source - zc) / (source + zc) * (load - zc) / (load + zc)
            return first * back**k * mp.exp(-(2 * k + 1) * (gamma - s * delay)) / s

        return F

    return [(2 * k + 1, passed(k)) for k in range(PASSES)]


def off(result, passes, delay, t) -> float:
    return float(np.abs(result.probes["far"].at(t).u - [inverse(passes, delay, float(x)) for x in t]).max())


@pytest.mark.parametrize("tol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("at", [0.0, 0.33371e-9])
def test_a_step_into_skin_effect_from_a_hundredth_of_the_delay_behind_its_front(tol, at):
    """√(R² + k² s) with R = 0 and k = 60/√(π 10 GHz), 250 nH/m, 100 pF/m, 0.2 m."""
    result = simulate(cable({"shape": "step", "to": 1, "at": at}, t_end="4 ns", skin=SKIN), tol=tol)
    k = mp.mpf(60) / mp.sqrt(mp.pi * 10**10)
    passes = between_resistances(
        lambda s: s * mp.mpf("250e-9") + k * mp.sqrt(s), lambda s: s * mp.mpf("100e-12"), mp.mpf("0.2"), DELAY, 25, 100
    )
    t = at + DELAY * np.append(BEHIND, [3.0102, 3.2])
    t = t[t < 4e-9]
    expected = np.array([inverse(passes, DELAY, float(x - at)) for x in t])
    assert result.accuracy.met
    assert result.resolution.convolved
    assert np.abs(result.probes["far"].at(t).u - expected).max() < tol
    before = at + DELAY * np.array([0.5, 0.98, 0.989])
    assert np.abs(result.probes["far"].at(before).u).max() < tol


def test_a_step_into_zielkes_friction_from_a_hundredth_of_the_delay_behind_its_front():
    """s ρ/A I₀/I₂ of R √(s ρ/µ), closed end: cosh(Γl) of the pressure arrives, as 2 exp(-Γl) (1 - exp(-2 Γl) + …)."""
    result = simulate(pipe(t_end=0.1, friction={"kind": "zielke", "viscosity": "0.0347 Pa s"}), tol=1e-6)
    area, rho, speed = mp.pi * mp.mpf("0.0127") ** 2, mp.mpf(878), mp.mpf(1324)

    def gamma(s):
        z = mp.mpf("0.0127") * mp.sqrt(s * rho / mp.mpf("0.0347"))
        return mp.sqrt(s * rho / area * mp.besseli(0, z) / mp.besseli(2, z)) * mp.sqrt(s * area / (rho * speed**2))

    def passed(k):
        return lambda s: 2 * (-1) ** k * mp.exp(-(2 * k + 1) * (gamma(s) * mp.mpf("36.09") - s * PIPE)) / s

    t = PIPE * np.append(BEHIND, [3.0102, 3.4])
    assert result.accuracy.met
    assert off(result, [(2 * k + 1, passed(k)) for k in range(2)], PIPE, t) < 2e-6  # of nearly 2


def rg58(lengths, value, t_end: str, tol: float):
    """Cables one behind the other, between 50 ohm and 75 ohm, and what they see at their end."""
    nodes = ["a", *(f"n{k}" for k in range(1, len(lengths))), "b"]
    return simulate(
        Scene(
            medium="electrical", t_end=t_end,
            lines={
                f"line{k}": {"nodes": nodes[k : k + 2], "length": x, "cable": "RG-58"} for k, x in enumerate(lengths)
            },
            sources={"s": {"at": "a", "kind": "voltage", "value": value, "resistance": 50}},
            loads={"r": {"at": "b", "kind": "resistor", "resistance": 75}}, probes={"far": {"at": "b"}},
        ),
        tol=tol,
    )  # fmt: skip


def passes_of_rg58(result, length):
    """k √s + s L and s (C + K ln((ω₂ + s)/(ω₁ + s))): numbers are those of the cable, the formulas the textbook's."""
    line = result.scene.lines["line0"]
    (skin, _), (insulation, _) = (law.laws for law in (line.losses.exact.series, line.losses.exact.shunt))
    L, C = line.losses.exact.series.storage, line.losses.exact.shunt.storage
    fast, slow = (mp.mpf(float(rate)) for rate in (insulation.fast, insulation.slow))
    assert float(mp.sqrt(mp.mpf(L) / C)) == pytest.approx(50, rel=1e-9)
    delay = mp.mpf(length) * mp.sqrt(mp.mpf(L) * mp.mpf(C))

    def series(s):
        return s * L + mp.sqrt(mp.mpf(skin.surface) ** 2 * s + mp.mpf(skin.loss) ** 2)

    def shunt(s):
        return s * (C + insulation.spread * mp.log((fast + s) / (slow + s)))

    return between_resistances(series, shunt, length, delay, 50, 75), float(delay)


def test_the_step_response_of_a_hundred_metres_of_rg58():
    result = rg58(["100 m"], 1, "1.6 us", 1e-6)
    passes, delay = passes_of_rg58(result, 100)
    assert result.accuracy.met
    assert off(result, passes, delay, delay * np.append(BEHIND, [3.0102, 3.1])) < 1e-6


def test_an_edge_of_a_nanosecond_into_37_and_23_metres_of_rg58():
    """Two cables that are one of 60 m; at any instant, for the edge has no jump."""
    result = rg58(["37 m", "23 m"], {"shape": "ramp", "to": 1, "duration": "1 ns"}, "1 us", 1e-4)
    passes, delay = passes_of_rg58(result, 60)
    ramps = [(late, lambda s, F=F: F(s) / s) for late, F in passes]
    t = np.array([0.3009, 0.3034, 0.30405, 0.3046, 0.31, 0.5, 0.7, 0.9095, 0.911, 0.99]) * 1e-6
    exact = [(inverse(ramps, delay, x) - inverse(ramps, delay, x - 1e-9)) / 1e-9 for x in t.tolist()]
    assert result.accuracy.met
    assert np.abs(result.probes["far"].at(t).u - exact).max() < 1e-4


@pytest.mark.parametrize("tol", [1e-2, 1e-3])
def test_a_slow_ramp_into_a_short_line_costs_what_its_corners_cost(tol):
    """16,000 delays in a thousand slabs, beside both corners and elsewhere, against the sum of all reflections."""
    delay, rise, z0, source, load = 1.25e-9, 5e-6, 50.0, 25.0, 1000.0
    ramp = {"shape": "ramp", "to": 1, "duration": rise}
    scene = one_line("20 us", {"z0": z0, "delay": delay}, ramp, source, load, probes=FAR)
    result = simulate(scene, tol=tol)
    beside = np.linspace(0.0, 40e-9, 401)
    t = np.concatenate([beside, rise + beside, np.linspace(0.0, 20e-6, 401)])
    back = (source - z0) / (source + z0) * (load - z0) / (load + z0)
    first = 2 * load / (load + z0) * z0 / (z0 + source)
    u = sum(first * back**k * np.clip((t - (2 * k + 1) * delay) / rise, 0.0, 1.0) for k in range(40))
    worst = np.abs(result.probes["far"].at(t).u - u).max()
    assert result.accuracy.met
    assert result.resolution.convolved
    assert result.slabs.number < 16_000
    assert worst <= result.accuracy.inside["far"].u
