"""Multiports against closed forms, and against loads that they are equal to."""

import numpy as np
import pytest

from tline import ActiveError, InputError, Scene, SceneError, simulate
from tline.frequency.ports import impedance

NS = 1e-9
RAMP = {"shape": "ramp", "to": 1, "duration": "0.25 ns"}
LINES = {
    "a": {"nodes": ["in", "p"], "z0": 50, "delay": "1 ns"},
    "b": {"nodes": ["q", "out"], "z0": 120, "delay": "1 ns"},
}
BY_HAND = {"order": 5, "slab": "0.125 ns"}


def scene(link: dict, loads: dict, lines: tuple = ("a", "b"), **parts) -> Scene:
    whole = {
        "medium": "electrical", "t_end": "12 ns", "lines": {name: LINES[name] for name in lines},
        "sources": {"s": {"at": "in", "kind": "voltage", "value": RAMP, "resistance": 25}},
        "loads": {name: {"at": name} | load for name, load in loads.items()},
        "links": {"x": {"nodes": ["p", "q"]} | link} if link else {},
        "probes": {at: {"at": at} for at in ("in", "p", "q", "out") if at in "inp" or "b" in lines}, "solver": BY_HAND,
    }  # fmt: skip
    return Scene(**whole | parts)


def ramp(t: np.ndarray) -> np.ndarray:
    return np.clip(t / (0.25 * NS), 0, 1)


def resistor(ohm: float) -> dict:
    return {"kind": "resistor", "resistance": ohm}


@pytest.mark.parametrize("ratio", [0.5, -3.0, 1.0])
def test_a_transformer_is_a_change_of_impedance(ratio):
    """All reflections between source, transformer and load, summed."""
    result = simulate(scene({"kind": "transformer", "ratio": ratio}, {"out": resistor(300)}))
    there, beyond = 50.0, ratio**2 * 120
    into = (beyond - there) / (beyond + there)
    at_source, at_load = (25 - 50) / (25 + 50), (300 - 120) / (300 + 120)
    t = result.probes["out"].t
    expected, n = np.zeros_like(t), int(12 / 2) + 1
    # arriving[k], back[k]: wave at p on line a, and at q on line b, at instants of both, by powers of a delay of 2 ns
    arriving, back = np.zeros(n), np.zeros(n)
    arriving[0] = 50 / 75  # 1 ns late
    for k in range(n - 1):
        sent = (1 + into) / ratio * arriving[k] - into * back[k]
        arriving[k + 1] = at_source * (into * arriving[k] + ratio * (1 - into) * back[k])
        back[k + 1] = at_load * sent
        expected += (1 + at_load) * sent * ramp(t - (2 + 2 * k) * NS)
    assert np.abs(result.probes["out"].u - expected).max() < 1e-13
    assert np.abs(result.probes["p"].u - ratio * result.probes["q"].u).max() < 1e-13


def same(one: Scene, other: Scene, at: str = "p") -> float:
    u, v = (simulate(given).probes[at].u for given in (one, other))
    return float(np.abs(u - v).max() / np.abs(v).max())


def test_a_capacitor_behind_a_gyrator_is_an_inductor():
    behind = scene({"kind": "gyrator", "resistance": 30}, {"q": {"kind": "parallel", "capacitance": "4 pF"}}, ("a",))
    assert same(behind, scene({}, {"p": {"kind": "series", "inductance": 30**2 * 4e-12}}, ("a",))) < 1e-12


def test_coupled_inductors_are_their_input_impedance():
    """s L1 - s² M²/(R + s L2)."""
    windings = {"kind": "coupled inductors", "inductance": ["10 nH", "40 nH"], "coupling": -0.6}
    seen = {"kind": "impedance", "expression": "(s*90*10e-9 + s^2*0.64*400e-18)/(90 + s*40e-9)"}
    assert same(scene(windings, {"q": resistor(90)}, ("a",)), scene({}, {"p": seen}, ("a",))) < 1e-12


@pytest.mark.parametrize(
    ("link", "seen"),
    [
        ({"kind": "transformer", "ratio": -3}, lambda s: 9 * 90),
        ({"kind": "gyrator", "resistance": 30}, lambda s: 30**2 / 90),
        (
            {"kind": "coupled inductors", "inductance": ["10 nH", "40 nH"], "coupling": -0.6},
            lambda s: 1e-8 * s - s**2 * 0.36 * 4e-16 / (90 + 4e-8 * s),
        ),
    ],
)
def test_what_is_seen_through_a_multiport(link, seen):
    s = 2j * np.pi * np.array([1e7, 3e8, 2e9])
    bare = scene(link, {"q": resistor(90)}, ("a",), sources={})
    away = scene({}, {}, ("a",), sources={})
    assert 1 / impedance(bare, "p", s) - 1 / impedance(away, "p", s) == pytest.approx(1 / seen(s), rel=1e-12)


@pytest.mark.parametrize("resistance", [0, 40])
def test_a_controlled_source_drives_what_it_is_told(resistance):
    """Into a matched line: its share of the gain, while the first node sees an open end."""
    link = {"kind": "controlled source", "gain": 3, "resistance": resistance}
    given = scene(link, {"out": resistor(120)})
    with pytest.raises(ActiveError, match=r"links\.x may feed waves; yet no wave grows"):
        simulate(given)
    result = simulate(given, active=True)
    alone = simulate(scene({}, {}, ("a",)))
    assert np.abs(result.probes["p"].u - alone.probes["p"].u).max() < 1e-14
    share = 3 * 120 / (120 + resistance)
    assert np.abs(result.probes["q"].u - share * alone.probes["p"].u).max() < 1e-13


def test_a_circulator_passes_waves_on():
    """Matched all around: the source's wave comes out of the next port, and what is sent back out of the third."""
    lines = LINES | {"b": LINES["b"] | {"z0": 50}}
    circulator = {
        "nodes": ["p", "q", "r"], "kind": "junction", "z0": 50, "scattering": [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    }  # fmt: skip
    whole = scene(circulator, {"out": {"kind": "short"}, "r": resistor(50)}, lines=("a", "b"))
    result = simulate(Scene(**whole.table() | {"lines": lines}))
    t = result.probes["in"].t
    assert np.abs(result.probes["in"].u - 2 / 3 * ramp(t)).max() < 1e-14  # nothing comes back
    expected = 2 / 3 * (ramp(t - 1 * NS) - ramp(t - 3 * NS))  # what comes back at q goes to r
    assert np.abs(result.probes["q"].u - expected).max() < 1e-14


def test_two_ideal_efforts_across_a_transformer_are_refused():
    given = scene({"kind": "transformer", "ratio": 2}, {"p": {"kind": "short"}, "q": {"kind": "short"}})
    with pytest.raises(InputError, match=r"links\.x: no efforts and flows follow"):
        simulate(given)


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ({"kind": "transformer", "ratio": 0}, "shorts the first port"),
        ({"kind": "coupled inductors", "inductance": [1, 1], "coupling": 1 - 1e-9}, "without leakage"),
        ({"kind": "coupled inductors", "inductance": [1], "coupling": 0.5}, r"links\.x\.inductance"),
        ({"kind": "controlled source", "gain": 1, "resistance": "inf"}, "drives nothing"),
        ({"kind": "junction", "z0": 50, "scattering": [[0, 1]]}, "not a matrix for 2 ports"),
        ({"kind": "junction", "z0": 50, "scattering": [[0, 2], [0.5, 0]]}, "come out 2 times as large"),
    ],
)
def test_mistakes_are_told(link, said):
    with pytest.raises(SceneError, match=said):
        scene(link, {})
