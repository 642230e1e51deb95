"""Vapour cavities in pipes: waves from event to event, a measurement, and the same pipe with many places."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from one_line import from_tank
from scipy.integrate import quad
from scipy.optimize import brentq

import tline as tl
from tline import simulate
from tline.solver.result.dense_output import curve
from tline.surge.operation import operate

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


ATMOSPHERE, MEASURED = 101_325, 1.015e6  # Pa
PIPE = tl.examples["column_separation"]


@pytest.fixture(scope="module")
def surge():
    table = PIPE.table()
    table["lines"]["pipe"].pop("cavities")
    bare = PIPE.with_changes(lines=table["lines"], loads={"tank": table["loads"]["tank"]})
    found, without = (operate(bare, t_end="0.3 s", cavities=on, seconds=600) for on in (True, False))
    return found, without


def test_the_highest_pressure_is_that_measured_and_that_of_many_places(surge):
    found, without = surge
    highest = found.worst.highest.highest
    assert found.worst.boiling == []
    assert highest + ATMOSPHERE == pytest.approx(1.05 * MEASURED, rel=0.05)
    many = tl.simulate(PIPE.change({"t_end": "0.3 s"}), envelope=True).envelope
    assert many is not None
    assert abs(highest - many.of("valve")["highest"] + many.weight[-1]) < max(2 * found.columns.spread, 0.05 * highest)
    assert without.columns is None
    assert without.worst.untold.startswith("water boils")


def test_volumes_and_collapses_are_told_with_place_and_instant(surge):
    columns = surge[0].columns
    largest = columns.cavities[0]
    assert columns.places == (4, 8)  # three, and seven, inside the pipe and one at the valve
    assert largest.where == "valve"
    assert largest.collapse == pytest.approx(0.126, abs=0.01)
    text = str(surge[0])
    assert "columns separate: computed with 4 and 8 cavities" in text
    assert f"at valve after {largest.at:.4g} s, gone after {largest.collapse:.4g} s" in text
    assert "by places at valve" in text
    assert json.loads(json.dumps(surge[0].to_dict()))["columns"]["spread"] == columns.spread


def test_the_scene_that_is_given_out_has_the_cavities_and_does_the_same(surge):
    scene = tl.Scene(**surge[0].scene.table())
    assert scene.table()["lines"]["pipe"]["cavities"]["places"] == 7
    again = tl.simulate(scene, envelope=True).envelope
    assert again is not None
    assert again.of("valve")["highest"] == surge[0].result.envelope.of("valve")["highest"]


PEAKS = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "generate_measured.py"))


@pytest.mark.filterwarnings("ignore:fronts")  # spikes of collapses, more than a slab may hold
@pytest.mark.parametrize("experiment", PEAKS["EXPERIMENTS"], ids=lambda one: one.file)
def test_a_late_valve_gives_the_first_cavity_its_length_and_the_next_pulse_its_height(experiment):
    """Nothing is fitted, and how the valve shuts is not known: to half of its time, and to a fifth."""
    figures, (friction, *_) = PEAKS["figures"], PEAKS["FRICTION"]
    level, gone, highest, when = figures(experiment, *experiment.measured())
    t, u = experiment.computed(friction, 31, late=True)
    first, ours, high, then = figures(experiment, t, u, u)
    assert first == pytest.approx(level, rel=0.05)
    assert abs(ours - gone) < experiment.closes / 2
    assert high == pytest.approx(highest, rel=0.2)
    assert abs(then - when) < experiment.closes


@pytest.mark.filterwarnings("ignore:fronts")
@pytest.mark.parametrize("experiment", PEAKS["EXPERIMENTS"][::2], ids=lambda one: one.file)
def test_at_small_speeds_a_late_valve_is_nearer_to_the_measured_line(experiment):
    friction = PEAKS["FRICTION"][0]
    off = [PEAKS["off"](experiment, *experiment.computed(friction, 31, late)) for late in (False, True)]
    assert off[1] < 0.7 * off[0]
