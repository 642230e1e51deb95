"""Varistors, and laws behind lines that only attenuate, against recursions from bounce to bounce."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import wrightomega

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


LOSSY_Z0, LOSSY_DELAY, LOSSY_BEHIND, T_END = 61.4, 4e-9, 12.0, 36e-9
SATURATION, VOLTS = 1e-10, 1.380649e-23 * 300.15 / 1.602176634e-19
BEGIN = 1.3313e-9  # not on a slab's edge
SHAPES = {
    "step": ({"shape": "step", "to": 2.0, "at": BEGIN}, lambda t: np.where(t > BEGIN, 2.0, 0.0)),
    "ramp": (
        {"shape": "ramp", "to": 2.0, "at": BEGIN, "duration": 1.47e-9},
        lambda t: 2 * np.clip((t - BEGIN) / 1.47e-9, 0, 1),
    ),
    "pulse": (
        {"shape": "pulses", "high": 2.0, "at": BEGIN, "width": 0.2e-9, "rise": 0.07e-9, "fall": 0.07e-9},
        lambda t: 2 * np.interp(t - BEGIN, np.array([0, 0.07, 0.27, 0.34]) * 1e-9, [0, 1, 1, 0]),
    ),
}


def diode(w):
    """Voltage at a diode behind z0 that a wave reaches."""
    drop = LOSSY_Z0 * SATURATION
    return w + drop - VOLTS * wrightomega(np.log(drop / VOLTS) + (w + drop) / VOLTS)


def exact(t, source, left):
    """Voltage and current at both ends; a wave arrives with a share of what it was."""

    def sent(t):
        back = returned(t) if (t > 0).any() else np.zeros_like(t)
        return np.where(t > 0, 2 * (source(t) * LOSSY_Z0 + back * LOSSY_BEHIND) / (LOSSY_Z0 + LOSSY_BEHIND) - back, 0.0)

    def returned(t):
        w = arriving(t - LOSSY_DELAY) if (t > LOSSY_DELAY).any() else np.zeros_like(t)
        return left * (2 * diode(w) - w)

    def arriving(t):
        return left * sent(t - LOSSY_DELAY) if (t > LOSSY_DELAY).any() else np.zeros_like(t)

    w, back = arriving(t), returned(t)
    u, near = diode(w), (source(t) * LOSSY_Z0 + back * LOSSY_BEHIND) / (LOSSY_Z0 + LOSSY_BEHIND)
    return {"near": (near, (near - back) / LOSSY_Z0), "far": (u, (w - u) / LOSSY_Z0)}


@pytest.mark.parametrize("taken", [0.01, 1.2])
@pytest.mark.parametrize("shape", SHAPES)
def test_fronts_pass_and_are_attenuated(shape, taken):
    value, source = SHAPES[shape]
    losses = {"length": 0.4, "resistance": taken * LOSSY_Z0 / 0.4, "conductance": taken / LOSSY_Z0 / 0.4}
    result = tl.simulate(
        {
            "medium": "electrical",
            "t_end": T_END,
            "lines": {"l": {"nodes": ["a", "b"], "z0": LOSSY_Z0, "delay": LOSSY_DELAY, **losses}},
            "sources": {"s": {"at": "a", "kind": "voltage", "value": value, "resistance": LOSSY_BEHIND}},
            "loads": {"d": {"at": "b", "kind": "diode", "saturation": SATURATION}},
            "probes": {"near": {"at": "a"}, "far": {"at": "b"}},
        },
        tol=1e-6,
    )
    assert result.accuracy.met
    t = np.random.default_rng(1).uniform(0, T_END, 5000)
    for name, expected in exact(t, source, np.exp(-taken)).items():
        seen, told = result.probes[name].at(t), result.accuracy.inside[name]
        for found, true, error in zip((seen.u, seen.y), expected, (told.u, told.y), strict=True):
            assert np.abs(found - true).max() <= 3 * min(1e-6, error) * np.abs(true).max() + 1e-13
    created = max(entry.created for entry in result.ledger.entries)
    assert created <= 1e-12 * result.ledger.turnover
