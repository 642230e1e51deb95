"""The eye of the shipped stripline against the Fourier series of its pattern through its transfer function."""

from pathlib import Path

import numpy as np

from tline.frequency.response import respond
from tline.scene.file import read_scene
from tline.signal.bits import FINE, prbs7
from tline.signal.eye_diagram import eye

BIT, RISE, HARMONICS = 200e-12, 50e-12, 5_000
SCENE = Path(__file__).parents[2] / "scenes" / "stripline_eye.toml"


def test_a_pattern_sent_for_ever_is_its_fourier_series():
    """Harmonics of straight edges are sums over their corners; the answer to a bit is followed for 512 bits."""
    scene, bits = read_scene(SCENE), prbs7()
    period = len(bits) * BIT
    w = 2 * np.pi / period * np.arange(1, HARMONICS + 1)
    begins = np.flatnonzero(bits != np.roll(bits, 1))
    slopes = np.where(bits[begins], 1.0, -1.0) / RISE
    turn = 1 - np.exp(-1j * w * RISE)
    corners = sum(a * np.exp(-1j * w * k * BIT) * turn for k, a in zip(begins, slopes, strict=True))
    spectrum = -corners / (w**2 * period)
    passed = spectrum * respond(scene, 1j * w, "driver")["receiver"].u
    n = len(bits) * FINE
    whole = np.zeros(n, complex)
    np.add.at(whole, np.arange(1, HARMONICS + 1) % n, passed)
    u = 2 * np.fft.ifft(whole).real * n + bits.mean() * abs(respond(scene, 1e-3, "driver")["receiver"].u)
    seen = eye(scene, "receiver", BIT, RISE)
    assert np.abs(seen.u.ravel() - u).max() < 3e-6 * np.abs(u).max()
