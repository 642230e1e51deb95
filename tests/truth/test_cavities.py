"""Vapour cavities at the end of a pipe: step waves and smooth ones, followed from one event to the next."""

import numpy as np
import pytest
from one_line import from_tank
from scipy.integrate import quad
from scipy.optimize import brentq

from tline import simulate
from tline.solver.result.dense_output import curve

Z0, DELAY, HEAD, FLOW, VAPOUR = 2e7, 0.1, 3e5, 0.04, 2339.0 - 101_325.0
TURN = 2 * DELAY
STEP = {"shape": "step", "from": -FLOW, "to": 0, "at": 0.03}
SWING = {"shape": "sine", "amplitude": 0.03, "frequency": 0.9, "offset": -0.03, "phase": "-90 deg"}


def separated(order: int, slab: float, value: dict, *, delay: float = DELAY, kind: str = "vapour cavity", **load):
    """The far end of a pipe from a tank, where a flow is drawn."""
    loads, out = {"end": {"at": "end", "kind": kind} | load}, {"out": {"at": "end", "kind": "flow", "value": value}}
    line, solver = {"z0": Z0, "delay": delay}, {"order": order, "slab": slab}
    return simulate(from_tank(1.4, line, HEAD, loads, sources=out, solver=solver)).probes["end"]


class Events:
    """The same from event to event: between them V is a quadrature, and an event a root."""

    def __init__(self, flow, bends: list[float], t_end: float):
        self.flow, self.open, volume, t = flow, [], 0.0, 0.0
        self.bends = sorted({b + k * TURN for b in [0.0, *bends] for k in range(int(t_end / TURN) + 1)})
        while t < t_end:
            stop = min([b for b in self.bends if b > t + 1e-12], default=t_end)
            is_open = bool(self.open) and self.open[-1][1] == np.inf
            law = (lambda x, t=t, v=volume: v + self.freed(t, x)) if is_open else (lambda x: self.above(x))
            ends = np.linspace(t + 1e-10, stop - 1e-10, 12)
            below = [x for x in ends if law(x) < 0]
            if not below:
                volume, t = (law(stop - 1e-13) if is_open else 0.0), stop
                continue
            first = below[0]
            event = t if first == ends[0] else brentq(law, ends[np.searchsorted(ends, first) - 1], first, xtol=1e-15)
            if is_open:
                self.open[-1] = (self.open[-1][0], event)
            else:
                self.open.append((event, np.inf))
            self.bends = sorted({*self.bends, *(event + k * TURN for k in range(1, int(t_end / TURN) + 1))})
            volume, t = 0.0, event

    def arriving(self, t: float) -> float:
        if t < TURN:
            return HEAD - Z0 * self.flow(0.0)
        return 2 * HEAD - 2 * self.effort(t - TURN) + self.arriving(t - TURN)

    def above(self, t: float) -> float:
        return self.arriving(t) + Z0 * self.flow(t) - VAPOUR

    def freed(self, start: float, stop: float) -> float:
        return -quad(self.above, start, stop, epsabs=1e-16, epsrel=1e-13)[0] / Z0

    def effort(self, t: float) -> float:
        if any(since <= t < until for since, until in self.open):
            return VAPOUR
        return self.above(t) + VAPOUR

    def apart(self, t: np.ndarray, slab: float) -> np.ndarray:
        """Which slab ends are those of slabs without an event."""
        events = {*self.bends, *(event for pair in self.open for event in pair)}
        return np.array([not any(x - slab - 1e-9 < event < x + 1e-9 for event in events) for x in t])


def stepped(t: float) -> float:
    return -FLOW if t < 0.03 else 0.0


def swinging(t: float) -> float:
    return -0.03 - 0.03 * np.cos(2 * np.pi * 0.9 * t)


def compared(exact: Events, probe, slab: float) -> float:
    """Largest error at the ends of slabs without an event."""
    error = np.abs(probe.u - [exact.effort(t - 1e-13) for t in probe.t])
    return error[exact.apart(probe.t, slab)].max()


def test_step_waves_open_and_shut_a_cavity():
    """A valve shut at once: Joukowsky's rise, the cavity's duration, and the rise when it collapses."""
    exact, probe = Events(stepped, [0.03], 1.4), separated(4, 0.01, STEP)
    assert len(exact.open) == 2
    assert compared(exact, probe, 0.01) < 1e-13 * HEAD
    assert probe.u.max() > HEAD + Z0 * FLOW  # in a slab with an event
    drawn = curve(probe).u
    assert drawn.max() == pytest.approx(HEAD + Z0 * FLOW, rel=1e-12)
    assert drawn.min() == pytest.approx(VAPOUR, rel=1e-12)


@pytest.mark.parametrize(("order", "slab"), [(2, 0.02), (4, 0.02), (8, 0.05)])
def test_smooth_waves_open_and_shut_a_cavity(order, slab):
    exact, probe = Events(swinging, [], 1.4), separated(order, slab, SWING)
    assert len(exact.open) == 1
    assert compared(exact, probe, slab) < 1e-11 * HEAD  # what effort changes in the 1e-13 s before an instant


@pytest.mark.parametrize("order", [2, 4])
def test_away_from_events_the_error_falls_at_the_order(order):
    """Delays of no whole number of slabs; the median, as events spread over slabs beside their own."""
    exact, parts = Events(swinging, [], 1.4), np.array([5.37, 10.37, 20.37])
    probes = [separated(order, DELAY / k, SWING) for k in parts]
    errors = [np.median(np.abs(p.u - [exact.effort(t) for t in p.t])) for p in probes]
    assert np.polyfit(np.log(1 / parts), np.log(errors), 1)[0] > order - 0.2


def test_a_cavity_with_little_gas_is_one_of_vapour():
    """Two models, integrated in two ways: DGCM with ever less gas becomes DVCM."""
    vapour = separated(2, 0.005, SWING).u
    volumes = [1e-4, 1e-6, 1e-8, 1e-10]
    gas = [separated(2, 0.005, SWING, kind="cavity", gas_volume=volume).u for volume in volumes]
    apart = [np.median(np.abs(u - vapour)) / HEAD for u in gas]
    assert np.polyfit(np.log(volumes), np.log(apart), 1)[0] == pytest.approx(1, abs=0.01)
    assert np.abs(gas[-1] - vapour).max() < 1e-3 * HEAD  # also in the slabs of events
