"""Measured channels: pulses and eyes beside closed forms and lines, modes beside scikit-rf, delays that are known."""

import numpy as np
import pytest
from rc_channel import LATE, RC, T, exact_pulse, into_a_capacitor
from touchstone_files import of_chain

from passivity import SampledResponse, fit_scattering
from tline.errors import InputError
from tline.signal import measured_channel
from tline.signal.bits import FINE

F = np.linspace(0, 20e9, 401)
STEP = 20e-12  # s, of edges


def test_a_pulse_is_that_of_its_closed_form_and_comes_behind_the_delay_alone():
    """The delay is in front of one port alone, and is found; what is before it is 0, and not merely small."""
    seen = measured_channel(SampledResponse(F, into_a_capacitor(F), "S"))
    assert seen.found.verdict.proved
    assert (seen.found.order, seen.found.delay) == (1, pytest.approx([LATE, 0], abs=1e-15))
    pulse = seen.pulse(T, STEP)
    assert pulse.u[:12] == pytest.approx(exact_pulse(edge=STEP).u, abs=1e-5)
    assert not pulse.u.ravel()[: int(seen.found.delay.sum() / T * FINE)].any()
    halved = seen.pulse(T, STEP, low=-0.25, high=0.25)
    assert halved.u == pytest.approx(pulse.u / 2, abs=1e-12)
    assert halved.base == pytest.approx(-0.25, abs=1e-6)


def test_a_step_sends_back_what_a_capacitor_does():
    """-sRC/(1 + sRC) of a ramp: a dip of its own length, twice the delay late."""
    profile = measured_channel(SampledResponse(F, into_a_capacitor(F), "S")).reflections(STEP)
    x = profile.t - 2 * LATE
    answer = lambda t: np.where(t > 0, -RC * (1 - np.exp(-np.maximum(t, 0) / RC)), 0.0) / STEP  # noqa: E731
    assert profile.reflected == pytest.approx(answer(x) - answer(x - STEP), abs=1e-5)


def of_pairs(n=5, seed=2):
    """Any S of six ports against 50 ohm."""
    rng = np.random.default_rng(seed)
    return SampledResponse(np.arange(1, n + 1) * 1e9, rng.normal(size=(n, 6, 6, 2)) @ [0.1, 0.1j], "S")


def test_modes_are_those_of_scikit_rf():
    pytest.importorskip("skrf")
    given = of_pairs()
    ours = given.between([[0, 2], [1, 3]])
    theirs = given.network().subnetwork([0, 2, 1, 3])
    theirs.se2gmm(p=2)
    assert ours.values == pytest.approx(theirs.s, abs=1e-14)
    assert ours.z0 == pytest.approx(theirs.z0[0].real)
    assert given.between([[4], [0, 5]]).values[:, 0, 0] == pytest.approx(given.values[:, 4, 4])


def test_cascades_are_made_in_scikit_rf_and_handed_back():
    """Two delays in a row, then one of them taken away again, as 2x-thru does."""
    pytest.importorskip("skrf")
    one = SampledResponse(F[1:], into_a_capacitor(F[1:]), "S", 75).network("trace")
    both = one**one
    seen = SampledResponse.from_network(one.inv**both)
    assert seen.values == pytest.approx(one.s, abs=1e-12)
    assert seen.z0.tolist() == [75, 75]
    assert measured_channel(one).title == "trace"


@pytest.mark.parametrize("delays", [(0.31e-9, 0.74e-9), (0.2e-9, 0.0, 0.5e-9)])
def test_unlike_delays_are_found(delays):
    """Dividers with a pole behind known delays, to a thousandth of a period of the highest frequency."""
    p, f = len(delays), np.linspace(1e7, 10e9, 300)
    s, T = 2j * np.pi * f[:, None, None], np.array(delays)
    S = (1.6 / p - 0.9 * np.eye(p)) / (1 + s * 5e-11) * np.exp(-s * (T[:, None] + T))
    found = fit_scattering(SampledResponse(f, S, "S"), 1e-6)
    assert found.order == 1
    assert found.delay == pytest.approx(delays, abs=1e-3 / f[-1])


def test_noise_is_not_fitted_and_the_model_is_nearer_to_the_truth_than_the_samples():
    """Noise of 2e-3 on a known channel whose gain it lifts above 1: thrice that is met."""
    rng, f = np.random.default_rng(1), np.linspace(0, 10e9, 400)
    exact = into_a_capacitor(f, 0.0)
    noise = 1.4e-3 * (rng.normal(size=exact.shape) + 1j * rng.normal(size=exact.shape))
    found = fit_scattering(SampledResponse(f, exact + noise, "S"), 7e-3, nearest=True)
    assert found.verdict.proved
    assert found.order <= 2
    assert np.abs(found.model.at(2 * np.pi * f) - exact).max() < 1e-3


@pytest.mark.parametrize(
    ("ports", "said"),
    [("1", "not ports or pairs"), ("1 3", "not single ports and pairs"), ("1,2 1", "not single ports and pairs")],
)
def test_ports_that_are_none(ports, said):
    with pytest.raises(InputError, match=said):
        measured_channel(SampledResponse(F, into_a_capacitor(F), "S"), ports)


def test_pairs_of_unlike_references_are_refused():
    S = of_chain([[1 + 0 * F, 0 * F], [0 * F, 1 + 0 * F]])
    with pytest.raises(
        InputError, match="unlike references of 1 and 2, expected a pair of like ones, got 50 and 75 ohm"
    ):
        SampledResponse(F, S, "S", [50, 75]).between([[0, 1]])
