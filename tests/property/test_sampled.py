"""What always holds: positive elements are never refuted, tolerance only helps, and enforcement ends in a proof."""

from fractions import Fraction

import numpy as np
from hypothesis import given, settings, strategies as st

from passivity import PoleResidueModel, SampledResponse, Status, check_samples, enforce, fit, verify

W = np.linspace(0.01, 4, 40)
elements = st.floats(0.01, 100)
parts = st.floats(-2, 2).map(lambda x: round(x, 3))


@st.composite
def ladders(draw):
    """Samples of Z, Y or S of a ladder of coils with resistance and capacitors with conductance."""
    z = np.full(len(W), draw(elements), complex)
    for _ in range(draw(st.integers(0, 6))):
        z = 1 / (draw(elements) + 1j * W * draw(elements) + 1 / (z + draw(elements) + 1j * W * draw(elements)))
    parameter = draw(st.sampled_from("ZYS"))
    return SampledResponse(W, {"Z": z, "Y": 1 / z, "S": (z - 1) / (z + 1)}[parameter], parameter)


@st.composite
def matrices(draw):
    """Arbitrary samples of one to three ports."""
    p, n = draw(st.integers(1, 3)), draw(st.integers(1, 6))
    numbers = draw(st.lists(parts, min_size=2 * n * p * p, max_size=2 * n * p * p))
    values = np.array(numbers[::2]) + 1j * np.array(numbers[1::2])
    return SampledResponse(range(n), values.reshape(n, p, p), draw(st.sampled_from("ZYS")))


@st.composite
def models(draw):
    """Models with stable poles, passive or not."""
    count, parameter = draw(st.integers(0, 4)), draw(st.sampled_from("ZYS"))
    poles = [complex(-draw(st.floats(0.01, 2)), draw(st.just(0.0) | st.floats(0.01, 3))) for _ in range(count)]
    residues = [complex(draw(parts), draw(parts) if a.imag else 0) for a in poles]
    return PoleResidueModel(poles, residues, draw(parts), 0 if parameter == "S" else draw(st.floats(0, 2)), parameter)


def covers(bands, f):
    return any(band.first <= f <= band.last for band in bands)


@given(ladders())
def test_circuits_of_positive_elements_are_never_refuted(response):
    assert check_samples(response).status is Status.NO_VIOLATION


@given(matrices(), st.floats(0, 3), st.floats(0, 3))
def test_a_larger_tolerance_never_adds_a_violation(response, a, b):
    small, large = check_samples(response, min(a, b)), check_samples(response, max(a, b))
    assert large.status is Status.NO_VIOLATION or small.status is Status.REFUTED
    assert {f for band in large.bands for f in band[:2]} <= {f for f in response.f if covers(small.bands, f)}


@given(matrices(), st.floats(0, 1))
def test_refuted_means_a_witness_that_convinces(response, tolerance):
    verdict = check_samples(response, tolerance)
    assert (verdict.status is Status.REFUTED) == bool(verdict.bands) == (verdict.witness is not None)
    if verdict.witness:
        matrix, v = response.values[verdict.witness.sample], np.array(verdict.witness.vector)
        if response.parameter == "S":
            assert np.linalg.norm(matrix @ v) > (1 + tolerance) * np.linalg.norm(v)
        else:
            assert (v.conj() @ matrix @ v).real < -tolerance * (v.conj() @ v).real
        assert verdict.witness.bar >= Fraction(tolerance)


@given(matrices())
def test_the_order_of_ports_does_not_matter(response):
    turned = SampledResponse(response.f, response.values[:, ::-1, ::-1], response.parameter)
    one, other = check_samples(turned), check_samples(response)
    assert np.isclose(one.worst_value, other.worst_value, rtol=1e-9, atol=1e-12)


@settings(max_examples=10, deadline=None)
@given(models())
def test_enforcement_ends_in_a_proof(model):
    result = enforce(model, SampledResponse(W / (2 * np.pi), model.at(W), model.parameter))
    assert result.verdict.status is Status.PROVED
    assert verify(result.verdict.certificate)
    assert result.model.poles.tolist() == model.poles.tolist()
    values = result.model.at(np.concatenate([[0.0], np.geomspace(1e-4, 1e6, 400)]))
    size = np.abs(values).max()
    if model.parameter == "S":
        assert np.abs(values).max() <= 1 + 1e-12
    else:
        assert values.real.min() >= -1e-12 * size
    again = enforce(result.model, SampledResponse(W / (2 * np.pi), result.model.at(W), model.parameter))
    assert again.rounds == 0


@settings(max_examples=6, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from("ZYS"), st.integers(0, 8))
def test_a_fit_to_anything_is_stable_and_can_be_made_passive(seed, parameter, order):
    rng = np.random.default_rng(seed)
    response = SampledResponse(W, rng.normal(size=40) + 1j * rng.normal(size=40), parameter)
    model = fit(response, order)
    assert (model.poles.real < 0).all()
    assert enforce(model, response).verdict.status is Status.PROVED
