"""Statistical eyes against bits that are added up one by one, equalisers against their definitions."""

import itertools
from math import erfc, sqrt

import numpy as np
import pytest
from one_line import FAR, one_line
from rc_channel import LATE, RC, T, exact_pulse
from scipy.integrate import solve_ivp
from scipy.stats import binom, norm

from tline import InputError
from tline.signal import Mask, best_ffe, mask_margin, statistical_eye
from tline.signal.bits import FEEDBACK, FINE, prbs
from tline.signal.pulse import PulseResponse, pulse_response


def bits_at(pulse, bits, j):
    """What is seen of each bit at an instant after its begin, in instants of the pulse."""
    cursors = pulse.u.ravel()[j % FINE :: FINE]
    return np.convolve(bits, cursors)[j // FINE :][: len(bits)]


def test_a_scene_gives_the_pulse_of_its_closed_form():
    """A matched line into a capacitor beside its matched end: RC of 25 ohm."""
    loads = {
        "r": {"at": "far", "kind": "resistor", "resistance": 50},
        "c": {"at": "far", "kind": "capacitor", "capacitance": RC / 25},
    }
    scene = one_line(1, {"z0": 50, "delay": LATE}, 0, 50, loads=loads, probes=FAR)
    seen, exact = pulse_response(scene, "far", T, 20e-12, low=-0.5, high=1.5, tol=1e-8), exact_pulse()
    assert np.abs(seen.u[:12] - exact.u).max() < 1e-6
    assert seen.base == pytest.approx(-0.25, abs=1e-6)
    assert abs(seen.missing) < 1e-6


@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_error_rates_are_those_of_bits_one_by_one(noise):
    """A million bits at three instants: counts of 1e4 and more are good to four standard deviations, 4 %."""
    rng, pulse = np.random.default_rng(3), exact_pulse()
    bits = rng.integers(0, 2, 1_000_000)
    seen = statistical_eye(pulse, 1e-2, noise=noise)
    j0 = round(seen.instant / T * FINE)
    for k in (-20, 0, 18):
        u = bits_at(pulse, bits, j0 + k)[20:-20] + noise * rng.normal(size=len(bits) - 40)
        sent = bits[20:-20] > 0
        at = FINE // 2 + k
        low = np.quantile(u[sent], 0.01)
        assert seen.ones[at] == pytest.approx(low, abs=2e-3)  # a level is some 1e-3 wide
        wrong = ((u > seen.threshold) != sent).mean()
        if wrong > 1e-2:
            assert seen.bathtub[at] == pytest.approx(wrong, rel=0.04)
        else:
            assert seen.bathtub[at] <= wrong + 4e-4


def test_far_tails_are_those_of_all_patterns():
    """16 cursors make 65,536 patterns, each with its normal tail: the error rate is their mean, down to 1e-12."""
    rng = np.random.default_rng(5)
    h = np.append(1.0, rng.uniform(-0.05, 0.05, 16))
    pulse = PulseResponse(T, np.repeat(h[:, None], FINE, 1), 0.0, 0.0)
    noise = 0.04
    isi = np.array(list(itertools.product([-0.5, 0.5], repeat=16))) @ h[1:]
    at = lambda v: np.mean([erfc((v + x) / noise / sqrt(2)) / 2 for x in isi])  # noqa: E731
    seen = statistical_eye(pulse, 1e-12, noise=noise)
    assert seen.bathtub[FINE // 2] == pytest.approx(at(0.5), rel=0.05)
    q = (1.0 - seen.height) / 2  # exceeded with a probability of 1e-12
    assert at(q + 2e-3) < 1e-12 < at(q - 2e-3)


@pytest.mark.parametrize("ber", [1e-3, 1e-6, 1e-12])
def test_many_small_cursors_are_a_binomial_distribution(ber):
    """A tail of 200 cursors, each smaller than a level of the density."""
    n, h = 200, 5e-4
    u = np.repeat(np.append(1.0, np.full(n, h)), FINE).reshape(-1, FINE)
    exact = 1 + 2 * h * (binom.ppf(ber, n, 0.5) - n / 2)
    assert statistical_eye(PulseResponse(1e-9, u, 0.0, 0.0), ber).height == pytest.approx(exact, abs=1.5 * h)


def test_without_noise_the_contour_is_that_of_the_worst_pattern():
    """12 cursors: no pattern is rarer than 2^-12, so beyond that nothing happens (Lucky's peak distortion)."""
    pulse = exact_pulse()
    seen = statistical_eye(pulse, 1e-12)
    j0 = round(seen.instant / T * FINE)
    cursors = pulse.u.ravel()[j0 % FINE :: FINE]
    worst = 2 * cursors[j0 // FINE] - np.abs(cursors).sum()
    assert seen.height == pytest.approx(worst, abs=1e-3 * len(cursors))
    assert seen.height <= worst


def test_feedback_takes_its_cursors_away():
    pulse = exact_pulse()
    seen, plain = statistical_eye(pulse, dfe=2), statistical_eye(pulse)
    j = round(seen.instant / T * FINE)
    assert seen.dfe == pytest.approx([pulse.u.ravel()[j + FINE], pulse.u.ravel()[j + 2 * FINE]], rel=1e-12)
    assert seen.height > plain.height + 0.5 * np.abs(seen.dfe).sum()


def test_a_feed_forward_equaliser_sends_sums_of_bits():
    """Bits through the filter, then through the channel."""
    bits = np.random.default_rng(1).integers(0, 2, 500)
    pulse, taps = exact_pulse(), [-0.1, 0.7, -0.2]
    sent = np.convolve(bits, taps)[: len(bits)]
    for j in (200, 300):
        assert bits_at(pulse.with_ffe(taps), bits, j)[:-20] == pytest.approx(bits_at(pulse, sent, j)[:-20], abs=1e-12)


def test_a_linear_equaliser_is_its_differential_equation():
    """(g + s/z)/((1 + s/p)(1 + s/q)) by scipy's integrator, whose input is the pulse between its samples."""
    pulse, (zero, one, two) = exact_pulse(), (1e9, 4e9, 10e9)
    seen = pulse.with_ctle(-6, zero, one, two)
    z, p, q, g = 2 * np.pi * zero, 2 * np.pi * one, 2 * np.pi * two, 10 ** (-6 / 20)
    t, u = np.arange(12 * FINE) / FINE * T, pulse.u.ravel()

    def rates(x, s):  # in units of T: x'' = p q (u - x) - (p + q) x'
        return [s[1] * T, (p * q * (np.interp(x * T, t, u) - s[0]) - (p + q) * s[1]) * T]

    found = solve_ivp(
        rates, (0, 11.9), [0, 0], rtol=1e-9, atol=1e-9, max_step=1 / FINE, t_eval=np.arange(0, 11.9, 0.25)
    )
    exact = g * found.y[0] + found.y[1] / z
    assert seen.u.ravel()[:: FINE // 4][: len(exact)] == pytest.approx(exact, abs=1e-5)


def test_the_tail_of_a_slow_equaliser_is_missing():
    """A triangle two bits wide through (1 + s/z)/(1 + s/w), 64 bits of it: (1 - w/z) e^(-63 w) (sinh(w/2)/(w/2))²."""
    triangle = np.interp(np.arange(64 * FINE) / FINE, [0, 1, 2], [0, 1, 0]).reshape(-1, FINE)
    w, z = 2 * np.pi * 0.01, 2 * np.pi * 0.05
    seen = PulseResponse(1.0, triangle, 0.0, 0.0).with_ctle(0, 0.05, 0.01)
    assert seen.missing == pytest.approx((1 - w / z) * np.exp(-63 * w) * (np.sinh(w / 2) / (w / 2)) ** 2, rel=1e-3)


def test_a_low_pass_is_the_sum_of_its_residues():
    """A triangle two bits wide through 1/(1 - 3.4142 x^2 + x^4 + j(2.6131 x - 2.6131 x^3)), x = f/fr, (93A-20)."""
    triangle, bandwidth = np.interp(np.arange(12 * FINE) / FINE, [0, 1, 2], [0, 1, 0]), 0.75 / T
    seen = PulseResponse(T, triangle.reshape(-1, FINE), 0.0, 0.0).with_low_pass(bandwidth)
    a, b = 1 + sqrt(2) / 2, 2 * np.cos(np.pi / 8) + 2 * np.cos(3 * np.pi / 8)  # 3.4142 = 2 a, 2.6131 = b
    scale = 2 * np.pi * bandwidth * T
    polynomial = np.array([scale**-4, b * scale**-3, 2 * a * scale**-2, b / scale, 1.0])
    p = np.roots(polynomial)
    residues = 1 / np.polyval(np.polyder(polynomial), p)
    t = np.arange(12 * FINE)[:, None] / FINE

    def ramp(t):
        return np.where(t > 0, residues * (np.exp(p * np.maximum(t, 0)) - 1 - p * t) / p**2, 0).sum(axis=1).real

    assert seen.u.ravel() == pytest.approx(ramp(t) - 2 * ramp(t - 1) + ramp(t - 2), abs=1e-9)
    assert np.abs(np.polyval(polynomial, 2j * np.pi * bandwidth * T)) == pytest.approx(sqrt(2), rel=1e-9)
    with pytest.raises(InputError, match="low_pass: not a bandwidth for such bits, expected 1e"):
        seen.with_low_pass("1 Hz")


@pytest.mark.parametrize("dfe", [0, 1])
def test_no_taps_of_a_fine_grid_open_the_eye_wider(dfe):
    pulse = exact_pulse()

    def worst(taps):
        flat = pulse.with_ffe(taps).u
        main = flat.max(0).argmax()
        best = -np.inf
        for j in range(FINE):
            cursors = flat[:, j]
            k = int(cursors.argmax())
            rest = np.delete(np.abs(cursors), slice(k, k + 1 + dfe))
            best = max(best, cursors[k] - rest.sum())
        return best, main

    found = best_ffe(pulse, 1, 1, dfe=dfe)
    assert np.abs(found).sum() == pytest.approx(1)
    grid = [(a, 1 - abs(a) - abs(b), b) for a in np.arange(-0.3, 0.1, 0.02) for b in np.arange(-0.4, 0.1, 0.02)]
    assert worst(found)[0] > max(worst(taps)[0] for taps in grid) - 5e-3  # between the instants that are tried


@pytest.mark.parametrize("order", [7, 9, 11, 15])
def test_a_pattern_has_each_run_of_bits_but_zeros_once(order):
    bits = prbs(order)
    runs = np.convolve(np.append(bits, bits[: order - 1]), 2 ** np.arange(order), "valid")
    assert sorted(runs) == [*range(1, 2**order)]


def test_long_patterns_repeat_their_polynomial():
    for order, back in FEEDBACK.items():
        bits = prbs(order, 2000)
        assert (bits[order:] == bits[:-order] ^ bits[order - back : -back]).all()


def test_what_is_refused():
    with pytest.raises(InputError, match="order: no pseudo-random pattern"):
        prbs(8)
    with pytest.raises(InputError, match="ber: no error rate"):
        statistical_eye(exact_pulse(), 0.7)
    with pytest.raises(InputError, match="noise: out of range"):
        statistical_eye(exact_pulse(), noise=-1.0)
    with pytest.raises(InputError, match="ctle: not an equaliser"):
        exact_pulse().with_ctle(0, 1e9)


def test_the_width_is_where_the_error_rate_is_reached():
    """A triangle alone, in noise: ones are wrong with Q((u - 1/2)/sigma), zeros next to never."""
    noise, ber = 0.05, 1e-3
    pulse = PulseResponse(1e-9, 1 - np.abs(np.arange(-32, 32)[None] / 32), 0.0, 0.0)
    level = 0.5 + noise * norm.isf(2 * ber)
    assert statistical_eye(pulse, ber, noise=noise).width == pytest.approx((1 - level) * 1e-9, abs=0.1e-9 / 64)


SQUARE = PulseResponse(64e-12, np.ones((1, FINE)), 0.0, 0.0)  # instants are 1 ps apart, edges half way between two


def test_gaussian_jitter_reads_other_bits_beyond_an_edge():
    """Half of what is read beyond is wrong: Q(d/sigma)/2 of the distance to either edge, down to 1e-15."""
    seen = statistical_eye(SQUARE, jitter=3e-12)
    t = seen.t * 1e12
    exact = (norm.sf((t + 31.5) / 3) + norm.sf((32.5 - t) / 3)) / 2
    assert seen.bathtub == pytest.approx(exact, rel=0.1)  # of a cell: the tail falls by half in 0.3 ps
    assert seen.width == pytest.approx(64e-12 - 2 * 3e-12 * norm.isf(2e-12), abs=0.1e-12)


def test_sinusoidal_jitter_and_a_distorted_duty_cycle_do_so():
    """The arcsine law, and two edges of which each is there half of the time."""
    swung, t = statistical_eye(SQUARE, sinusoidal=8e-12), np.arange(-32, 33)
    beyond = lambda x: 0.5 - np.arcsin(np.clip(x / 8, -1, 1)) / np.pi  # noqa: E731
    assert swung.bathtub == pytest.approx((beyond(t + 31.5) + beyond(32.5 - t)) / 2, abs=1e-12)
    apart = statistical_eye(SQUARE, duty_cycle=6e-12)
    assert apart.bathtub == pytest.approx(0.25 * (t + 31.5 < 3) + 0.25 * (32.5 - t < 3), abs=1e-12)
    assert apart.width == pytest.approx(64e-12 - 6e-12, abs=1e-12)


def test_neighbours_close_the_eye_as_their_cursors_convolved_by_hand():
    """Four sums of two cursors around their mean, each with its normal tail."""
    h, noise = (0.12, -0.3), 0.03
    neighbour = PulseResponse(64e-12, np.repeat(np.array(h)[:, None], FINE, 1), 0.05, 0.0)
    seen = statistical_eye(SQUARE, 1e-9, noise=noise, aggressors=[neighbour])
    isi = np.array([a * h[0] + b * h[1] for a, b in itertools.product((-0.5, 0.5), repeat=2)])
    assert seen.threshold == pytest.approx(0.5 + 0.05 + sum(h) / 2)
    exact = np.mean(norm.sf((0.5 + isi) / noise))
    assert seen.bathtub[FINE // 2] == pytest.approx(exact, rel=0.02)
    up = seen.levels[90] - seen.threshold
    exact = (np.mean(norm.sf((0.5 - up + isi) / noise)) + np.mean(norm.sf((0.5 + up + isi) / noise))) / 2
    assert seen.misread[90] == pytest.approx(exact, rel=0.02)


def test_the_margin_is_that_of_half_a_bit_over_the_tail_of_noise():
    """As of annex 93A where nothing but noise disturbs: 20 log(A_s/(sigma Q^-1(DER)))."""
    seen = statistical_eye(SQUARE, 1e-5, noise=0.04)
    assert seen.margin == pytest.approx(20 * np.log10(0.5 / (0.04 * norm.isf(1e-5))), abs=0.05)
    assert statistical_eye(SQUARE).margin > 50  # a level is a thousandth


def test_a_mask_is_free_by_what_contours_stay_away():
    seen = statistical_eye(SQUARE, aggressors=[PulseResponse(64e-12, np.full((1, FINE), 0.2), 0.0, 0.0)])
    assert seen.height == pytest.approx(0.8, abs=2e-3)
    assert mask_margin(seen, Mask(30e-12, 0.5)) == pytest.approx(0.4 - 0.25, abs=1e-3)
    assert mask_margin(seen, Mask(30e-12, 1.0)) == pytest.approx(-0.1, abs=1e-3)
