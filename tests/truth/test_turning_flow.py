"""Friction where the flow turns, against a plain grid of characteristics that shares nothing with the solver."""

import functools

import numpy as np
import pytest
from one_line import one_line

from tline import simulate

T_END, EVERY = 4.0, 256  # s, which is so many delays; instants in a delay that are looked at
RADIUS, DENSITY, SPEED, FACTOR = 0.025, 900.0, 1e3, 0.03
AREA = np.pi * RADIUS**2
Z0 = DENSITY * SPEED / AREA
FRICTION = FACTOR * DENSITY / (4 * RADIUS * AREA**2) * SPEED  # Pa s²/m⁶ in a delay of 1 s
RATED_FLOW, RATED_DROP = 1e-3, 1e5


def flow(excess, line, square):
    """y of line·y + square |y| y = excess."""
    return 2 * excess / (line + np.sqrt(line**2 + 4 * square * np.abs(excess)))


def grid(n: int, pressure, orifice: float) -> np.ndarray:
    """Flow at the source, effort and flow at the orifice; the trapezoidal rule over reaches of 1/n of the delay."""
    lost, steps = FRICTION / n / 2, round(T_END * n)
    u, y, seen = np.zeros(n + 1), np.zeros(n + 1), np.zeros((3, steps + 1))
    for k in range(1, steps + 1):
        forward = (Z0 - lost * np.abs(y)) * y
        a, b = u[:-1] + forward[:-1], u[1:] - forward[1:]
        y = np.empty(n + 1)
        y[1:-1] = flow(a[:-1] - b[1:], 2 * Z0, 2 * lost)
        y[0] = flow(pressure[k] - b[0], Z0, lost)
        y[-1] = flow(a[-1], Z0, lost + orifice)
        u = np.empty(n + 1)
        u[1:-1] = (a[:-1] + b[1:]) / 2
        u[0], u[-1] = pressure[k], orifice * abs(y[-1]) * y[-1]
        seen[:, k] = y[0], u[-1], y[-1]
    return seen[:, :: n // EVERY]


@functools.cache
def exact(frequency: float) -> tuple[np.ndarray, np.ndarray]:
    """What grids extrapolate to, and the rest: a quarter of a step's change, for its order is 3 where flows turn."""
    coarse, middle, fine = (
        grid(n, 2e5 * np.sin(2 * np.pi * frequency * np.arange(T_END * n + 1) / n), RATED_DROP / RATED_FLOW**2)
        for n in (512, 1024, 2048)
    )
    best = fine + (fine - middle) / 3
    return best, np.abs(best - middle - (middle - coarse) / 3) / 4


@pytest.mark.parametrize(("frequency", "tol"), [(0.35, 1e-3), (0.35, 1e-5), (0.35, 1e-8), (0.6, 1e-3), (0.6, 1e-5)])
def test_errors_are_as_told(frequency, tol):
    pipe = {"length": SPEED, "radius": RADIUS, "density": DENSITY, "wave_speed": SPEED}
    pipe |= {"friction": {"kind": "darcy", "factor": FACTOR}}
    sine = {"shape": "sine", "amplitude": 2e5, "frequency": frequency}
    load = {"kind": "orifice", "flow": RATED_FLOW, "pressure_drop": RATED_DROP}
    result = simulate(one_line(T_END, pipe, sine, 0, load, medium="hydraulic"), tol=tol)
    assert result.accuracy.met
    known, doubts = exact(frequency)
    t = np.arange(1, T_END * EVERY) / EVERY
    assert (known.min(axis=1) < 0).all()  # it turns
    for where, letter, wanted, doubt in zip(("near", "far", "far"), "yuy", known, doubts, strict=True):
        size = np.abs(wanted).max()
        assert doubt.max() < 1e-9 * size
        told = getattr(result.accuracy.inside[where], letter)
        off = np.abs(getattr(result.probes[where].at(t), letter) - wanted[1:-1]).max() / size
        assert off <= told + doubt.max() / size
