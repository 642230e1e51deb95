"""Sizes that design searches find, against textbook formulas."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tline import Scene, simulate
from tline.design import closure, flywheel, relief, vessel

LENGTH, DIAMETER, DENSITY, FLOW, AIR = 900.0, 0.25, 1000.0, 0.05, 101_325.0
AREA = pi / 4 * DIAMETER**2
MASS = DENSITY * LENGTH / AREA  # of the column, Pa per m³/s²
TANK = 4e5
STIFF = 12_000.0  # m/s: the column is nearly rigid
VALVE = {"at": "near", "kind": "orifice", "flow": FLOW, "pressure_drop": TANK}
SEARCHED = 3e-3  # relative: a bracket of 0.2 %, and four digits


def main(wave_speed: float = 1000.0, t_end: float = 20.0, **more) -> Scene:
    """A pipe without friction from the node "near" to a tank."""
    line = {"length": LENGTH, "diameter": DIAMETER, "wave_speed": wave_speed, "density": DENSITY}
    tank = {"at": "tank", "kind": "reservoir", "pressure": TANK}
    return Scene(
        medium="hydraulic",
        t_end=t_end,
        start="steady",
        lines={"main": {"nodes": ["near", "tank"], **line}},
        probes={"near": {"at": "near"}},
        **{**more, "loads": {"tank": tank, **more.get("loads", {})}},
    )


def stopped(flow: float, shape: dict, **more) -> Scene:
    """A flow into (or, negative, out of) the pipe that stops."""
    value = {"from": flow, "to": 0, "at": 0.5, **shape}
    return main(sources={"feed": {"at": "near", "kind": "flow", "value": value}}, **more)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_a_flow_that_falls_linearly_stops_in_michauds_time(share):
    """Δp = 2·ρ·L·v/T for T above 2·L/c, also less than Joukowsky's ρ·c·v then."""
    joukowsky = DENSITY * 1000.0 * FLOW / AREA
    found = closure(stopped(-FLOW, {"shape": "step"}), "feed", highest=TANK + share * joukowsky)
    assert found.found.size == pytest.approx(2 * MASS * FLOW / (share * joukowsky), rel=SEARCHED)
    assert found.found.size > 2 * LENGTH / 1000.0
    again = simulate(found.scene, tol=1e-6, envelope=True).envelope
    assert again is not None
    assert again.of("near")["highest"] == pytest.approx(TANK + share * joukowsky, rel=SEARCHED)


PER_PERIOD = 400


def chain(duration: float, share: float, left: float) -> float:
    """Highest pressure by Allievi's chain, at 400 instants of each 2·L/c: a valve that closes in two stages."""
    z0, period = DENSITY * 1000.0 / AREA, 2 * LENGTH / 1000.0
    t = np.arange(0, duration + 2 * period, period / PER_PERIOD)
    opening = np.interp(t, [0, share * duration, duration], [1, left, 0])
    wave, highest = np.full(PER_PERIOD, TANK + z0 * FLOW), TANK
    for k in range(0, len(t) - PER_PERIOD, PER_PERIOD):
        carried = z0 * FLOW / TANK**0.5 * opening[k : k + PER_PERIOD]
        u = (np.sqrt(carried**2 + 4 * np.maximum(wave, 0)) - carried) ** 2 / 4 + np.minimum(wave, 0)
        highest = max(highest, u.max())
        wave = 2 * TANK - (2 * u - wave)
    return highest


def shortest(high: float, share: float, left: float) -> float:
    """By a scan, and linear interpolation in its last step."""
    times = np.arange(2.5, 8, 0.02)
    found = np.array([chain(t, share, left) for t in times])
    k = np.flatnonzero(found > high)[-1]
    return float(np.interp(-high, -found[k : k + 2], times[k : k + 2])) if k + 1 < len(times) else np.inf


@pytest.mark.parametrize("high", [7e5, 9e5])
def test_a_valve_closes_as_fast_as_allievis_chain_allows(high):
    found = closure(main(loads={"valve": VALVE}), "valve", highest=high)
    assert found.found.size == pytest.approx(shortest(high, 0.5, 0.5), rel=SEARCHED)


def test_two_stages_come_near_to_the_best_that_a_scan_of_bends_finds():
    one, two = (closure(main(loads={"valve": VALVE}), "valve", highest="8 bar", stages=n) for n in (1, 2))
    k, x = two.sizes["first stage"].value / two.found.size, two.sizes["travel left"].value
    assert two.found.size == pytest.approx(shortest(8e5, k, x), rel=SEARCHED)
    best = min(shortest(8e5, k, x) for k in np.arange(0.1, 1, 0.1) for x in np.arange(0.1, 1, 0.1))
    assert two.found.size < min(one.found.size, 1.02 * best)
    assert two.scene.table()["loads"]["valve"]["opening"]["points"][-1][0] == pytest.approx(two.found.size)


@pytest.mark.parametrize("exponent", [1.0001, 1.2, 1.4])
def test_a_vessel_takes_the_energy_of_a_rigid_column(exponent):
    """½·ρ·L·Q²/A = p0·(V - V0) - ∫p dV, the gas on its polytrope p·V^n from the steady state to the lowest pressure."""
    p0, low = TANK + AIR, 2e5
    ratio = (p0 / (low + AIR)) ** (1 / exponent)
    per_volume = p0 * (ratio - 1) - p0 * (1 - ratio ** (1 - exponent)) / (exponent - 1)
    volume = MASS * FLOW**2 / 2 / per_volume
    scene = stopped(FLOW, {"shape": "step"}, wave_speed=STIFF)
    found = vessel(scene, "near", lowest=low, exponent=exponent, reserve=0)
    assert found.found.size == pytest.approx(volume, rel=SEARCHED)
    assert found.sizes["vessel volume"].value == pytest.approx(volume * ratio, rel=SEARCHED)
    precharge = p0 / ratio - AIR
    assert found.sizes["precharge"].value == pytest.approx(precharge, abs=SEARCHED * p0)


def test_a_relief_valve_lets_pass_what_joukowsky_leaves():
    """Behind a pipe in which a flow stops at once u = p0 + z0·(Q - q), q what the valve lets pass when wide open."""
    z0, high = DENSITY * 1000.0 / AREA, 9e5
    passed = FLOW - (high - TANK) / z0
    found = relief(stopped(-FLOW, {"shape": "step"}), "near", highest=high, set_pressure="7 bar", band="2 bar")
    assert found.found.size == pytest.approx(passed * 3600 / np.sqrt(high / 1e5), rel=SEARCHED)


def test_a_relief_valve_of_a_capacity_opens_as_late_as_its_band_allows():
    """The share of the capacity that is open at the highest pressure lets pass what Joukowsky leaves."""
    z0, high, kv, band = DENSITY * 1000.0 / AREA, 9e5, 100.0, 2e5
    passed = FLOW - (high - TANK) / z0
    share = passed * 3600 / np.sqrt(high / 1e5) / kv
    found = relief(stopped(-FLOW, {"shape": "step"}), "near", highest=high, kv=kv, band=band)
    assert high - found.found.size == pytest.approx(high - share * band, rel=SEARCHED)


def test_a_flywheel_keeps_a_rigid_column_up():
    """ρ·L/A·q' = N²·h - c·q² - p, and J·ω²·N' = -h·N·q for a pump that loses c·q², until q = 0."""
    rest, lost, speed, low = 6.5e5, 1.5e5 / 0.06**2, 24.0, 1.5e5
    steady = np.sqrt((rest - TANK) / lost)

    def lowest(inertia: float) -> float:
        energy = inertia * (2 * pi * speed) ** 2

        def rates(t, y):
            q, n = y
            return (n * n * rest - lost * q * q - TANK) / MASS, -rest * n * q / energy

        def still(t, y):
            return y[0]

        still.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        swing = solve_ivp(rates, (0, 60), (steady, 1.0), events=still, rtol=1e-9, atol=1e-12, dense_output=True)
        q, n = swing.sol(np.linspace(0, swing.t[-1], 6001))
        return float((n**2 * rest - lost * q**2).min())

    inertia = brentq(lambda j: lowest(j) - low, 0.5, 50)
    pump = {
        "kind": "pump", "nodes": ["sump", "near"], "curve": [[0, rest], [0.06, rest - 1.5e5]], "trip": 0.5,
        "inertia": 1.0, "rated_speed": speed, "check_valve": True,
    }  # fmt: skip
    sump = {"at": "sump", "kind": "reservoir", "pressure": 0}
    scene = main(STIFF, links={"pump": pump}, loads={"sump": sump})
    found = flywheel(scene, "pump", lowest=low, path=("near", "tank"))
    assert found.found.size == pytest.approx(inertia, rel=2 * SEARCHED)
