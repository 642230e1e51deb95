"""An air valve at the end of a pipe: the formulas of Wylie and Streeter, integrated by SciPy's stiff Radau method."""

import numpy as np
import pytest
from one_line import from_tank
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tline import simulate

Z0, TURN, HEAD, OUTSIDE, T_END = 2e7, 0.2, 3e5, 101_325.0, 0.94
FLOW, SHUT, EARLY = 0.04, 0.03, 1e-10  # m³/s, s, s


STEP = {"shape": "step", "from": -FLOW, "to": 0, "at": SHUT}


class Reference:
    """From where it opens, one bend of the waves after the other, to where it shuts."""

    def __init__(self, inlet: float, outlet: float):
        speed = (287.05 * 293.15) ** 0.5
        self.inlet, self.outlet = (0.6 * np.pi / 4 * d**2 * speed for d in (inlet, outlet))
        self.pieces, self.opens, shut = [], SHUT + TURN, False
        start = self.opens + EARLY
        ratio = brentq(lambda r: r * self.flow(start, r) - self.leaving(r), 0.01, 1, xtol=1e-15)  # before any is stored
        amounts = -EARLY * self.flow(start, ratio) * np.array([1, ratio])
        while not shut and start < T_END:
            stop = min(self.opens + TURN * (int((start - self.opens) / TURN + 1e-9) + 1), T_END)
            done = solve_ivp(self.rates, (start, stop), amounts, "Radau", dense_output=True, rtol=1e-10, atol=1e-16,
                             events=self.empty)  # fmt: skip
            self.pieces.append((start, done.t[-1], done.sol))
            start, amounts, shut = done.t[-1], done.y[:, -1], done.status == 1
        self.shuts = start if shut else np.inf

    def empty(self, t, amounts):
        return amounts[0] - 1e-13

    empty.terminal, empty.direction = True, -1

    def rates(self, t, amounts):
        volume, air = amounts
        ratio = air / volume
        return [-self.flow(t, ratio), -self.leaving(ratio)]

    def flow(self, t: float, ratio: float) -> float:
        return (self.thevenin(t) - OUTSIDE * (ratio - 1)) / Z0

    def leaving(self, ratio: float) -> float:
        """Air that leaves at an absolute pressure in atmospheres, in m³/s of the air outside."""
        outwards = ratio > 1
        r = max(1 / ratio if outwards else ratio, (2 / 2.4) ** 3.5)
        rate = (7 * (r ** (10 / 7) - r ** (12 / 7))) ** 0.5
        return self.outlet * ratio * rate if outwards else -self.inlet * rate

    def thevenin(self, t: float) -> float:
        return self.arriving(t) - Z0 * FLOW * (t < SHUT)

    def arriving(self, t: float) -> float:
        if t < TURN:
            return HEAD + Z0 * FLOW
        return 2 * HEAD - 2 * self.effort(t - TURN) + self.arriving(t - TURN)

    def effort(self, t: float) -> float:
        for start, stop, sol in self.pieces:
            if start <= t < stop:
                volume, air = sol(t)
                return OUTSIDE * (air / volume - 1)
        return self.thevenin(t)

    def apart(self, t: float, slab: float) -> bool:
        """Whether a slab that ends then has no event in it."""
        events = [event + k * TURN for event in (SHUT, self.shuts) for k in range(8)]
        return not any(t - slab - 1e-9 < event < t + 1e-9 for event in events)


def efforts(order: int, slab: float, inlet: float, outlet: float):
    valve = {"end": {"at": "end", "kind": "air valve", "inlet_diameter": inlet, "outlet_diameter": outlet}}
    more = {"sources": {"out": {"at": "end", "kind": "flow", "value": STEP}}, "solver": {"order": order, "slab": slab}}
    probe = simulate(from_tank(T_END, {"z0": Z0, "delay": TURN / 2}, HEAD, valve, **more)).probes["end"]
    return probe.t, probe.u


@pytest.mark.parametrize(
    ("inlet", "outlet", "close"),
    [(0.1, 0.03, 1e-5), (0.03, 0.05, 1e-5), (0.1, 0.005, 1e-3)],  # the last one compresses air that turns in a slab
)
def test_an_air_valve_is_its_differential_equation(inlet, outlet, close):
    """A valve shut at once draws air in; it is compressed, leaves, and where it is gone the liquid is stopped."""
    exact, slab = Reference(inlet, outlet), 0.01
    t, u = efforts(4, slab, inlet, outlet)
    clean = np.array([exact.apart(x, slab) for x in t])
    expected = np.array([exact.effort(x - 1e-12) for x in t])
    assert expected.max() > HEAD + 0.8 * Z0 * FLOW
    assert np.abs(u - expected)[clean].max() < close * HEAD
