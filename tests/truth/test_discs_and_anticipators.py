"""What opens once a pressure is reached, and stays open or follows a course, against the closed form at a matched line.

The source is matched, so what arrives is what it sent a delay ago: u = w - z0 i with i = K x sqrt(u) has one root.
"""

from math import sqrt

import numpy as np
import pytest
from matched_sine import MatchedSine
from scipy.optimize import brentq

import tline as tl

Z0, DELAY, HEAD, SWING, RATE, T_END = 2e6, 0.1, 5e5, 2e5, 0.25, 5.0
CAPACITY = 0.05 / sqrt(5e5)


def line(sign: float) -> MatchedSine:
    return MatchedSine(Z0, DELAY, HEAD, sign * SWING, RATE, T_END)


def scene(sign: float) -> tl.Scene:
    outlet = {"kind": "orifice", "flow": 0.05, "pressure_drop": 5e5, "opening": 0}
    return line(sign).scene({"outlet": outlet})


def expected(t, sign, reached, opening):
    """Pressure at the end, and the instant at which it is reached."""
    wave = line(sign).wave
    opens = brentq(lambda t: wave(t) - reached, DELAY, DELAY + 0.25 / RATE, xtol=1e-15)

    def pressure(t):
        half = Z0 * CAPACITY * opening(t - opens) / 2 if t > opens else 0.0
        return (sqrt(half**2 + wave(t)) - half) ** 2

    return np.array([pressure(s) for s in t]), opens


def check(surge, sign, reached, opening, apart):
    probe = surge.result.probes["b"]
    _, opens = expected([], sign, reached, opening)
    t = np.linspace(0.01, T_END, 400)
    t = t[np.abs(t[:, None] - opens - apart).min(axis=1) > 0.02]
    u, _ = expected(t, sign, reached, opening)
    assert probe.at(t).u == pytest.approx(u, abs=1e-6 * HEAD)
    assert any(f"after {opens:.6g} s" in note for note in surge.notes)


def test_a_rupture_disc_bursts_once_and_stays_open():
    surge = tl.operate(scene(1), when="b>6 bar: open outlet", t_end=T_END, tol=1e-7, cavities=False)
    check(surge, 1, 6e5, lambda since: 1.0, np.zeros(1))


def test_a_surge_anticipator_opens_as_the_pressure_falls_and_shuts_slowly(folder):
    course = np.array([[0, 0], [0.2, 1], [1, 1], [3, 0]])
    (folder / "cycle.csv").write_text("time,opening\n" + "\n".join(f"{t},{x}" for t, x in course))
    surge = tl.operate(scene(-1), when="b<4 bar: open outlet:cycle.csv", t_end=T_END, tol=1e-7, cavities=False)
    check(surge, -1, 4e5, lambda since: np.interp(since, *course.T), course[:, 0])
