"""An ordinary channel of 30 cm, causal with skin effect and dielectric loss, as a file: fitted and proved."""

from dataclasses import replace

import numpy as np
import pytest
from touchstone_files import of_chain

from passivity import PoleResidueModel, RationalFunction, SampledResponse, fit_scattering
from passivity.sampled.mirror import joined, mirrored, on_grid
from tline.signal import measured_channel, statistical_eye
from tline.signal.bits import FINE

LENGTH, Z0, L = 0.3, 50.0, 3.1e-7  # m, ohm, H/m
LOW, HIGH, TANGENT = 2 * np.pi * 1e4, 2 * np.pi * 1e13, 0.015  # rad/s between which the loss tangent is nearly constant


def channel(f, zc=52.0, resistance=5.0, skin=1.2e-3):
    """S of a uniform line of 1.8 ns, from R + k sqrt(s) + s L and Djordjevic and Sarkar's C(s)."""
    s = 2j * np.pi * f

    def storage(s):
        return 1 + TANGENT * 2 / np.pi * np.log((HIGH + s) / (LOW + s))

    C = L / zc**2 * storage(s) / storage(2j * np.pi * 1e9).real
    Z, Y = resistance + skin * np.sqrt(s) + s * L, s * C + 1e-12
    gamma, zc = np.sqrt(Z * Y) * LENGTH, np.sqrt(Z / Y)
    return of_chain([[np.cosh(gamma), zc * np.sinh(gamma)], [np.sinh(gamma) / zc, np.cosh(gamma)]], Z0)


F = np.arange(1, 401) * 20e6  # Hz, to 8 GHz


def test_a_channel_is_fitted_through_the_plateau_of_its_delay_and_proved():
    """In between the samples as well; 14 turns of the phase take as many pairs of poles, and fewer show nothing."""
    orders = []
    found = fit_scattering(SampledResponse(F, channel(F), "S"), 1e-3, progress=lambda *tried: orders.append(tried))
    assert found.verdict.proved
    between = F[:-1] + 7e6
    assert np.abs(found.model.at(2 * np.pi * between) - channel(between)).max() < 1e-3
    assert found.order > 40
    assert sum(error > 0.1 for _, error in orders) > 5


def test_a_line_as_a_file_has_the_pulse_and_the_eye_of_the_line_itself():
    """30 cm with skin effect and dielectric loss: what its S says, and the inverse FFT of its propagation constant."""
    f, period, edge = np.append(1e6, np.arange(1, 126) * 40e6), 0.5e-9, 0.25e-9
    law = lambda f: channel(f, skin=6e-3)  # noqa: E731
    seen = measured_channel(SampledResponse(f, law(f), "S"), tol=1e-4)  # cursors add up their errors
    assert seen.found.verdict.proved
    assert seen.found.error < 1e-4
    bits, fine = 512, 8 * FINE  # fewer wrap around too much of the tail that skin effect leaves
    t, spectrum = np.arange(bits * fine) * period / fine, np.fft.rfftfreq(bits * fine, period / fine)
    spectrum[0] = 1.0  # Hz, for the law has no value at rest
    sent = np.fft.rfft(np.interp(t, [0, edge, period, period + edge], [0, 1, 1, 0]))
    exact = np.fft.irfft(sent * law(spectrum)[:, 1, 0], len(t))[::8].reshape(bits, FINE)
    ours = seen.pulse(period, edge)
    assert np.abs(ours.u[:64] - exact[:64]).max() < 3e-3 < ours.unmeasured < 0.03
    ours, theirs = (statistical_eye(replace(ours, u=u[:64])) for u in (ours.u, exact))
    assert ours.height == pytest.approx(theirs.height, abs=3e-3)


def of_pair(f, second):
    """S of two coupled conductors of 0.4 m, ports at one end and then at the other; the second of its own width."""
    s, L = 2j * np.pi * f, np.array([[3.2e-7, 0.5e-7], [0.5e-7, second]])
    C = np.linalg.inv(L) * 4.4e-17 * (1 + 0.03 * np.eye(2))  # modes of unlike speeds
    own = (5 + 1.2e-3 * np.sqrt(s))[:, None, None] * (np.eye(2) + 0.1)
    Z, Y = own + s[:, None, None] * L, s[:, None, None] * C
    squares, T = np.linalg.eig(Z @ Y)
    e, back = np.exp(-0.4 * np.sqrt(squares))[:, None], np.linalg.inv(T)
    to_flows = np.linalg.solve(Z, T * np.sqrt(squares)[:, None])
    here, there = (to_flows * x @ back for x in ((1 + e**2) / (1 - e**2), -2 * e / (1 - e**2)))
    flows = Z0 * np.block([[here, there], [there, here]])
    S = np.linalg.solve(np.eye(4) + flows, np.eye(4) - flows)
    return (S + S.swapaxes(1, 2)) / 2


@pytest.mark.parametrize(("second", "halves"), [(3.2e-7, 4), (2.8e-7, 2)])
def test_a_pair_is_fitted_by_what_its_symmetry_makes_of_it(second, halves):
    """Alike conductors are four reflections, unlike ones two networks of two ports, by the exchange of the ends."""
    f = np.arange(1, 201) * 24e6
    found = fit_scattering(SampledResponse(f, of_pair(f, second), "S"), 1e-3, nearest=True)
    assert found.verdict.proved
    assert [part.ports for part in found.parts] == [4 // halves] * halves
    between = f[:-1] + 10e6
    S = found.model.matrices(2 * np.pi * between)
    assert np.abs(S - of_pair(between, second)).max() < 1e-3
    assert np.linalg.norm(S, 2, axis=(1, 2)).max() <= 1
    assert found.model.entry(2, 0).order == found.order > 100
    A, B, C, D = found.model.realised()
    assert len(A) == sum(part.order * part.ports for part in found.parts)
    one = D + C @ np.linalg.solve(2j * np.pi * f[30] * np.eye(len(A)) - A, B)
    np.testing.assert_allclose(one, found.model.matrices(2 * np.pi * f[30:31])[0], atol=1e-12)


def test_halves_add_up_exactly():
    """S between waves alike and opposite is that of the halves, in rational numbers, not only nearly."""
    rng = np.random.default_rng(4)
    halves = [
        on_grid(PoleResidueModel([-1 + 2j * k], rng.normal(size=(1, 2, 2)) + 1j, rng.normal(size=(2, 2))))
        for k in (1, 2)
    ]
    w, swap = np.linspace(0, 5, 30), np.array([2, 3, 0, 1])
    values = joined(swap, halves).matrices(w)
    found = mirrored(SampledResponse(w, values, "S"), 1e-9)
    assert found is not None
    assert found[0].tolist() == swap.tolist()
    whole = joined(swap, halves)
    for sign, half in zip((1, -1), halves, strict=True):
        for i, k in np.ndindex(2, 2):
            to, opposite, own = (S.entry(i, j).rational() for S, j in ((whole, k), (whole, k + 2), (half, k)))
            assert isinstance(opposite, RationalFunction)
            assert isinstance(own, RationalFunction)
            assert own - opposite * sign == to
