"""Varistors at a node and between two, against recursions from bounce to bounce whose roots are found by brentq."""

import numpy as np
import pytest
from scipy.optimize import brentq

import tline as tl

Z0, BEHIND, BEYOND, DELAY, CURRENT, VOLTAGE = 50.0, 20.0, 75.0, 5e-9, 1e-3, 420.0
RAMP = {"shape": "ramp", "to": 1000.0, "duration": 1.3e-9}
LINE = {"z0": Z0, "delay": DELAY}


def scene(exponent: float, between: bool, **more) -> tl.Scene:
    """A source behind a resistance, a line, and a varistor to earth, or into a second line that is matched."""
    varistor = {"kind": "varistor", "current": CURRENT, "voltage": VOLTAGE, "exponent": exponent}
    second = {"second": {"nodes": ["c", "d"], "z0": BEYOND, "delay": DELAY}} if between else {}
    return tl.Scene(
        **{
            "medium": "electrical",
            "t_end": 8 * DELAY,
            "lines": {"first": {"nodes": ["a", "b"], **LINE}} | second,
            "sources": {"s": {"at": "a", "kind": "voltage", "value": RAMP, "resistance": BEHIND}},
            "loads": {"m": {"at": "d", "kind": "matched"}} if between else {"v": {"at": "b"} | varistor},
            "links": {"v": {"nodes": ["b", "c"]} | varistor} if between else {},
            "probes": {"b": {"at": "b", "line": "first"}},
        }
        | more
    )


def current(exponent: float, drop: float, behind: float) -> float:
    """Root of u + behind·i(u) = drop."""

    def law(u: float) -> float:
        return CURRENT * np.sign(u) * abs(u / VOLTAGE) ** exponent

    return law(brentq(lambda u: u + behind * law(u) - drop, -abs(drop), abs(drop), xtol=1e-13, rtol=1e-15))


@pytest.mark.parametrize("between", [False, True])
@pytest.mark.parametrize("exponent", [1.0, 2.5, 25.0])
def test_its_voltage_is_that_of_the_recursion(exponent, between):
    found = tl.simulate(scene(exponent, between), tol=1e-9).probes["b"]
    seen = Z0 + (BEYOND if between else 0.0)

    def arriving(t: float) -> float:
        if t <= DELAY:
            return 0.0
        source = RAMP["to"] * min(max((t - DELAY) / RAMP["duration"], 0.0), 1.0)
        back = voltage(t - 2 * DELAY)[1]
        return (2 * source * Z0 + back * (BEHIND - Z0)) / (BEHIND + Z0)

    def voltage(t: float) -> tuple[float, float]:
        a = arriving(t)
        u = a - Z0 * current(exponent, a, seen) if a else 0.0
        return u, 2 * u - a

    t = found.t[1 :: max(len(found.t) // 60, 1)]
    assert found.at(t).u == pytest.approx(np.array([voltage(one)[0] for one in t]), abs=2e-8 * RAMP["to"])


def test_a_steady_start_is_the_operating_point():
    source = {"at": "a", "kind": "voltage", "value": 600.0, "resistance": BEHIND}
    found = tl.simulate(scene(25.0, False, start="steady", sources={"s": source})).probes["b"]
    assert found.u == pytest.approx(600.0 - BEHIND * current(25.0, 600.0, BEHIND), rel=1e-12)


def test_what_it_takes_is_in_the_ledger_and_nothing_is_lost():
    ledger = tl.simulate(scene(25.0, False), ledger=True).ledger
    assert ledger is not None
    assert ledger.of("loads.v").dissipated > 0
    assert ledger.residual < 1e-9


def test_a_sweep_varies_its_exponent():
    table = tl.sweep(scene(25.0, True), {"links.v.exponent": [1.0, 25.0]}, sample="list")
    one = tl.simulate(scene(1.0, True)).probes["b"]
    assert np.ravel(table["highest"])[0] == pytest.approx(one.u.max(), rel=1e-5)


def test_pipes_have_none():
    with pytest.raises(tl.SceneError, match="not a word of hydraulic scenes"):
        scene(25.0, False, medium="hydraulic")
