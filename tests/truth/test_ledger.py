"""Energies of the ledger against closed forms."""

import numpy as np
import pytest
from one_line import FAR, one_line

from tline import Scene, simulate

T, Z0, V = 5e-9, 50.0, 2.0
LINE = {"nodes": ["near", "far"], "z0": Z0, "delay": T}


def ledger(t_end: float, **tables):
    scene = Scene(medium="electrical", t_end=t_end, lines={"line": LINE}, probes={"p": {"at": "far"}}, **tables)
    result = simulate(scene, tol=1e-9, ledger=True)
    assert result.ledger is not None
    assert result.ledger.notes == ()
    return result.ledger


@pytest.mark.parametrize(("t_end", "burnt"), [(2.9, 0.0), (4.0, 0.5), (5.5, 1.0)])
def test_a_charged_line_into_a_matched_resistor(t_end, burnt):
    """A current for two transits charges the open line to 2·z0·I; after three it is discharged, in two more."""
    current = 0.01
    pulse = {"shape": "piecewise linear", "points": [[0, 0], [0, current], [2 * T, current], [2 * T, 0]]}
    found = ledger(
        t_end * T,
        sources={"charger": {"at": "near", "kind": "current", "value": pulse}},
        loads={"gap": {"at": "far", "kind": "switch", "before": np.inf, "after": Z0, "time": 3 * T}},
    )
    energy = T / Z0 * (2 * Z0 * current) ** 2 / 2
    assert found.of("sources.charger").supplied == pytest.approx(energy, rel=1e-12)
    assert found.of("loads.gap").dissipated == pytest.approx(burnt * energy, rel=1e-12, abs=1e-12 * energy)
    assert found.of("lines.line").stored == pytest.approx((1 - burnt) * energy, rel=1e-12, abs=1e-12 * energy)
    assert found.residual < 1e-12


@pytest.mark.parametrize("kind", ["parallel", "series"])
def test_a_capacitor_and_a_resistor(kind):
    """A matched step of V: the load sees V behind z0 from T on; what R burns and C holds in closed form."""
    R, C, t = 120.0, 10e-12, 1.7e-9
    found = ledger(
        T + t,
        sources={"step": {"at": "near", "kind": "voltage", "value": V, "resistance": Z0}},
        loads={"load": {"at": "far", "kind": kind, "resistance": R, "capacitance": C}},
    )
    if kind == "parallel":
        tau, level = C * R * Z0 / (R + Z0), V * R / (R + Z0)
        e = np.exp(-t / tau)
        burnt = level**2 / R * (t - 2 * tau * (1 - e) + tau / 2 * (1 - e**2))
        held = C * (level * (1 - e)) ** 2 / 2
    else:
        tau = C * (R + Z0)
        e = np.exp(-t / tau)
        burnt = R * (V / (R + Z0)) ** 2 * tau / 2 * (1 - e**2)
        held = C * (V * (1 - e)) ** 2 / 2
    load = found.of("loads.load")
    # as accurate as the run, whose tolerance is 1e-9 at slab ends; inside slabs the waves are of lower order
    assert (load.dissipated, load.stored) == pytest.approx((burnt, held), rel=1e-7)
    source = found.of("sources.step")
    assert source.supplied - source.dissipated == pytest.approx(found.of("lines.line").stored + burnt + held, rel=1e-7)


def test_bounces_between_resistors_and_a_switch():
    """Bergeron's sums, level by level; the switch beside the receiver moves after two round trips."""
    R0, R1, switched, trips = 20.0, 300.0, 75.0, 5
    found = ledger(
        2 * trips * T,
        sources={"step": {"at": "near", "kind": "voltage", "value": V, "resistance": R0}},
        loads={
            "receiver": {"at": "far", "kind": "resistor", "resistance": R1},
            "switch": {"at": "far", "kind": "switch", "before": np.inf, "after": switched, "time": 5 * T},
        },
    )
    b, supplied, driver, receiver, switch = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(trips):
        u = (b / Z0 + V / R0) / (1 / Z0 + 1 / R0)
        supplied += 2 * T * V * (V - u) / R0
        driver += 2 * T * (V - u) ** 2 / R0
        a, g = 2 * u - b, 1 / R1 + (1 / switched if k >= 2 else 0.0)
        u = a / (1 + g * Z0)
        at_far = 2 * T if k < trips - 1 else T  # the last level arrives a transit before the end
        receiver += at_far * u**2 / R1
        switch += at_far * u**2 / switched if k >= 2 else 0.0
        b = 2 * u - a
    source = found.of("sources.step")
    assert (source.supplied, source.dissipated) == pytest.approx((supplied, driver), rel=1e-12)
    assert found.of("loads.receiver").dissipated == pytest.approx(receiver, rel=1e-12)
    assert found.of("loads.switch").dissipated == pytest.approx(switch, rel=1e-12)
    assert found.residual < 1e-12


def test_a_lossy_line_in_the_steady_state():
    """R·I² on the line for as long as the run lasts, beside an envelope."""
    R, load = 10.0, 40.0
    scene = one_line("40 ns", LINE | {"length": 1, "resistance": R}, V, Z0, load, start="steady", probes=FAR)
    result = simulate(scene, ledger=True, envelope=True)
    found, current, t = result.ledger, V / (R + load + Z0), result.t[-1]
    assert found is not None
    assert result.envelope is not None
    assert found.of("lines.line").taken == pytest.approx(R * current**2 * t, rel=1e-9)
    assert found.of("loads.load").dissipated == pytest.approx(load * current**2 * t, rel=1e-9)
    assert found.of("sources.s").supplied == pytest.approx(V * current * t, rel=1e-9)
    assert result.envelope.of("far")["highest"] == pytest.approx(load * current, rel=1e-9)


def test_a_pump_that_lifts_from_a_sump_to_a_tank():
    """In the steady state every power is flow times pressure: rise = h0 - c·Q² = p."""
    shut_off, p, flow = 4e5, 3e5, 0.02  # of a pump with the single point (flow, p): h0 = 4/3 p
    scene = Scene(
        medium="hydraulic",
        t_end="10 s",
        start="steady",
        lines={"main": {"nodes": ["pump", "tank"], "z0": 1e8, "delay": 0.7}},
        loads={
            "sump": {"at": "sump", "kind": "reservoir", "pressure": p / 10},
            "tank": {"at": "tank", "kind": "reservoir", "pressure": p},
        },
        links={"pump": {"nodes": ["sump", "pump"], "kind": "pump", "curve": [[flow, p]]}},
        probes={"p": {"at": "tank"}},
    )
    Q = flow * np.sqrt((shut_off - 0.9 * p) / (shut_off - p))
    result = simulate(scene, ledger=True)
    found, t = result.ledger, result.t[-1]
    assert found is not None
    assert found.of("links.pump").supplied == pytest.approx(0.9 * p * Q * t, rel=1e-9)
    assert found.of("loads.tank").supplied == pytest.approx(-p * Q * t, rel=1e-9)
    assert found.of("loads.sump").supplied == pytest.approx(p / 10 * Q * t, rel=1e-9)
    assert found.residual < 1e-12
