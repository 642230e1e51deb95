"""Lines that only delay and attenuate (R C = G L), behind which a law stands, against a recursion bounce by bounce."""

import numpy as np
import pytest
from scipy.special import wrightomega

import tline as tl

Z0, DELAY, BEHIND, T_END = 61.4, 4e-9, 12.0, 36e-9
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
    drop = Z0 * SATURATION
    return w + drop - VOLTS * wrightomega(np.log(drop / VOLTS) + (w + drop) / VOLTS)


def exact(t, source, left):
    """Voltage and current at both ends; a wave arrives with a share of what it was."""

    def sent(t):
        back = returned(t) if (t > 0).any() else np.zeros_like(t)
        return np.where(t > 0, 2 * (source(t) * Z0 + back * BEHIND) / (Z0 + BEHIND) - back, 0.0)

    def returned(t):
        w = arriving(t - DELAY) if (t > DELAY).any() else np.zeros_like(t)
        return left * (2 * diode(w) - w)

    def arriving(t):
        return left * sent(t - DELAY) if (t > DELAY).any() else np.zeros_like(t)

    w, back = arriving(t), returned(t)
    u, near = diode(w), (source(t) * Z0 + back * BEHIND) / (Z0 + BEHIND)
    return {"near": (near, (near - back) / Z0), "far": (u, (w - u) / Z0)}


@pytest.mark.parametrize("taken", [0.01, 1.2])
@pytest.mark.parametrize("shape", SHAPES)
def test_fronts_pass_and_are_attenuated(shape, taken):
    value, source = SHAPES[shape]
    losses = {"length": 0.4, "resistance": taken * Z0 / 0.4, "conductance": taken / Z0 / 0.4}
    result = tl.simulate(
        {
            "medium": "electrical",
            "t_end": T_END,
            "lines": {"l": {"nodes": ["a", "b"], "z0": Z0, "delay": DELAY, **losses}},
            "sources": {"s": {"at": "a", "kind": "voltage", "value": value, "resistance": BEHIND}},
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
