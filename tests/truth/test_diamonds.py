"""Friction all along pipes against a plain grid of characteristics on which the front is held double-valued."""

import numpy as np
import pytest
from diamond_scenes import RISE, at_once, pipes, shut

from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.solver.simulate import simulate

DELAYS = 8


def grid(N: int, R: float, delays: int) -> np.ndarray:
    """Pressure at a valve that shuts at t = 0, over Joukowsky's rise, N times a delay; friction R |y| y per delay.

    The trapezoidal rule along both characteristics. Every point has limits from the left and from the right, which
    differ at the front alone: a jump of the wave that it runs with.
    """
    h = 1 / N

    def solved(p, q):
        d = p - q
        y = np.sign(d) * (np.sqrt(1 + h * R * np.abs(d)) - 1) / (h * R)
        return p - h * R * np.abs(y) * y / 2, q + h * R * np.abs(y) * y / 2

    u = -R * np.arange(N + 1) / N
    left = right = np.array([u + 1, u - 1])
    right = right.copy()
    right[1, N] = right[0, N]  # the flow has stopped behind the front
    front, way, seen = N, -1, [right[:, N].mean()]
    for _ in range(delays * N):
        (aL, bL), (aR, bR) = (
            w - np.array([[1], [-1]]) * h * R * np.abs(w[0] - w[1]) * (w[0] - w[1]) / 8 for w in (left, right)
        )
        new = np.empty((2, N + 1))
        new[0, 1:], new[1, :-1] = aR[:-1], bL[1:]
        new[:, 0] = end(new[1, 0], R, h, -1)
        new[:, N] = end(new[0, N], R, h, 1)
        new[:, 1:-1] = solved(*new[:, 1:-1])
        left, right, front = new, new.copy(), front + way
        if way < 0 and front:
            a = new[0, front]  # has not met the front before it came here
            right[1, front] = a - 2 * behind(a - bR[front + 1], R, h)
        elif way < 0:
            left = new.copy()  # what was there before the front came follows what came with it
            left[:, 0] = end(bR[1], R, h, -1)
        elif front < N:
            b = new[1, front]
            left = new.copy()
            left[0, front] = b + 2 * behind(aL[front - 1] - b, R, h)
        else:
            right[:, N] = end(aL[N - 1], R, h, 1)
        if front in (0, N):
            way = -way
        seen.append(right[:, N].mean())
    return np.array(seen)


def behind(d, R, h):
    """Flow y of 2 y + h R |y| y/2 = d: of one wave that runs with the front, and loses by the flow behind it."""
    return np.sign(d) * (np.sqrt(4 + 2 * h * R * abs(d)) - 2) / (h * R)


def end(come, R, h, sign):
    """(a, b) at the shut valve, where b = a, and at the reservoir, where a = -b."""
    if sign > 0:
        return come, come
    b = come if come == 0 else -np.sign(-come) * (np.sqrt(1 + 2 * h * R * abs(come)) - 1) / (h * R)
    return -b, b


@pytest.fixture(scope="module")
def reference():
    """Extrapolated, and how well: friction of a fifth of the rise."""
    coarse, fine, finest = (grid(n, 0.2, DELAYS)[:: n // 4] for n in (64, 128, 256))
    once, twice = (4 * fine - coarse) / 3, (4 * finest - fine) / 3
    away = np.arange(len(twice)) % 8 != 0  # from the front
    assert np.abs(twice - once)[away].max() < 1e-8
    return twice


@pytest.mark.parametrize("at", [0.0, 0.37])
def test_a_flow_that_stops_at_once(reference, at):
    result = simulate(shut(at_once(at), pipes(1.0, kind="darcy", factor=0.2), DELAYS + at), tol=1e-7)
    assert result.accuracy
    assert result.accuracy.met
    k = np.arange(1, 4 * DELAYS)
    k = k[k % 8 != 0]  # where a front is
    assert np.abs(result.probes["valve"].at(k / 4 + at).u / RISE - reference[k]).max() < 1e-7


def test_one_slab_a_delay(reference):
    scene, k = shut(at_once(0.0), pipes(1.0, kind="darcy", factor=0.2), DELAYS), np.arange(1, DELAYS)
    k = k[k % 2 != 0]
    for order, close in ((2, 2e-5), (3, 1e-7), (4, 1e-8)):  # as the scheme without this kernel has it
        found = run(describe(scene), Resolution(order, 1.0, diamonds=True)).probes["valve"].u[k] / RISE
        assert np.abs(found - reference[4 * k]).max() < close


def test_two_pipes_in_slabs_that_divide_no_delay_but_one(reference):
    """A pipe in two parts is that pipe, wherever it is parted."""
    scene = shut(at_once(0.3), pipes(0.61, 0.39, kind="darcy", factor=0.2), DELAYS + 0.3)
    result = simulate(scene, tol=1e-7)
    k = np.arange(1, 4 * DELAYS)
    k = k[k % 8 != 0]
    assert np.abs(result.probes["valve"].at(k / 4 + 0.3).u / RISE - reference[k]).max() < 1e-7
