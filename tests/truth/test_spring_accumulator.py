"""An accumulator on a spring at the end of a lossless line, against its differential equation by DOP853."""

from math import inf, pi

import numpy as np
import pytest
from one_line import one_line
from scipy.integrate import solve_ivp

import tline as tl

Z0, BEHIND, DELAY, HEAD, SWING, RATE = 2e7, 1e7, 0.1, 6e5, 2e5, 0.8
DIAMETER, STIFFNESS = 0.3, 4e5
AREA = pi / 4 * DIAMETER**2
PER_PRESSURE = AREA**2 / STIFFNESS


def scene(preload: float, solver: dict | None = None, **more) -> tl.Scene:
    """A pipe between a pressure that swings and the accumulator."""
    swing = {"shape": "sine", "offset": HEAD, "amplitude": SWING, "frequency": RATE}
    accumulator = {"kind": "spring accumulator", "piston_diameter": DIAMETER, "stiffness": STIFFNESS}
    behind, load = more.pop("behind", BEHIND), {"x": {"at": "far", "preload": preload} | accumulator | more}
    given = {"medium": "hydraulic", "start": "steady", "solver": solver or {}, "probes": {"b": {"at": "far"}}}
    return one_line(2.0, {"z0": Z0, "delay": DELAY}, swing, behind, loads=load, **given)


def source(t: float) -> float:
    """Pressure behind the resistance."""
    return HEAD + SWING * np.sin(2 * pi * RATE * t) if t > 0 else HEAD


def test_its_spring_is_a_differential_equation():
    """Round trip by round trip: what arrives is known from the one before."""
    preload = 1e5  # which the pressure never falls below
    found = tl.simulate(scene(preload), tol=1e-8).probes["b"]
    pieces, inside = [], HEAD

    def arriving(t: float) -> float:
        if t <= DELAY:
            return HEAD
        k_before = int((t - 2 * DELAY) // (2 * DELAY))
        back = HEAD if t <= 2 * DELAY else pieces[min(k_before, len(pieces) - 1)](t - 2 * DELAY)
        return (2 * source(t - DELAY) * Z0 + back * (BEHIND - Z0)) / (BEHIND + Z0)

    for n in range(10):
        begin, end = 2 * n * DELAY, 2 * (n + 1) * DELAY
        parts, since = [], begin
        for until in (begin + DELAY, end):  # where the source begins, the rate of what arrives jumps
            done = solve_ivp(
                lambda t, p: (arriving(t) - p) / Z0 / PER_PRESSURE, (since, until), [inside], "DOP853",
                rtol=1e-11, atol=1e-6, dense_output=True, max_step=DELAY / 2,
            )  # fmt: skip
            parts.append(done.sol)
            inside, since = done.y[0, -1], until

        def leaving(t, parts=parts, middle=begin + DELAY):
            return 2 * parts[int(t > middle)](t)[0] - arriving(t)

        pieces.append(leaving)
    t = found.t[1 :: len(found.t) // 80]
    exact = [(arriving(one) + pieces[min(int(one // (2 * DELAY)), 9)](one)) / 2 for one in t]
    assert found.at(t).u == pytest.approx(np.array(exact), abs=1e-7 * HEAD)


def stops(preload: float, full: float, t_end: float):
    """Pressure at the accumulator, and instants at which its piston meets a stop; the other end is matched."""
    pieces, meets, t, p, at = [], [], 0.0, HEAD, "between"
    while t < t_end - 1e-12:
        if at == "between":
            events = [lambda s, y: y[0] - preload, lambda s, y: y[0] - full]
            events[0].direction, events[1].direction = -1, 1
        else:
            stop = preload if at == "empty" else full
            events = [lambda s, y, stop=stop: source(s - DELAY) - stop]
            events[0].direction = 1 if at == "empty" else -1
        for event in events:
            event.terminal = True
        moves = at == "between"
        done = solve_ivp(
            lambda s, y, moves=moves: [moves * (source(s - DELAY) - y[0]) / Z0 / PER_PRESSURE],
            (t, t_end), [p], "DOP853", rtol=1e-12, atol=1e-7, dense_output=True, events=events, max_step=DELAY / 20,
        )  # fmt: skip
        pieces.append((t, done.t[-1], moves, done.sol))
        t, p = done.t[-1], done.y[0, -1]
        if done.status == 1:
            met = next(k for k, times in enumerate(done.t_events) if len(times))
            meets += [t] if at == "between" else []
            at = ("empty", "full")[met] if at == "between" else "between"

    def pressure(s: float) -> float:
        _, _, moves, sol = next(piece for piece in pieces if s <= piece[1])
        return sol(s)[0] if moves else source(s - DELAY)

    return pressure, meets


def test_it_stops_when_it_is_empty_and_when_it_is_full():
    """The flow into it stops at once: a front, which the run sends at an instant that it finds."""
    preload, stroke = 5.5e5, 0.02
    result = tl.simulate(scene(preload, stroke=stroke, behind=Z0, solver={"order": 3, "slab": 2e-3}))
    found = result.probes["b"]
    pressure, meets = stops(preload, preload + STIFFNESS * stroke / AREA, result.t[-1])
    assert len(meets) >= 3
    t = np.linspace(0, result.t[-1], 401)
    t = t[np.abs(t[:, None] - np.array(meets)).min(axis=1) > 0.02]
    exact = np.array([pressure(one) for one in t])
    assert found.at(t).u == pytest.approx(exact, abs=1e-3 * HEAD)


def test_nothing_is_lost_and_what_it_holds_comes_back():
    ledger = tl.simulate(scene(1e5), tol=1e-8, ledger=True).ledger
    assert ledger is not None
    assert ledger.residual < 1e-6


def test_its_stroke_may_be_endless():
    law = tl.scene.SpringAccumulator(at="b", piston_diameter=DIAMETER, stiffness=STIFFNESS, preload=1e5).law()
    assert law.constants == (0.0, pytest.approx(PER_PRESSURE), 1e5, inf)
