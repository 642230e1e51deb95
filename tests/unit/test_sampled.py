"""Samples, files, fits and pictures: the arithmetic, and what is refused."""

import json
from fractions import Fraction

import numpy as np
import pytest

from passivity import ExpressionError, RationalFunction, Status, check_bounded_real, check_positive_real
from passivity.polynomial.roots import violations
from passivity.sampled.check import check_samples
from passivity.sampled.enforce import enforce, least_change
from passivity.sampled.fit import fit
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.picture import draw_samples
from passivity.sampled.response import MAX_PORTS, MAX_SAMPLES, SampledResponse

W = np.linspace(0, 5, 60)
ACTIVE = PoleResidueModel([-0.3 + 1j, -2], [0.5, -0.4], 0.0, 0, "Z")


def samples_of(model, w=W):
    return SampledResponse(w / (2 * np.pi), model.at(w), model.parameter)


# ---- responses


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (([1], [1], "T"), "parameter: not known"),
        (([], [], "Z"), "f: not a list"),
        (([2, 1], [1, 1], "Z"), r"f\[1\]: out of order"),
        (([1, 1], [1, 1], "Z"), r"f\[1\]: out of order"),
        (([-1, 1], [1, 1], "Z"), r"f\[0\]: out of order"),
        (([1, 2], [1], "Z"), "values: not one number"),
        (([1], [[1, 2]], "Z"), "values: not one number"),
        (([1], np.ones((1, 1, 2)), "Z"), "values: not one number"),
        (([1], np.ones((1, 0, 0)), "Z"), "values: too few"),
        (([1], np.ones((1, MAX_PORTS + 1, MAX_PORTS + 1)), "Z"), "values: too few or too many"),
        (([1, 2], [1, float("nan")], "Z"), r"values\[1\]: not a number of reasonable"),
        (([1, float("inf")], [1, 1], "Z"), r"f\[1\]: not a number of reasonable"),
        (([1], [1e200], "Z"), r"values\[0\]"),
        (([1], ["a"], "Z"), "values: not an array"),
        ((np.array([1j]), [1], "Z"), "f: not an array"),
        (([[1], [2, 3]], [1], "Z"), "f: not an array"),
        (([1], [1], "S", 0), "z0: not a reference"),
        (([1], [1], "S", [50, 50]), "z0: not a reference"),
    ],
)
def test_bad_responses(given, said):
    with pytest.raises(ExpressionError, match=said):
        SampledResponse(*given)


def test_a_response_keeps_its_own_numbers():
    f = np.array([1.0, 2.0])
    response = SampledResponse(f, np.eye(2)[None].repeat(2, 0), "S", [50, 75])
    f[0] = 9
    assert response.f[0] == 1
    assert response.z0.tolist() == [50, 75]
    with pytest.raises(ValueError, match="read-only"):
        response.values[0] = 0


# ---- checking


def test_bands_with_their_neighbours():
    verdict = check_samples(SampledResponse(range(7), [1.5, 1, 0.5, 1.2, 1.3, 1.1, 0.9], "S"))
    assert [band[:4] for band in verdict.bands] == [(0, 0, None, 1), (3, 5, 2, 6)]
    assert verdict.bands[1][4:] == (1.3, 4)
    assert (verdict.worst_value, verdict.worst_frequency, verdict.witness.sample) == (1.5, 0, 0)


def test_a_band_may_reach_the_last_sample():
    (band,) = check_samples(SampledResponse([1, 2], [1, -1], "Z")).bands
    assert band == (2, 2, 1, None, -1, 2)


@pytest.mark.parametrize("parameter", ["S", "Z", "Y"])
def test_the_witness_is_exact(parameter):
    rng = np.random.default_rng(3)
    values = rng.normal(size=(20, 3, 3)) + 1j * rng.normal(size=(20, 3, 3))
    verdict = check_samples(SampledResponse(range(20), values, parameter), tolerance=0.1)
    witness = verdict.witness
    v = [(Fraction(x.real), Fraction(x.imag)) for x in witness.vector]
    image = [[Fraction(0), Fraction(0)] for _ in v]
    for i, row in enumerate(values[witness.sample]):
        for z, (c, d) in zip(row.tolist(), v, strict=True):
            a, b = Fraction(z.real), Fraction(z.imag)
            image[i][0] += a * c - b * d
            image[i][1] += a * d + b * c
    size = sum(a * a + b * b for a, b in v)
    if parameter == "S":
        value = sum(a * a + b * b for a, b in image) / size
        assert value > (1 + witness.bar) ** 2
        assert float(value) == pytest.approx(verdict.worst_value**2)
    else:
        value = sum(a * c + b * d for (a, b), (c, d) in zip(v, image, strict=True)) / size
        assert value < -witness.bar
        assert float(value) == pytest.approx(verdict.worst_value)
    assert value == witness.value
    assert verdict.status is Status.REFUTED
    assert witness.bar >= Fraction(1, 10)


def test_a_tolerance_for_each_sample():
    response = SampledResponse([1, 2], [1.2, 1.2], "S")
    assert check_samples(response, [0.3, 0.3]).status is Status.NO_VIOLATION
    verdict = check_samples(response, [0.3, 0.1])
    assert (verdict.status, verdict.witness.frequency, len(verdict.bands)) == (Status.REFUTED, 2, 1)


@pytest.mark.parametrize("tolerance", [-1, float("nan"), [1, 2, 3], "much", [[1, 1]]])
def test_bad_tolerances(tolerance):
    with pytest.raises(ExpressionError, match="tolerance"):
        check_samples(SampledResponse([1, 2], [1, 1], "S"), tolerance)


def test_what_samples_cannot_show_is_said():
    between, causality = check_samples(SampledResponse([1, 2, 5], [1, 1, 1], "Z")).caveats
    assert "from 2 to 5 Hz" in between
    assert "below 1 Hz and above 5 Hz" in between
    assert "causality is not tested" in causality
    assert "below" not in check_samples(SampledResponse([0], [1], "Z")).caveats[0]


# ---- files


def test_a_sample_far_below_the_band_is_fitted_as_well():
    f = np.array([1e-305, 2e3, 3e3, 4e3, 5e3])
    assert fit(SampledResponse(f, np.full(5, 3.0), "Z")).at(f) == pytest.approx(3.0)


# ---- models


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (([-1 - 1j], [1], 0, 0, "Z"), r"poles\[0\]: below the real axis"),
        (([-2, -1], [1, 1j], 0, 0, "Z"), r"residues\[1\]: not real"),
        (([-2, -1], [1], 0, 0, "Z"), "residues: shape"),
        (([float("nan")], [1], 0, 0, "Z"), r"poles\[0\]"),
        (([], [], float("inf"), 0, "Z"), "constant"),
        (([], [], [1], 0, "Z"), "constant"),
        (([], [], 0, 0, "X"), "parameter"),
        ((-np.arange(1, 2002), np.ones(2001), 0, 0, "Z"), "at most 2000"),
    ],
)
def test_bad_models(given, said):
    with pytest.raises(ExpressionError, match=said):
        PoleResidueModel(*given)


def test_the_rational_function_is_the_model_exactly():
    model = PoleResidueModel([-0.1 + 0.7j, -0.3], [0.2 - 0.9j, 0.6], 0.1, 0.7, "Z")
    s, total = Fraction(3, 7), Fraction(0.1) + Fraction(0.7) * Fraction(3, 7)
    total += Fraction(0.6) / (s + Fraction(0.3))
    alpha, beta, u, v = map(Fraction, (-0.1, 0.7, 0.2, -0.9))
    total += 2 * (u * (s - alpha) - v * beta) / ((s - alpha) ** 2 + beta**2)
    p, q = model.rational().numerator, model.rational().denominator
    value = sum(c * s**k for k, c in enumerate(reversed(p))) / sum(c * s**k for k, c in enumerate(reversed(q)))
    assert value == total


def test_coefficients_and_back():
    assert ACTIVE.coefficients.tolist() == [0.5, 0, -0.4, 0, 0]
    again = ACTIVE.with_coefficients(np.array([1.0, 2, 3, 4, 5]))
    assert again.residues.tolist() == [1 + 2j, 3]
    assert (again.constant, again.proportional) == (4, 5)


def test_forbidden_bands():
    of = RationalFunction.from_expression
    assert violations(check_positive_real(of("1/(s + 1)")).negative) == []
    assert violations(check_positive_real(of("s")).negative) == []
    (band,) = violations(check_bounded_real(of("2/(s + 1)")).negative)
    assert band == pytest.approx((0, 3**0.5))
    # Re Z without the last term touches 0 at w^2 = 2
    (band,) = violations(check_positive_real(of("(s^2 + s + 1)/(s^2 + s + 4) - 1/100")).negative)
    assert band[0] < 2**0.5 < band[1]


# ---- the least change


def test_least_change_by_hand():
    # the nearest point of x >= 3, y >= 4 to the origin, and of x + y >= 2
    assert least_change(np.eye(2), np.array([3.0, 4.0])) == pytest.approx([3, 4])
    assert least_change(np.ones((1, 2)), np.array([2.0])) == pytest.approx([1, 1])


def test_least_change_of_what_cannot_be():
    assert least_change(np.array([[1.0], [-1.0]]), np.array([1.0, 1.0])) is None


# ---- enforcement


def test_a_passive_model_is_left_alone():
    model = PoleResidueModel([-1], [1], 0, 0, "Z")
    result = enforce(model, samples_of(model))
    assert result.model is model
    assert (result.rounds, result.change.rms, result.change.max) == (0, 0, 0)


def test_what_cannot_be_made_passive_is_not_called_so():
    # |S(0)| = |d + 3|, |S(inf)| = |d|: no constant d keeps both within 1
    model = PoleResidueModel([-1], [3], 0, 0, "S")
    result = enforce(model, samples_of(model), only_constant=True)
    assert result.verdict.status is Status.REFUTED
    assert result.model is model
    assert enforce(model, samples_of(model)).verdict.status is Status.PROVED


@pytest.mark.parametrize(
    ("model", "said"),
    [
        (PoleResidueModel([1], [1], 0, 0, "Z"), r"poles\[0\]: no passive model"),
        (PoleResidueModel([1j], [1], 0, 0, "S"), r"poles\[0\]: no passive model"),
        (PoleResidueModel([-1, 0, 0], [1, 1, 1], 0, 0, "Z"), r"poles\[1\]: no passive model"),
        (PoleResidueModel([1j], [-1], 0, 0, "Z"), r"residues\[0\]: at a pole on the axis"),
        (PoleResidueModel([1j], [1 + 1j], 0, 0, "Z"), r"residues\[0\]: at a pole on the axis"),
        (PoleResidueModel([0], [1], 0, 0, "Z"), "a sample on a pole"),
        (PoleResidueModel([], [], 0, -1, "Z"), "proportional: no passive"),
        (PoleResidueModel([], [], 0, 1, "S"), "proportional: no passive"),
        (PoleResidueModel([], [], 0, 0, "Y"), "samples: not of what"),
        (PoleResidueModel([-1e10, -1e-10], [1, 1], 0, 0, "Z"), "poles: too far apart"),
    ],
)
def test_models_that_are_refused(model, said):
    with pytest.raises(ExpressionError, match=said):
        enforce(model, SampledResponse(W, np.zeros(len(W)), "S" if model.parameter == "S" else "Z"))


def test_too_many_samples_for_a_model():
    n = MAX_SAMPLES + 1
    with pytest.raises(ExpressionError, match="samples: too many"):
        enforce(ACTIVE, SampledResponse(range(n), np.ones(n), "Z"))


def test_a_pole_on_the_axis_inside_a_forbidden_band():
    model = PoleResidueModel([1j, -3], [0.5, -1], 0.1, 0, "Z")
    result = enforce(model, samples_of(model, np.linspace(0.05, 5, 80)))
    assert result.verdict.status is Status.PROVED
    assert result.model.residues[0] == 0.5


def test_poles_on_the_axis_stay():
    model = PoleResidueModel([0, 2j, -1 + 1j], [3, 0.5, 0.5j], 0.1, 0.25, "Z")
    result = enforce(model, samples_of(model, np.linspace(0.05, 5, 80)))
    assert result.verdict.status is Status.PROVED
    assert result.model.residues[:2].tolist() == [3, 0.5]
    assert result.model.proportional == 0.25
    assert 0 < result.change.rms < 0.1


# ---- fits


@pytest.mark.parametrize("parameter", ["Z", "Y", "S"])
@pytest.mark.parametrize("unit", [1.0, 1e9])
def test_a_rational_response_is_found_again(parameter, unit):
    truth = PoleResidueModel(
        np.array([-0.05 + 1j, -0.3 + 3j, -2]) * unit, np.array([0.1, 0.2 - 0.1j, 1]) * unit, 0.1, 0, parameter
    )
    w = np.linspace(0, 5, 100) * unit
    found = fit(samples_of(truth, w), order=5)
    assert np.sort_complex(found.poles) == pytest.approx(np.sort_complex(truth.poles), rel=1e-6)
    beyond = np.array([7.0, 20.0]) * unit
    assert found.at(beyond) == pytest.approx(truth.at(beyond), rel=1e-6)


def test_noise_is_not_fitted():
    rng = np.random.default_rng(0)
    truth = PoleResidueModel([-0.1 + 1j], [0.1], 0.1, 0, "S")
    noise = 0.01 * (rng.normal(size=len(W)) + 1j * rng.normal(size=len(W)))
    found = fit(SampledResponse(W / (2 * np.pi), truth.at(W) + noise, "S"))
    assert len(found.poles) <= 2
    assert found.poles[0] == pytest.approx(-0.1 + 1j, abs=0.02)


@pytest.mark.parametrize(
    ("response", "order", "said"),
    [
        (SampledResponse([0], [1], "Z"), 0, "cannot be fitted"),
        (SampledResponse([1, 2, 3], [1, 1, 1], "Z"), 2, "order"),
        (SampledResponse([1, 2, 3], [1, 1, 1], "Z"), -1, "order"),
        (SampledResponse([1, 2, 3], [1, 1, 1], "Z"), 1.5, "order"),
    ],
)
def test_fits_that_are_refused(response, order, said):
    with pytest.raises(ExpressionError, match=said):
        fit(response, order)


def test_zeros_are_fitted_by_zero():
    assert fit(SampledResponse([1, 2, 3, 4], np.zeros(4), "S"), 2).at(W) == pytest.approx(0)


# ---- pictures and reports


@pytest.mark.parametrize("f", [W, np.geomspace(1, 1e6, 60)])
@pytest.mark.parametrize("parameter", ["Z", "S"])
def test_pictures_show_bands_and_models(tmp_path, f, parameter):
    values = 5 * ACTIVE.at(W)
    response = SampledResponse(f, values, parameter)
    verdict = check_samples(response)
    enforced = enforce(fit(response, 3), response)
    figure = draw_samples(verdict, enforced=enforced)
    figure.savefig(tmp_path / "samples.png")
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"samples", "samples violate the bound", "model as given", "nearest passive model"} <= set(labels)
    assert enforced.verdict.status.value in figure.get_suptitle()


def test_reports_are_json():
    response = samples_of(ACTIVE)
    told = check_samples(response).to_dict() | enforce(ACTIVE, response).to_dict()
    told = json.loads(json.dumps(told))
    assert told["status"] == "refuted"
    assert told["model"]["status"] == "proved"
    assert told["model"]["verified"] is True
    assert Fraction(told["witness"]["value"]) < 0
    assert len(told["caveats"]) == 2
    assert "witness" not in check_samples(SampledResponse([1], [1], "Z")).to_dict()
