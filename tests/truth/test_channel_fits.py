"""An ordinary channel of 30 cm, causal with skin effect and dielectric loss, as a file: fitted and proved."""

from dataclasses import replace

import numpy as np
import pytest
from touchstone_files import of_chain

from passivity import SampledResponse, fit_scattering
from tline.signal import measured_channel, statistical_eye
from tline.signal.pulse import FINE

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
