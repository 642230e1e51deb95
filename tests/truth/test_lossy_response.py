"""Responses of lossy lines against closed forms, and against mpmath's inverse Laplace transform of other formulas."""

import math
from decimal import Decimal
from fractions import Fraction

import mpmath
import pytest

from tline import InputError, Scene
from tline.loss import ConstantLoss, Foster, LaminarFriction, LossyLine, SkinEffect
from tline.study.reference.lossy import Drive, LossySolution, lossy_response


def close(found, expected, digits):
    return abs(mpmath.mpf(str(found)) - expected) < mpmath.mpf(10) ** -digits


@pytest.mark.parametrize("t", ["0.01", "1", "30"])
def test_an_endless_rc_line_is_a_complementary_error_function(t):
    line = LossyLine(ConstantLoss(2), ConstantLoss(0, 0.5), 400)
    found = lossy_response(line, [t], 1, source=0, load=7, digits=30)
    with mpmath.workdps(50):
        t = mpmath.mpf(t)
        scale = 1 / mpmath.sqrt(mpmath.pi * 4 * t)  # the flow at x = 0 is the largest: sqrt(C/(R π t))
        assert close(found.u[0], mpmath.erfc(1 / (2 * mpmath.sqrt(t))), 29)
        assert close(found.y[0], scale * mpmath.exp(-1 / (4 * t)), 29)


@pytest.mark.parametrize("t", ["0.1", "0.7", "2"])
def test_an_open_rc_line_of_finite_length_is_fouriers_series(t):
    line = LossyLine(ConstantLoss(1), ConstantLoss(0, 1), 1)
    found = lossy_response(line, [t], 1, source=0, load=math.inf, digits=25)
    with mpmath.workdps(40):
        t = mpmath.mpf(t)
        odd = range(1, 80, 2)
        series = sum((-1) ** (n // 2) / mpmath.mpf(n) * mpmath.exp(-((n * mpmath.pi / 2) ** 2) * t) for n in odd)
        assert close(found.u[0], 1 - 4 / mpmath.pi * series, 24)


@pytest.mark.parametrize(("R", "G"), [(2, 0), (40, 0), (6, 2), (0, 3)])
def test_the_telegraph_equation_is_a_bessel_function_behind_the_front(R, G):
    """L = C = 1, unit step at x = 0, seen at x = 1 before anything comes back."""
    line = LossyLine(ConstantLoss(R, 1), ConstantLoss(G, 1), 3)
    times = ["0.999", "1.000001", "1.5", "4"]
    found = lossy_response(line, times, 1, source=0, load=5, digits=25)
    with mpmath.workdps(40):
        rho, sigma = mpmath.mpf(R + G) / 2, mpmath.mpf(R - G) / 2

        def behind(tau):
            root = mpmath.sqrt(tau * tau - 1)
            return mpmath.exp(-rho * tau) * (mpmath.besseli(1, sigma * root) / root if root else sigma / 2)

        assert found.u[0] == 0
        for t, u in zip(times[1:], found.u[1:], strict=True):
            expected = mpmath.exp(-rho) + sigma * mpmath.quad(behind, mpmath.linspace(1, mpmath.mpf(t), 9))
            assert close(u, expected, 24)


def test_the_flow_into_an_endless_line_and_the_impulse_response():
    """With R = 2, L = C = 1: y = exp(-t) I0(t) at x = 0; the impulse response is the slope of the step response."""
    line = LossyLine(ConstantLoss(2, 1), ConstantLoss(0, 1), 40)
    step = lossy_response(line, ["0.5", "3", "20"], 0, source=0, load=1, digits=30)
    impulse = lossy_response(line, ["0.5", "3", "20"], 0, source=0, load=1, drive=Drive.IMPULSE, digits=30)
    ramp = lossy_response(line, ["0.5", "3", "20"], 0, source=0, load=1, drive=Drive.RAMP, digits=25)
    with mpmath.workdps(50):
        for k, t in enumerate(map(mpmath.mpf, ("0.5", "3", "20"))):
            i0, i1 = mpmath.besseli(0, t), mpmath.besseli(1, t)
            assert close(step.y[k], mpmath.exp(-t) * i0, 29)
            assert close(impulse.y[k], mpmath.exp(-t) * (i1 - i0), 29)
            assert close(ramp.y[k], mpmath.exp(-t) * t * (i0 + i1), 23)  # of an effort of 20


def test_a_distortionless_line_only_attenuates():
    """z0 = 2, delay 1.5, exp(-3) from end to end; reflections 1/2 at the load (6) and -1/3 at the source (1)."""
    line = LossyLine(ConstantLoss(2, 1), ConstantLoss(0.5, 0.25), 3)
    found = lossy_response(line, ["1", "2", "4", "5", "7", "8"], 3, source=1, load=6, digits=40)
    with mpmath.workdps(60):
        first = mpmath.mpf(2) / 3 * mpmath.mpf(3) / 2 * mpmath.exp(-3)
        trip = -mpmath.exp(-6) / 6
        sums = [0, first, first, first * (1 + trip), first * (1 + trip), first * (1 + trip + trip**2)]
        assert all(close(u, expected, 40) for u, expected in zip(found.u, sums, strict=True))
        assert all(close(y, expected / 6, 40) for y, expected in zip(found.y, sums, strict=True))


def test_a_lossless_line_is_the_lattice():
    line = LossyLine(ConstantLoss(0, 1), ConstantLoss(0, 1), 1)
    found = lossy_response(line, ["0.5", "2", "4"], 1, source=1 / 2, load=2, digits=30)
    first = Fraction(2, 3) * Fraction(4, 3)
    sums = [Fraction(0), first, first * (1 - Fraction(1, 9))]
    with mpmath.workdps(40):
        expected = [mpmath.mpf(x.numerator) / x.denominator for x in sums]
        assert all(close(u, x, 30) for u, x in zip(found.u, expected, strict=True))


def waves_by_mpmath(series, shunt, length, slowness, passages, source, load, t, digits):
    """Effort at the far end: each passage by mpmath's fixed Talbot contour, laws written anew."""
    with mpmath.workdps(2 * digits):
        t, total = mpmath.mpf(t), mpmath.mpf(0)
        for k in range(passages):
            path = (2 * k + 1) * length

            def transform(s, path=path, k=k):
                z, y = mpmath.sqrt(series(s)), mpmath.sqrt(shunt(s))
                zc = z / y
                both = (source - zc) * (load - zc) / ((source + zc) * (load + zc))
                front = zc / (zc + source) * 2 * load / (load + zc)
                return front * both**k * mpmath.exp(-path * (z * y - s * slowness)) / s

            since = t - path * slowness
            if since > 0:
                total += mpmath.invertlaplace(transform, since, method="talbot", degree=3 * digits)
        return total


def test_a_cable_with_skin_effect_against_mpmath():
    line = LossyLine(SkinEffect(0.5, 0.25) + ConstantLoss(0, 1), ConstantLoss(0.125, 1), 1)
    times = ["1.01", "2.9", "3.5", "6.25"]
    found = lossy_response(line, times, 1, source=0.5, load=3, digits=16)
    for t, u in zip(times, found.u, strict=True):
        expected = waves_by_mpmath(
            lambda s: mpmath.sqrt(0.25 + 0.0625 * s) + s, lambda s: 0.125 + s, 1, 1, 4, 0.5, 3, t, 16
        )
        assert close(u, expected, 15)


def test_a_pipe_with_laminar_friction_and_a_creeping_wall_against_mpmath():
    pipe = LaminarFriction(density=math.pi, viscosity=math.pi / 64, radius=1)
    line = LossyLine(pipe, Foster(0, 1, [0.25], [0.5]), 1)

    def friction(s):  # with the doubles that the law counts as exact
        z = mpmath.sqrt(s * pipe.diffusion_time)
        return pipe.storage * s + mpmath.mpf(pipe.loss) / 4 * z * mpmath.besseli(1, z) / mpmath.besseli(2, z)

    slowness = mpmath.sqrt(mpmath.mpf(pipe.storage))
    found = lossy_response(line, ["1.5", "3.25"], 1, source=0.25, load=10, digits=12)
    for t, u in zip(["1.5", "3.25"], found.u, strict=True):
        expected = waves_by_mpmath(friction, lambda s: s + 0.25 * s / (s + 0.5), 1, slowness, 2, 0.25, 10, t, 12)
        assert close(u, expected, 11)


def test_what_a_step_settles_to_is_the_steady_divider():
    line = LossyLine(ConstantLoss(20, 250e-9), ConstantLoss(0, 100e-12), 0.2)  # 4 ohm
    found = lossy_response(line, [1e-7], 0.2, source=6, load=90, digits=10)
    assert float(found.u[0]) == pytest.approx(0.9, abs=1e-6)


def test_more_digits_confirm_fewer():
    line = LossyLine(SkinEffect(5, 1e-3) + ConstantLoss(0, 250e-9), ConstantLoss(0, 100e-12), 0.2)
    times = [1.001e-9, 3.2e-9, 7e-9]
    few, many = (lossy_response(line, times, 0.1, source=10, load=200, digits=d) for d in (8, 30))
    assert all(abs(a - b) <= Decimal("1e-8") * max(many.u) for a, b in zip(few.u, many.u, strict=True))


def test_a_scene_with_one_lossy_line_adds_up_steps_and_ramps():
    """A trapezoid of 1 V: two ramps up, two down, of the response that is proved above."""
    cable = {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns", "length": "0.2 m", "resistance": 20}
    pulse = {"shape": "pulses", "low": 0, "high": 1, "rise": "0.1 ns", "width": "0.3 ns", "fall": "0.2 ns"}
    scene = Scene(
        medium="electrical",
        t_end="10 ns",
        lines={"line": cable},
        sources={"s": {"at": "far", "kind": "voltage", "value": pulse, "resistance": 25}},
        loads={"end": {"at": "near", "kind": "resistor", "resistance": 100}},
        probes={"near": {"at": "near"}, "far": {"at": "far"}},
    )
    line, t = scene.lines["line"].losses.exact, 3.3
    for probe, x in (("near", 0.2), ("far", 0.0)):
        solution = LossySolution(scene, probe)
        parts = [(0, 10), (0.1, -10), (0.4, -5), (0.6, 5)]  # start, ns, and change of slope, V/ns
        ends = {"source": 25, "load": 100, "drive": Drive.RAMP}
        each = [lossy_response(line, [f"{t - start:.1f}e-9"], x, **ends).u[0] for start, _ in parts]
        expected = sum(float(u) * slope * 1e9 for u, (_, slope) in zip(each, parts, strict=True))
        assert float(solution.at(["3.3e-9"]).u[0]) == pytest.approx(expected, abs=1e-12)
        first = 1.0 if probe == "near" else 0.0
        assert solution.fronts[:4] * 1e9 == pytest.approx([first, first + 0.1, first + 0.4, first + 0.6])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"lines": {"line": {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns"}}}, "lines.line: its losses are not"),
        ({"loads": {"end": {"at": "far", "kind": "series", "resistance": 5, "inductance": 1}}}, "loads.end: no resis"),
        ({"sources": {"s": {"at": "near", "kind": "current", "value": 1}}}, "sources.s: no effort at an end"),
        ({"start": "steady"}, "start: exact solutions start at rest"),
    ],
)
def test_what_has_no_exact_solution_with_losses(change, sentence):
    cable = {"nodes": ["near", "far"], "z0": 50, "delay": "1 ns", "length": "0.2 m", "resistance": 20}
    table = {
        "medium": "electrical",
        "t_end": "10 ns",
        "lines": {"line": cable},
        "sources": {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}},
        "probes": {"far": {"at": "far"}},
    }
    with pytest.raises(InputError, match=sentence):
        LossySolution(Scene(**table | change), "far")
