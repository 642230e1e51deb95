"""A tank that overflows and runs dry at the end of a lossless line, against its differential equation by DOP853.

The other end is matched, so what arrives is what the source sent a delay ago: C y' = i, i |i| / K² = w - z0 i - y with
the capacity K of each direction, y between the bottom and the rim.
"""

from math import inf, pi, sqrt

import numpy as np
import pytest
from one_line import one_line
from scipy.integrate import quad, solve_ivp

import tline as tl
from tline.scene.heights import GRAVITY

Z0, DELAY, HEAD, SWING, RATE, SECTION, AREA = 2e6, 0.1, 5e4, 3e4, 0.5, 0.003, 5e-3
WEIGHT = 1000 * GRAVITY


def scene(**more) -> tl.Scene:
    swing = {"shape": "sine", "offset": HEAD, "amplitude": SWING, "frequency": RATE}
    tank = {"at": "far", "kind": "open tank", "tank_area": AREA, "bore": SECTION, "gravity": GRAVITY} | more
    given = {"medium": "hydraulic", "start": "steady", "solver": {"order": 4, "slab": 2e-3}, "loads": {"x": tank}}
    return one_line(3.0, {"z0": Z0, "delay": DELAY}, swing, Z0, probes={"b": {"at": "far"}}, **given)


def wave(t: float) -> float:
    return HEAD + SWING * np.sin(2 * pi * RATE * (t - DELAY)) if t > DELAY else HEAD


def by_hand(t_end, start, low, high, losses, one_way=False):
    """Flow and effort inside at any instant, and instants at which the tank comes to its rim or its bottom."""
    inwards, outwards = (SECTION * sqrt(2 / (K * 1000)) if K else inf for K in losses)

    def flow(t, y):
        d = wave(t) - y
        C = inwards if d > 0 else outwards
        if one_way and d > 0:
            return 0.0
        return d / Z0 if C > 1e9 else 2 * d / (Z0 + sqrt(Z0**2 + 4 * abs(d) / C**2))

    pieces, met, t, y, at = [], [], 0.0, start, "between"
    while t < t_end - 1e-12:
        stop = {"over": high, "dry": low}.get(at, 0.0)
        events = (
            [lambda s, y: y[0] - low, lambda s, y: y[0] - high]
            if at == "between"
            else [lambda s, y, stop=stop: wave(s) - stop]
        )
        for event, direction in zip(events, (-1, 1) if at == "between" else (-1 if at == "over" else 1,), strict=True):
            event.terminal, event.direction = True, direction
        moves, until = at == "between", DELAY if t < DELAY else t_end
        done = solve_ivp(
            lambda s, y, moves=moves: [moves * flow(s, y[0]) * WEIGHT / AREA],
            (t, until), [y], "DOP853", rtol=1e-12, atol=1e-7, dense_output=True, events=events, max_step=0.01,
        )  # fmt: skip
        pieces.append((done.t[-1], at, done.sol))
        t, y = done.t[-1], done.y[0, -1]
        if done.status == 1:
            met.append(t)
            at = ("dry", "over")[len(done.t_events[1]) > 0] if at == "between" else "between"

    def seen(s):
        _, at, sol = next(piece for piece in pieces if s <= piece[0])
        inside = sol(s)[0]
        return (0.0 if at == "dry" else flow(s, inside)), inside

    return seen, met


CASES = {
    "throttled differently": (4.0, 0.0, None, (2.5, 40.0), False),
    "overflows": (5.0, 0.0, 5.5, (2.5, 40.0), False),
    "runs dry": (5.0, 4.6, None, (1.0, 1.0), False),
    "one-way, and runs dry": (4.5, 4.2, None, (1.0, 2.0), True),
}


@pytest.mark.parametrize("case", CASES)
def test_its_level_and_its_flow_are_those_of_its_equation(case):
    level, low, high, losses, one_way = CASES[case]
    ends = {"level": level, "lowest_level": low} | ({} if high is None else {"highest_level": high})
    result = tl.simulate(scene(**ends, loss_in=losses[0], loss_out=losses[1], one_way=one_way))
    rim = inf if high is None else high * WEIGHT
    seen, met = by_hand(result.t[-1], level * WEIGHT, low * WEIGHT, rim, losses, one_way)
    assert bool(met) == (case != "throttled differently")
    t = result.t[1::5]
    t = t[np.abs(t[:, None] - np.array([DELAY, *met])).min(axis=1) > 0.01]
    flow, inside = np.array([seen(s) for s in t]).T
    traces = {trace.word: np.interp(t, trace.t, trace.values) for trace in result.states}
    assert traces["level"] == pytest.approx(inside / WEIGHT, abs=1e-6 * level)
    assert result.probes["b"].at(t).y == pytest.approx(flow, abs=1e-6 * np.abs(flow).max())
    assert traces["inflow"] == pytest.approx(flow, abs=1e-6 * np.abs(flow).max())
    over = np.where(inside >= rim * (1 - 1e-12), np.maximum(flow, 0), 0)
    assert traces["overflow"] == pytest.approx(over, abs=1e-6 * np.abs(flow).max())


def test_what_runs_over_is_what_came_in_and_is_not_stored():
    ends = {"level": 5.0, "highest_level": 5.5, "loss_in": 2.5, "loss_out": 40.0}
    result = tl.simulate(scene(**ends))
    seen, _ = by_hand(result.t[-1], 5 * WEIGHT, 0, 5.5 * WEIGHT, (2.5, 40.0))
    came = quad(lambda s: seen(s)[0], 0, result.t[-1], limit=500)[0]
    traces = {trace.word: trace for trace in result.states}
    assert np.trapezoid(result.probes["b"].y, result.t) == pytest.approx(came, rel=1e-4)
    stored = AREA * (traces["level"].values[-1] - 5.0)
    assert np.trapezoid(traces["overflow"].values, result.t) == pytest.approx(came - stored, rel=1e-3)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"level": 6, "highest_level": 5}, "level: out of range, expected from lowest_level to highest_level, got 6 m"),
        ({"lowest_level": 3, "highest_level": 2}, "highest_level: too low, expected more than the lowest, 3 m"),
        ({"bore": None, "loss_in": 2}, "bore: is missing, expected the section that loss_in and loss_out refer to"),
    ],
)
def test_what_is_no_tank(more, said):
    with pytest.raises(tl.SceneError, match=said):
        scene(**more)
