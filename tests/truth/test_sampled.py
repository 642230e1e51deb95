"""Samples of known circuits, nearest passive models in closed form, and another solver for the same problem."""

import json
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.optimize import minimize

from passivity import RationalFunction, Status, check_bounded_real, check_positive_real, nearest, verify
from passivity.sampled.check import SAMPLE_ROUNDING, check_samples
from passivity.sampled.enforce import SPARE, enforce
from passivity.sampled.fit import fit
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.read import read_touchstone
from passivity.sampled.response import SampledResponse
from tline.cli.passivity import passivity

CASES = json.loads((Path(__file__).parent / "passivity_cases.json").read_text(encoding="utf-8"))["cases"]
FAR = 1e7  # rad/s: stands for infinity where poles are near 1


def samples_of(model, w):
    return SampledResponse(np.asarray(w) / (2 * np.pi), model.at(np.asarray(w)), model.parameter)


def by_hand(model, w):
    """The model at s = jw in 30 digits, from its poles and residues as they are."""
    with mpmath.workdps(30):
        s = mpmath.mpc(0, float(w))
        total = model.constant + s * model.proportional
        for a, r in zip(model.poles.tolist(), model.residues.tolist(), strict=True):
            total += r / (s - a)
            if a.imag:
                total += mpmath.conj(mpmath.mpc(r)) / (s - mpmath.conj(mpmath.mpc(a)))
        return total


def columns(model, w):
    """Values at jw of what the residues (real and imaginary parts) and the constant are multiplied by."""
    s, found = 1j * w, []
    for a in model.poles:
        one, other = 1 / (s - a), 1 / (s - a.conjugate())
        found += [one + other, 1j * (one - other)] if a.imag else [one]
    return np.stack([*found, np.ones(len(w), complex)], axis=1)


def beyond(model, values):
    """How far values are beyond the bound."""
    return np.abs(values) - 1 if model.parameter == "S" else -values.real


def fine(model):
    """Many frequencies, densest at the resonances."""
    near = [np.abs(a.imag + a.real * np.tan(np.linspace(-1.5, 1.5, 6000))) for a in model.poles]
    return np.unique(np.concatenate([np.linspace(0, 3, 6000), np.geomspace(3, FAR, 1500), *near]))


def worst_by_hand(model):
    """The largest |S| - 1, or -Re Z, in 30 digits where it is large in 16."""
    w = fine(model)
    there = w[np.argsort(beyond(model, columns(model, w) @ model.coefficients[:-1]))[-20:]]
    return max(abs(h) - 1 if model.parameter == "S" else -h.real for h in (by_hand(model, x) for x in there))


def assert_passive(result):
    """Proved, by a certificate that is checked by another theorem, and so it is where one looks."""
    assert result.verdict.status is Status.PROVED
    assert verify(result.verdict.certificate)
    assert result.verdict.function == result.model.rational()
    assert (result.model.poles.real < 0).all()
    assert worst_by_hand(result.model) <= 0


# ---- samples of circuits


def ladder(w, loss, active=0.0):
    """Five sections of 1 H with a resistance, and 1 F; `active` is a negative resistor at the far end."""
    z = np.full(len(w), 1.0 - active, complex)
    for _ in range(5):
        z = 1 / (1j * w + 1 / (z + loss + 1j * w))
    return z


@pytest.mark.parametrize("loss", [0.0, 0.1])
def test_passive_ladders(loss):
    w = np.linspace(0, 3, 400)
    z = ladder(w, loss)
    for values, parameter in ((z, "Z"), (1 / z, "Y"), ((z - 1) / (z + 1), "S")):
        verdict = check_samples(SampledResponse(w, values, parameter))
        assert verdict.status is Status.NO_VIOLATION
        assert verdict.bands == ()
        assert verdict.witness is None


def test_a_ladder_with_an_active_element():
    w = np.linspace(0, 3, 400)
    z = ladder(w, 0.1, active=1.8)
    verdict = check_samples(SampledResponse(w, z, "Z"))
    violating = {x for x, y in zip(w, z, strict=True) if y.real < 0}
    assert verdict.status is Status.REFUTED
    assert {x for x in w for band in verdict.bands if band.first <= x <= band.last} == violating
    assert verdict.worst_value == z.real.min()
    assert verdict.worst_frequency == w[np.argmin(z.real)]
    # beyond the worst value the tolerance swallows it
    assert check_samples(SampledResponse(w, z, "Z"), -z.real.min() * 1.001).status is Status.NO_VIOLATION
    assert check_samples(SampledResponse(w, z, "Z"), -z.real.min() * 0.999).status is Status.REFUTED


def test_noise_within_the_tolerance():
    """A lossless line's reflection with an error of at most 1e-3: the truth is |S| = 1."""
    w, rng = np.linspace(0, 9, 500), np.random.default_rng(1)
    line = np.exp(-2j * w)
    noise = 1e-3 * rng.uniform(0, 1, 500) * np.exp(2j * np.pi * rng.uniform(size=500))
    assert check_samples(SampledResponse(w, line, "S")).status is Status.NO_VIOLATION
    assert check_samples(SampledResponse(w, line + noise, "S")).status is Status.REFUTED
    assert check_samples(SampledResponse(w, line + noise, "S"), 1e-3).status is Status.NO_VIOLATION


def test_two_ports():
    """Series resistor of 50 ohm between ports of 50 ohm: 1/3, 2/3; gyrator; a resistor of -10 ohm."""
    series = np.array([[1, 2], [2, 1]]) / 3
    assert check_samples(SampledResponse([1, 2], [series, series], "S")).worst_value == pytest.approx(1)
    assert check_samples(SampledResponse([1], [[[0, 5], [-5, 0]]], "Z")).status is Status.NO_VIOLATION
    z = check_samples(SampledResponse([1], [[[-10, -10], [-10, -10]]], "Z"))
    assert z.status is Status.REFUTED
    assert z.worst_value == pytest.approx(-20)


FINITE = [c for c in CASES if c["verdict"] in (True, False) and set(c["den"]) != {"0"}]


@pytest.mark.parametrize("case", FINITE, ids=lambda case: case["name"])
def test_samples_of_the_reference_cases(case):
    """Samples, rounded from exact values: refuted only if one of them, exactly, is beyond rounding."""
    z = RationalFunction.from_coefficients(case["num"], case["den"])
    check = check_positive_real if case["kind"] == "PR" else check_bounded_real
    marks = [m.frequency for m in check(z).margins if m is not None and 0 < m.frequency < 1e100] or [1.0]
    w = np.unique([x * m for x in np.geomspace(1e-3, 1e3, 31) for m in marks])
    values = np.array([z(1j * x) for x in w])
    w, values = w[np.abs(values) < 1e100], values[np.abs(values) < 1e100]
    verdict = check_samples(SampledResponse(w, values, "Z" if case["kind"] == "PR" else "S"))
    bar = Fraction(SAMPLE_ROUNDING)
    exact = [(Fraction(v.real), Fraction(v.imag)) for v in values.tolist()]
    if case["kind"] == "PR":
        beyond = any(a < 0 and a * a > bar**2 * (a * a + b * b) for a, b in exact)
    else:
        beyond = any((a * a + b * b) * (1 - bar) ** 2 > 1 for a, b in exact)
    assert verdict.status is (Status.REFUTED if beyond else Status.NO_VIOLATION)
    if case["verdict"] is True:
        assert not beyond


# ---- a Touchstone file


def test_touchstone_formats_agree(tmp_path):
    """The same two samples as real and imaginary part, magnitude and angle, decibels, and as impedance."""
    s = [0.6 + 0.0j, 0.3 - 0.4j]
    lines = {
        "ri": "# MHz S RI R 75\n1 0.6 0\n2 0.3 -0.4\n",
        "ma": "! a comment :: !!\n# GHz S MA R 75 ! more\n0.001 0.6 0\n0.002 0.5 -53.13010235415598\n",
        "db": "# kHz S DB R 75\n1000 -4.436974992327127 0\n2000 -6.020599913279624 -53.13010235415598\n",
        "z": "# Hz Z RI R 75\n1e6 4 0\n2e6 1.1538461538461537 -1.2307692307692308\n",
    }
    for name, text in lines.items():
        path = tmp_path / f"{name}.s1p"
        path.write_text(text)
        read = read_touchstone(path)
        assert read.f == pytest.approx([1e6, 2e6])
        assert read.values.ravel() == pytest.approx(np.array(s), abs=1e-12)
        assert read.z0.tolist() == [75]
        assert check_samples(read).worst_value == pytest.approx(0.6)


def test_touchstone_two_port_order(tmp_path):
    """Of two ports version 1 writes S11 S21 S12 S22: an amplifier of gain 2 from port 1 to port 2."""
    path = tmp_path / "amplifier.s2p"
    path.write_text("# Hz S RI R 50\n1 0 0 2 0 0.1 0 0 0\n3 0 0 2 0 0.1 0 0 0\n")
    read = read_touchstone(path)
    assert read.values[0].tolist() == [[0, 0.1], [2, 0]]
    verdict = check_samples(read)
    assert (verdict.status, verdict.worst_value) == (Status.REFUTED, 2)
    assert verdict.bands[0][:4] == (1, 3, None, None)


# ---- nearest passive models in closed form


def test_the_constant_that_is_missing():
    """Re 1/(s^2 + s + 1) at s = jw is (1 - x)/(1 - x + x^2), smallest at x = w^2 = 2: -1/3."""
    root = 0.75**0.5
    model = PoleResidueModel([-0.5 + 1j * root], [1 / (2j * root)], 0, 0, "Z")
    result = enforce(model, samples_of(model, np.linspace(0, 4, 50)), only_constant=True)
    assert_passive(result)
    assert result.model.residues.tolist() == model.residues.tolist()
    assert 1 / 3 <= result.model.constant + 1e-15 <= (1 + 2 * SPARE) / 3


@pytest.mark.parametrize(
    ("parameter", "ends", "nearest"),
    [
        ("Z", (1.0, -0.1), (1.0, 0.0)),
        ("Z", (-0.2, 3.0), (0.0, 3.0)),
        ("Y", (-0.2, -0.3), (0.0, 0.0)),
        ("S", (1.1, -1.1), (1.0, -1.0)),
        ("S", (-1.5, 0.3), (-1.0, 0.3)),
    ],
)
def test_both_ends_are_cut_off(parameter, ends, nearest):
    """d + r/(s + 1) runs on a circle whose diameter is from its value at 0 to that at infinity.

    With one sample at each end, the nearest passive circle has each end moved to the bound on its own.
    """
    model = PoleResidueModel([-1], [ends[0] - ends[1]], ends[1], 0, parameter)
    result = enforce(model, samples_of(model, [0, FAR]))
    assert_passive(result)
    assert result.model.at(np.array([0, FAR])).real == pytest.approx(nearest, abs=2 * SPARE)
    change = np.hypot(ends[0] - nearest[0], ends[1] - nearest[1]) / np.hypot(*ends)
    assert result.change.rms == pytest.approx(change, rel=1e-3)


# ---- random models that are a little active


def slightly_active(seed, parameter, pairs):
    rng = np.random.default_rng(seed)
    im = np.sort(rng.uniform(0.05, 1, pairs))
    poles = np.append(-im * 10 ** rng.uniform(-2.5, -0.5, pairs) + 1j * im, -rng.uniform(0.05, 1))
    residues = (rng.normal(size=pairs) + 0.3j * rng.normal(size=pairs)) * -poles[:-1].real / 2
    model = PoleResidueModel(poles, np.append(residues, 0.2 * rng.normal()), rng.uniform(0, 0.5), 0, parameter)
    values, by, x = model.at(fine(model)), 10 ** rng.uniform(-4, -1), model.coefficients
    if parameter == "S":
        return model.with_coefficients(x * (1 + by) / np.abs(values).max())
    x[-2] -= values.real.min() + by * np.abs(values).max()
    return model.with_coefficients(x)


@pytest.mark.parametrize("parameter", ["Z", "S"])
@pytest.mark.parametrize("seed", range(10))
def test_random_models_end_proved(parameter, seed):
    model = slightly_active(seed, parameter, 3 + seed % 8)
    assert worst_by_hand(model) > 0
    w = np.linspace(0, 1.5, 200)
    result = enforce(model, samples_of(model, w))
    assert_passive(result)
    before, after = model.at(w), result.model.at(w)
    assert result.change.rms == pytest.approx(np.linalg.norm(after - before) / np.linalg.norm(before))
    assert result.change.max == pytest.approx(np.abs(after - before).max() / np.abs(before).max())
    assert result.misfit_before.rms == pytest.approx(0, abs=1e-12)
    assert 0 < result.change.rms < 0.3
    # no dearer than what anyone would do: shift Z up, or shrink S, until the worst value is on the bound
    worst = float(worst_by_hand(model))
    plain = worst * len(w) ** 0.5 / np.linalg.norm(before) if parameter == "Z" else worst / (1 + worst)
    assert result.change.rms <= plain * (1 + 1e-3)


def by_brute_force(model, w):
    """Relative change by sequential quadratic programming with a condition at each of a thousand frequencies.

    It is done three times, with more of them where the answer before violates the bound in between.
    """
    x, grid = model.coefficients[:-1], fine(model)
    here = columns(model, w)
    size = 0.01 * np.linalg.norm(here @ x)
    _, r = np.linalg.qr(np.vstack([here.real, here.imag]))
    unit = np.linalg.inv(r) * size  # unknowns y = R x in which the cost is |y|^2
    tight = np.arange(len(grid)) % 24 == 0
    for _ in range(3):
        start, there = columns(model, grid[tight]) @ x, columns(model, grid[tight]) @ unit

        def room(y, start=start, there=there):
            return 1 - np.abs(start + there @ y) ** 2 if model.parameter == "S" else start.real + there.real @ y

        def slope(y, start=start, there=there):
            return -2 * ((start + there @ y).conj()[:, None] * there).real if model.parameter == "S" else there.real

        found = minimize(
            lambda y: y @ y,
            np.zeros(len(x)),
            jac=lambda y: 2 * y,
            constraints={"type": "ineq", "fun": room, "jac": slope},
            method="SLSQP",
            options={"maxiter": 200, "ftol": 1e-12},
        )
        assert found.success
        tight |= beyond(model, columns(model, grid) @ (x + unit @ found.x)) > 0
    return np.sqrt(found.fun) * 0.01


@pytest.mark.parametrize("parameter", ["Z", "S"])
@pytest.mark.parametrize("seed", range(3))
def test_the_change_is_the_least(parameter, seed):
    """Brute force keeps the bound only on its grid, so it may cost a little less; we keep SPARE away from it."""
    model = slightly_active(seed, parameter, 2)
    w = np.linspace(0, 1.5, 200)
    least = by_brute_force(model, w)
    assert least * (1 - 1e-4) <= enforce(model, samples_of(model, w)).change.rms <= least * (1 + 1e-3)


def test_a_fit_to_noise_is_made_passive():
    """A lossless resonator measured with noise: no sample can be trusted to keep the bound, the model is proved."""
    rng = np.random.default_rng(4)
    w = np.linspace(0.2, 2, 150)
    truth = (1 - 0.2j * w - w**2) / (1 + 0.2j * w - w**2)
    noise = 0.01 * (rng.normal(size=150) + 1j * rng.normal(size=150))
    response = SampledResponse(w / (2 * np.pi), truth + noise, "S")
    assert check_samples(response).status is Status.REFUTED
    result = enforce(fit(response), response)
    assert_passive(result)
    assert np.abs(result.model.at(w) - truth).max() < 0.03
    assert result.misfit_before.rms <= result.misfit.rms < 0.02


BEYOND = 1e9  # rad/s: stands for infinity


def turned(values, seed):
    """A diagonal of values between two fixed orthogonal matrices, which change no singular value and no distance."""
    rng = np.random.default_rng(seed)
    u, v = (np.linalg.qr(rng.normal(size=(len(values), len(values))))[0] for _ in range(2))
    return u, v, u @ np.diag(values) @ v.T


@pytest.mark.parametrize("ports", [2, 3])
def test_each_singular_value_is_cut_off_at_1(ports):
    """D + R/(s + 1) with one sample at each end: each end is moved to the nearest matrix of norm 1 on its own."""
    ends = np.linspace(1.2, 0.3, ports), np.linspace(0.1, 1.4, ports)
    u, v, high = turned(ends[1], ports)
    model = PoleResidueModel(np.array([-1.0]), (u @ np.diag(ends[0] - ends[1]) @ v.T)[None], high)
    w = np.array([0, BEYOND])
    from passivity import enforce

    found = enforce(model, SampledResponse(w / (2 * np.pi), model.at(w), "S"))
    assert found.status is Status.PROVED
    least = np.sqrt(sum((np.maximum(x - 1, 0) ** 2).sum() for x in ends) / sum((x**2).sum() for x in ends))
    assert found.change.rms == pytest.approx(least, rel=1e-3)
    assert np.linalg.norm(found.model.at(w), 2, axis=(1, 2)) == pytest.approx([1, 1], abs=2 * SPARE)
    assert found.worst[0][0] == pytest.approx(1.4, rel=1e-6)


def test_an_eigenvalue_of_impedances_is_lifted_to_zero():
    """Two resistive ports coupled too much: the nearest semidefinite matrix has the negative eigenvalue at zero."""
    z = np.array([[1.0, 2.0], [2.0, 1.0]])
    found = nearest(PoleResidueModel(np.zeros(0), np.zeros((0, 2, 2)), z, 0.0, "Z"))
    assert found.status is Status.PROVED
    assert found.model.constant == pytest.approx(np.full((2, 2), 1.5), abs=1e-4)
    assert found.worst[0][0] == pytest.approx(-1)


def test_from_a_file_to_a_file(tmp_path):
    """A filter measured a little beyond 1; what is written is read again, and no foreign singular value exceeds 1."""
    f = np.linspace(1e8, 3e9, 60)
    s = 2j * np.pi * f / 1e9
    notch = (s**2 + 4) / (s**2 + 2 * s + 4)
    S = np.array([[1 - notch, notch], [notch, 1 - notch]]).transpose(2, 0, 1) * 1.01
    SampledResponse(f, S, "S", 75).touchstone()
    (tmp_path / "in.s2p").write_text(SampledResponse(f, S, "S", 75).touchstone())
    assert (read_touchstone(tmp_path / "in.s2p").values == S).all()
    out = tmp_path / "out.s2p"
    result = CliRunner().invoke(passivity, [str(tmp_path / "in.s2p"), "--nearest", str(out)])
    assert result.exit_code == 0, result.output
    assert "largest singular value of S = 1.01 before, 1 after" in result.output
    after = read_touchstone(out)
    assert after.z0.tolist() == [75, 75]
    assert np.linalg.norm(after.values, 2, axis=(1, 2)).max() <= 1
    assert np.abs(after.values - S).max() < 0.011
