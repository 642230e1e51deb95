"""Air valves with a third stage, and vacuum breakers, at the end of a line against SciPy's Radau method.

The other end is matched, so what arrives is what the source sent a delay ago: V' = -i with i = (w - p)/z0, and (p V)'
is in proportion to -q(p); q is the flow of air through orifices by the formulas of isentropic flow.
"""

from math import pi
from typing import Any

import numpy as np
import pytest
from matched_sine import MatchedSine
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import tline as tl

Z0, DELAY, OUTSIDE, T_END = 2e6, 0.1, 101_325.0, 2.5
HEAD, SWING, RATE = 3e4, 5e4, 0.5
LINE = MatchedSine(Z0, DELAY, HEAD, SWING, RATE, T_END)
INLET, OUTLET, SMALL, SWITCH = 0.05, 0.03, 0.01, 300.0
EARLY = 1e-5  # s after the instant at which it opens, from where the flow is proportional to the time


def scene(**more) -> tl.Scene:
    valve = {"kind": "air valve", "inlet_diameter": INLET, "outlet_diameter": OUTLET} | more
    return LINE.scene({"valve": valve}, order=4, slab=2.5e-4)


def area(diameter: float) -> float:
    return 0.6 * pi / 4 * diameter**2 * (287.05 * 293.15) ** 0.5


def leaving(e: float, outlet: float, small: float, switch: float) -> float:
    """Air out of the valve at so many atmospheres above the one outside, in m³/s of the air outside."""
    low = max(-abs(np.log1p(e)), 3.5 * np.log(2 / 2.4))
    rate = (-7 * np.exp(10 / 7 * low) * np.expm1(2 / 7 * low)) ** 0.5
    if e < 0:
        return -area(INLET) * rate
    way = min(max((e * OUTSIDE / switch - 1) / 0.5, 0), 1)
    share = way**2 * (3 - 2 * way)
    return ((1 - share) * area(outlet) + share * area(small)) * (1 + e) * rate


def by_hand(outlet, small, switch, t_end):
    """Gauge pressure over time, and when the valve opens and is shut again; states are V and p/p_outside - 1."""
    opens: Any = brentq(LINE.wave, DELAY + 0.5 / RATE, DELAY + 0.75 / RATE, xtol=1e-15)
    start = opens + EARLY

    def flow(t, e):
        return (LINE.wave(t) - OUTSIDE * e) / Z0

    least: Any = brentq(lambda e: (1 + e) * flow(start, e) - leaving(e, outlet, small, switch), -0.5, 0, xtol=1e-20)

    def rates(t, y):
        i = flow(t, y[1])
        return [-i, ((1 + y[1]) * i - leaving(y[1], outlet, small, switch)) / y[0]]

    def empty(t, y):
        return y[0] - 1e-12

    ends: Any = empty
    ends.terminal, ends.direction = True, -1
    options = {"rtol": 1e-10, "atol": [1e-17, 1e-14], "dense_output": True, "events": ends}
    done = solve_ivp(rates, (start, t_end), [-EARLY / 2 * flow(start, least), least], "Radau", **options)
    until = done.t[-1] if done.status == 1 else np.inf

    def pressure(t):
        return OUTSIDE * done.sol(t)[1] if start <= t <= min(until, t_end) else LINE.wave(t)

    return pressure, [opens, until]


@pytest.mark.parametrize(
    ("more", "outlet", "small", "switch"),
    [
        ({}, OUTLET, OUTLET, np.inf),
        ({"switch_pressure": SWITCH, "switched_diameter": SMALL}, OUTLET, SMALL, SWITCH),
        ({"outlet_diameter": 0}, 0.0, 0.0, np.inf),
    ],
    ids=["two stages", "three stages", "vacuum breaker"],
)
def test_the_pressure_is_that_of_the_equations(more, outlet, small, switch):
    exact, events = by_hand(outlet, small, switch, T_END)
    probe = tl.simulate(scene(**more)).probes["b"]
    t = probe.t[np.abs(probe.t[:, None] - np.array(events)).min(axis=1) > 3e-3]
    expected = np.array([exact(s) for s in t])
    assert probe.at(t).u == pytest.approx(expected, abs=1e-6 * (HEAD + SWING))


def test_half_a_stage_is_refused():
    with pytest.raises(tl.SceneError, match="half a third stage, expected switch_pressure and switched_diameter"):
        scene(switch_pressure=SWITCH)
