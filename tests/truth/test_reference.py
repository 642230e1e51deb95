"""Exact solutions against closed forms, mpmath's inverse Laplace transform, each other, and adapters of peers."""

from fractions import Fraction
from math import comb, factorial

import mpmath
import pytest
from one_line import one_line

from tline import InputError, Scene
from tline.study.charts import inverse_fft
from tline.study.charts.measure import Judge
from tline.study.charts.scenes import chart_scene
from tline.study.reference import exact, lattice

STEP = {"shape": "step", "to": 1}


def cable(*, value=STEP, resistance=0.5, load=None, t_end=20, z0=1, delay=1, **more):
    probes = {"near": {"at": "near"}, "far": {"at": "far"}, "x": {"line": "line", "position": "25 %"}}
    return one_line(t_end, {"z0": z0, "delay": delay}, value, resistance, load, **{"probes": probes} | more)


def close(found, expected, digits):
    return abs(mpmath.mpf(str(found)) - expected) < mpmath.mpf(10) ** -digits


def test_parallel_rc_against_the_sum_over_round_trips():
    """H2 = -1 + A/(s + p) to the k, expanded: step responses are incomplete gamma functions."""
    with mpmath.workdps(60):
        R, C, Rs = mpmath.mpf(3), mpmath.mpf("0.7"), mpmath.mpf("0.5")
        p, A, r1 = (R + 1) / (R * C), 2 / C, (Rs - 1) / (Rs + 1)

        def power(k, tau):
            total = mpmath.mpf(-1) ** k
            for j in range(1, k + 1):
                gone = mpmath.exp(-p * tau) * sum((p * tau) ** m / factorial(m) for m in range(j))
                total += comb(k, j) * mpmath.mpf(-1) ** (k - j) * (A / p) ** j * (1 - gone)
            return total

        times = [Fraction(n, 7) for n in range(2, 280, 9)]
        load = {"kind": "parallel", "resistance": 3, "capacitance": 0.7}
        found = exact(cable(load=load, t_end=40), times, "far", digits=40)
        for t, u in zip(times, found.u, strict=True):
            taus = [(k, mpmath.mpf(t.numerator) / t.denominator - 1 - 2 * k) for k in range(20)]
            expected = sum(r1**k * (power(k, x) + power(k + 1, x)) / (1 + Rs) for k, x in taus if x > 0)
            assert close(u, expected, 40), t


def m(text):
    return mpmath.mpf(text)


def sine(s):
    omega = m("0.8") * mpmath.pi
    return 2 * (mpmath.sin(m("0.5")) * s + mpmath.cos(m("0.5")) * omega) / (s**2 + omega**2)


# waveform, and its parts: instant of each and its transform counted from there
SOURCES = {
    "ramp": (
        {"shape": "ramp", "to": 2, "at": 0.3, "duration": 0.7},
        [("0.3", lambda s: 2 / (m("0.7") * s**2)), ("1", lambda s: -2 / (m("0.7") * s**2))],
    ),
    "sine": (
        {"shape": "sine", "amplitude": 2, "frequency": 0.4, "phase": 0.5, "at": 0.3},
        [("0", lambda s: 2 * mpmath.sin(m("0.5")) / s), ("0.3", lambda s: sine(s) - 2 * mpmath.sin(m("0.5")) / s)],
    ),
    "exponential": (
        {"shape": "exponential", "to": 1, "at": -0.5, "time_constant": 0.7},
        [("0", lambda s: 1 / s - mpmath.exp(-m("0.5") / m("0.7")) / (s + 1 / m("0.7")))],
    ),
    "surge": (
        {"shape": "double exponential", "peak": 1, "rise": 0.25, "decay": 1, "at": 0.3},
        # the difference is largest, 4^(-1/3) - 4^(-4/3), at ln(4)/3
        [("0.3", lambda s: (1 / (s + 1) - 1 / (s + 4)) / (m(4) ** (-m(1) / 3) - m(4) ** (-m(4) / 3)))],
    ),
}


@pytest.mark.parametrize("name", SOURCES)
def test_series_rlc_against_inverse_laplace_of_each_ray(name):
    value, parts = SOURCES[name]
    load = {"kind": "series", "resistance": 0.2, "inductance": 1, "capacitance": 0.04}
    times = [Fraction(17, 10), Fraction(29, 10), Fraction(63, 10)]
    found = exact(cable(value=value, load=load), times, "far")
    with mpmath.workdps(40):

        def ray(k, transform):
            def through(s):
                Z = m("0.2") + s + 1 / (m("0.04") * s)
                H = (Z - 1) / (Z + 1)
                return transform(s) * (-H / 3) ** k * (1 + H) * 2 / 3  # H1 = -1/3, divider 1/(1 + 0.5)

            return through

        for t, u in zip(times, found.u, strict=True):
            now = m(t.numerator) / t.denominator
            due = [(now - m(at) - 1 - 2 * k, ray(k, part)) for at, part in parts for k in range(4)]
            expected = sum(mpmath.invertlaplace(f, x, method="talbot") for x, f in due if x > 0)
            assert close(u, expected, 18)


def test_critically_damped_load_and_a_source_of_its_own_rate():
    """A capacitor charged through a matched line by exp(-2t), its own time constant being 1/2: t exp(-2t)."""
    value = {"shape": "exponential", "from": 1, "to": 0, "time_constant": 0.5}
    load = {"kind": "parallel", "capacitance": 0.5}
    times = [Fraction(n, 3) for n in range(4, 15)]
    found = exact(cable(value=value, resistance=1, load=load, t_end=5), times, "far", digits=30)
    with mpmath.workdps(40):
        for t, u, y in zip(times, found.u, found.y, strict=True):
            x = m(t.numerator) / t.denominator - 1
            assert close(u, 2 * x * mpmath.exp(-2 * x), 30)
            assert close(y, (1 - 2 * x) * mpmath.exp(-2 * x), 30)


def test_inside_a_line_between_ideal_source_and_short():
    """A ramp of slope 1 without loss: at a quarter of the way t - 1/4, less what the short sends back, and so on."""
    value = {"shape": "piecewise linear", "points": [[0, 0], [100, 100]]}
    load = {"kind": "short"}
    times = [Fraction(n, 8) for n in range(0, 80)]
    found = exact(cable(value=value, resistance=0, load=load), times, "x")
    for t, u, y in zip(times, found.u, found.y, strict=True):
        ways = [(2 * k + Fraction(1, 4), 1) for k in range(6)] + [(2 * k + Fraction(7, 4), -1) for k in range(6)]
        assert Fraction(str(u)) == sum(sign * max(t - way, Fraction(0)) for way, sign in ways)
        assert Fraction(str(y)) == sum(max(t - way, Fraction(0)) for way, _ in ways)


def network(**more):
    """A Y and a loop behind two sources, without common measure."""
    lines = {
        "a": ("in", "mid", 50, "1 ns"),
        "b": ("mid", "p", 75, "1.41421356 ns"),
        "c": ("mid", "q", 60, "0.57735 ns"),
        "d": ("p", "q", 30, "1.1 ns"),
    }
    pulses = {"shape": "pulses", "high": 1, "at": "0.3 ns", "width": "0.4 ns", "rise": "0.1 ns", "period": "2 ns"}
    return {
        "medium": "electrical",
        "t_end": "9 ns",
        "lines": {name: {"nodes": [i, j], "z0": z, "delay": T} for name, (i, j, z, T) in lines.items()},
        "sources": {
            "s": {"at": "in", "kind": "voltage", "value": pulses, "resistance": 25},
            "j": {"at": "q", "kind": "current", "value": {"shape": "step", "to": 0.01, "at": "1.7 ns"}},
        },
        "loads": {"p": {"at": "p", "kind": "resistor", "resistance": 20}},
        "probes": {"x": {"line": "d", "position": "30 %"}, "mid": {"at": "mid", "line": "c"}},
    } | more


@pytest.mark.parametrize("probe", ["x", "mid"])
def test_rays_and_lattice_agree(probe):
    """One follows waves forward in partial fractions, the other traces them back in fractions."""
    scene = Scene(**network())
    times = [Fraction(k, 10**11) for k in range(23, 900, 41)]
    rays = exact(scene, times, probe)
    u, y = lattice(scene, times, probe)
    assert max(abs(Fraction(str(a)) - b) for a, b in zip(rays.u, u, strict=True)) < Fraction(1, 10**19)
    assert max(abs(Fraction(str(a)) - b) for a, b in zip(rays.y, y, strict=True)) < Fraction(1, 10**21)
    assert max(map(abs, u)) > Fraction(1, 10)


@pytest.mark.parametrize("number", [float, mpmath.mpf])
def test_the_lattice_in_other_numbers(number):
    times = [Fraction(k, 10**11) for k in range(23, 900, 97)]
    expected, found = (lattice(Scene(**network()), times, "x", kind)[0] for kind in (Fraction, number))
    assert isinstance(found[-1], number)
    assert max(abs(float(b) - float(a)) for a, b in zip(expected, found, strict=True)) < 1e-15


def test_a_switch_in_the_lattice():
    """It halves the voltage at a matched line's end from its instant on, and twice the delay later at the source's."""
    load = {"kind": "switch", "before": float("inf"), "after": 1, "time": 2.5}
    scene = cable(resistance=1, load=load)
    far = exact(scene, ["1", "1.1", "2.5", "2.6"], "far")
    assert [float(u) for u in far.u] == [0.0, 1.0, 1.0, 0.5]
    near = exact(scene, ["1", "3", "3.5", "3.6"], "near")
    assert [float(u) for u in near.u] == [0.5, 1.0, 1.0, 0.5]


def test_a_stiff_load_and_many_transits_keep_their_digits():
    """A capacitor of 1e-4 of the delay at an end without loss elsewhere: as 50 digits say, cut to 20."""
    load = {"kind": "parallel", "resistance": 3, "capacitance": 1e-4}
    scene = cable(load=load, t_end=60)
    times = [Fraction(2 * n + 1, 1) + Fraction(k, 10**5) for n in range(0, 30, 5) for k in (1, 7, 30)]
    few, many = exact(scene, times, "far"), exact(scene, times, "far", digits=50)
    assert all(abs(a - b) < 10**-20 for a, b in zip(few.u, many.u, strict=True))
    assert all(abs(a - b) > 0 for a, b in zip(few.u, many.u, strict=True))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"load": {"kind": "switch", "before": 1, "after": 2, "time": 1}, "value": SOURCES["sine"][0]}, "curved"),
        ({"start": "steady"}, "start at rest"),
        ({"times": [21]}, "not in the run"),
        ({"times": []}, "at least one"),
        ({"probe": "fra"}, "no such probe, expected 'far'"),
        ({"digits": 0}, "1 to 1000"),
        ({"delay": 1e-3}, "too many reflections"),
        ({"value": {"shape": "pulses", "high": 1, "width": 0.01, "period": 0.02}}, "corners times .* are too many"),
    ],
)
def test_what_it_cannot_do_is_said_in_one_sentence(arguments, words, monkeypatch):
    monkeypatch.setattr("tline.study.reference.rays.MOST_ARRIVALS", 1000)
    ask = {"times": [2], "probe": "far", "digits": 20}
    ask |= {key: arguments.pop(key) for key in ask.keys() & arguments.keys()}
    with pytest.raises(InputError, match=words) as caught:
        exact(cable(**arguments), **ask)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["rc", "rlc"])
def test_scikit_rf_by_inverse_fft_converges(name):
    scene = chart_scene(name).scene
    assert inverse_fft.incompatibility(scene) is None
    judge = Judge(scene, 60)
    errors = [judge.errors(inverse_fft.run(scene, n))[1] for n in (50, 100, 200)]
    assert errors[2] < 5e-3
    assert errors[0] > 3 * errors[1] > 6 * errors[2]
