"""Bode plots: what is drawn, once each, marked, and said on the axes."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tline.frequency.oscillations import Resonance
from tline.pictures.bode import plot_curves

F = np.geomspace(1e6, 1e9, 2001)
DELAYED = 0.5 * np.exp(-2j * np.pi * F * 20e-9)  # turns twenty times


def plot(curves, what, unit, modes=(), ax=None) -> Any:
    found: Any = SimpleNamespace(
        f=F, curves=curves, what=what, unit=unit, oscillations=modes, scene=SimpleNamespace(title="")
    )
    return plot_curves(found, ax)


def test_magnitude_and_phase_of_a_long_delay():
    upper, lower = plot({"a": DELAYED}, "voltage / source", "V/V").axes
    (size,) = upper.lines
    assert size.get_ydata() == pytest.approx(20 * np.log10(0.5))
    x, phase = (np.asarray(values, float) for values in lower.lines[0].get_data())
    shown = ~np.isnan(x)
    assert np.exp(1j * np.radians(phase[shown])) == pytest.approx(2 * DELAYED, abs=1e-9)
    assert np.abs(np.diff(phase))[~np.isnan(np.diff(phase))].max() <= 180  # no strokes from edge to edge
    assert (~shown).sum() == 20
    assert upper.get_ylabel() == "|voltage / source|\n[dB re 1 V/V]"
    assert lower.get_ylabel() == "phase modulo 360° [°]"
    assert lower.get_xlabel() == "frequency [GHz]"


def test_curves_that_are_alike_are_drawn_once_under_all_their_names():
    curves = {"S(a,a)": 0.1 * DELAYED, "S(a,b)": DELAYED, "S(b,a)": DELAYED * (1 + 1e-14), "S(b,b)": 0.2 * DELAYED}
    upper, lower = plot(curves, "S", "1").axes
    assert [line.get_label() for line in upper.lines] == ["S(a,a)", "S(a,b) = S(b,a)", "S(b,b)"]
    assert len(lower.lines) == 3
    assert upper.get_ylabel() == "|S|\n[dB re 1]"


def test_natural_oscillations_are_marked_where_they_are_and_those_that_grow_apart():
    modes = [
        Resonance(complex(sigma, 2 * np.pi * f)) for sigma, f in ((-1e6, 2e6), (1e5, 3e7), (-1e6, 5e9), (1e3, 0.0))
    ]
    upper = plot({"a": DELAYED}, "S", "1", modes).axes[0]
    marks = {line.get_label(): list(line.get_xdata()) for line in upper.lines[1:]}
    assert marks == {"natural oscillation": pytest.approx([0.002]), "grows": pytest.approx([0.03])}
