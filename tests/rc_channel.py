"""A matched delay into a capacitor beside its matched end, in closed form: its S, and the pulse of straight edges."""

import numpy as np

from tline.signal.bits import FINE
from tline.signal.pulse import PulseResponse

T = 100e-12
RC, LATE = 60e-12, 250e-12


def exact_pulse(n=12, edge=20e-12):
    """Of straight edges through an RC behind a delay, in closed form."""
    t = np.arange(n * FINE) / FINE * T - LATE
    ramp = lambda t: np.where(t > 0, t - RC * (1 - np.exp(-np.maximum(t, 0) / RC)), 0.0) / edge  # noqa: E731
    u = ramp(t) - ramp(t - edge) - ramp(t - T) + ramp(t - T - edge)
    return PulseResponse(T, u.reshape(n, FINE), 0.0, 0.0)


def into_a_capacitor(f, late=LATE):
    """S of a matched delay with a capacitor at its end, RC = 25 ohm C."""
    s = 2j * np.pi * f
    through, back = np.exp(-s * late) / (1 + s * RC), -s * RC / (1 + s * RC)
    return np.moveaxis(np.array([[back * np.exp(-2 * s * late), through], [through, back]]), 2, 0)
