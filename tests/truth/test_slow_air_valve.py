"""An air valve whose outlet shuts in a time, at the end of a line, against SciPy's Radau method.

While there is air V' = -i and (p V)' is in proportion to what passes the orifices; then liquid leaves through what of
the outlet is open still, and after that nothing.
"""

from math import pi

import numpy as np
import pytest
from matched_sine import MatchedSine
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import tline as tl

Z0, DELAY, OUTSIDE, T_END = 2e6, 0.1, 101_325.0, 2.4
HEAD, SWING, RATE = 3e4, 5e4, 0.5
LINE = MatchedSine(Z0, DELAY, HEAD, SWING, RATE, T_END)
INLET, OUTLET, EARLY = 0.05, 0.03, 1e-5
PER_AREA = 0.6 * (287.05 * 293.15) ** 0.5


def passing(e, share):
    """Air that leaves, in m³/s of the air outside, at so many atmospheres above the one outside."""
    low = max(-abs(np.log1p(e)), 3.5 * np.log(2 / 2.4))
    rate = (-7 * np.exp(10 / 7 * low) * np.expm1(2 / 7 * low)) ** 0.5 * PER_AREA * pi / 4
    return -(INLET**2) * rate if e < 0 else share * OUTLET**2 * (1 + e) * rate


def by_hand(shuts: float):
    """Gauge pressure over time, and the instants at which it opens, air leaves, air is gone, and it is shut."""
    opens = brentq(LINE.wave, DELAY + 0.5 / RATE, DELAY + 0.75 / RATE, xtol=1e-15)
    start = opens + EARLY
    least = brentq(lambda e: (1 + e) * (LINE.wave(start) - OUTSIDE * e) / Z0 - passing(e, 1.0), -0.5, 0, xtol=1e-20)

    def rates(t, y, begun=np.inf):
        i = (LINE.wave(t) - OUTSIDE * y[1]) / Z0
        share = max(1 - max(t - begun, 0.0) / shuts, 0.0)
        return [-i, ((1 + y[1]) * i - passing(y[1], share)) / y[0]]

    def turns(t, y):
        return y[1]

    def empty(t, y, begun):
        return y[0] - 1e-12

    turns.terminal, turns.direction, empty.terminal, empty.direction = True, 1, True, -1
    options = {"method": "Radau", "rtol": 1e-10, "atol": [1e-17, 1e-14], "dense_output": True}
    first = solve_ivp(rates, (start, T_END), [-EARLY / 2 * (LINE.wave(start) - OUTSIDE * least) / Z0, least],
                      events=turns, **options)  # fmt: skip
    leaves = first.t[-1]
    second = solve_ivp(rates, (leaves, T_END), first.y[:, -1], events=empty, args=(leaves,), **options)
    gone, shut = second.t[-1] if second.status == 1 else np.inf, leaves + shuts
    capacity = 0.6 * pi / 4 * OUTLET**2 * (2 / 1000) ** 0.5

    def pressure(t):
        if start <= t <= min(gone, T_END):
            return OUTSIDE * (first.sol(t) if t < leaves else second.sol(t))[1]
        c = capacity * max(1 - (t - leaves) / shuts, 0.0) if t > gone else 0.0
        w = LINE.wave(t)
        return w - Z0 * 2 * w * c / (Z0 * c + np.sqrt((Z0 * c) ** 2 + 4 * abs(w))) if c else w

    return pressure, [opens, leaves, gone, shut]


@pytest.mark.parametrize("shuts", [1.0, 0.05])
def test_the_pressure_is_that_of_the_equations(shuts):
    """Open still when the air is gone, and shut before: the rest of the air stays, as a cushion."""
    exact, events = by_hand(shuts)
    valve = {"kind": "air valve", "inlet_diameter": INLET, "outlet_diameter": OUTLET, "closing_time": shuts}
    probe = tl.simulate(LINE.scene({"valve": valve}, order=4, slab=2.5e-4)).probes["b"]
    t = probe.t[np.abs(probe.t[:, None] - np.array(events)).min(axis=1) > 3e-3]
    expected = np.array([exact(s) for s in t])
    assert (events[2] < np.inf) == (shuts > 0.5)
    assert probe.at(t).u == pytest.approx(expected, abs=1e-6 * (HEAD + SWING))


@pytest.mark.parametrize(("order", "slab"), [(1, 0.01), (3, 0.04), (5, 0.07)])
def test_energy_is_never_created(order, slab):
    valve = {"kind": "air valve", "inlet_diameter": INLET, "outlet_diameter": OUTLET, "closing_time": 0.3}
    ledger = tl.simulate(LINE.scene({"valve": valve}, order=order, slab=slab), ledger=True).ledger
    assert ledger is not None
    assert ledger.of("loads.valve").created <= 1e-9 * ledger.turnover
