"""Valves that move their openings by themselves, against delay equations by DOP853."""

import re

import numpy as np
import pytest
from hydraulic_by_hand import pipe
from method_of_steps import ByHand, Motion, integrate

from tline import Scene, SceneError, simulate

LINE = {"length": 500, "diameter": 0.2, "wave_speed": 1000, "density": 1000}
Z0 = pipe(500, 0.2, 1000).z0
HEAD, KEPT, DRAWN, T = 8e5, 4e5, 0.03, 2.0
BORE = np.pi / 4 * 0.2**2
WIDE = BORE * np.sqrt(2 / (2.0 * 1000))  # capacity of an open valve that loses two velocity heads
TAP = DRAWN / np.sqrt(KEPT)
KEEPS = {
    "downstream": {"set_pressure": KEPT, "band": KEPT},
    "upstream": {"set_pressure": HEAD - 1e5, "band": KEPT},
    "flow": {"set_flow": DRAWN},
}


def scene(keeps: str, **more) -> Scene:
    """A lake, a pipe, the valve, a pipe, and a tap that is turned half way."""
    turned = {"shape": "ramp", "from": 1, "to": 0.5 if keeps == "downstream" else 0.8, "at": 1, "duration": 1}
    valve = {"kind": "regulating valve", "nodes": ["a", "b"], "keeps": keeps, "loss_coefficient": 2, "diameter": 0.2}
    return Scene(
        medium="hydraulic",
        t_end=12,
        start="steady",
        lines={"up": {"nodes": ["lake", "a"], **LINE}, "down": {"nodes": ["b", "end"], **LINE}},
        links={"valve": valve | {"time_constant": T} | KEEPS[keeps] | more},
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": HEAD},
            "tap": {"at": "end", "kind": "orifice", "flow": DRAWN, "pressure_drop": KEPT, "opening": turned},
        },
        probes={"a": {"at": "a"}, "b": {"at": "b"}, "end": {"at": "end"}},
    )


def by_hand(keeps: str, start: float, fastest: float = np.inf) -> Motion:
    """x' = drive; the same flow leaves a and enters b."""

    def flow(x, w):
        d = w[1] - w[2]
        return 2 * d * x * WIDE / (2 * Z0 * x * WIDE + np.sqrt((2 * Z0 * x * WIDE) ** 2 + 4 * abs(d)))

    def circuit(t, x, w, mode):
        q = flow(x[0], w)
        a, b = w[1] - Z0 * q, w[2] + Z0 * q
        tap = TAP * np.interp(t, [0, 1], [1, 0.5 if keeps == "downstream" else 0.8])
        out = 2 * w[3] * tap / (Z0 * tap + np.sqrt((Z0 * tap) ** 2 + 4 * abs(w[3])))
        return np.array([np.clip(wanted(q, b), -fastest, fastest)]), np.array([HEAD, a, b, w[3] - Z0 * out])

    def wanted(q, b):
        return ((KEPT - b) / KEPT if keeps == "downstream" else 1 - q / DRAWN) / T

    def edges(t, x, w, mode):
        """Where the rate becomes one of its bounds, or leaves it."""
        q = flow(x[0], w)
        rate = wanted(q, w[2] + Z0 * q)
        if mode[0] == 0:
            return [(fastest - rate, rate + fastest)]
        return [(np.inf, rate - fastest) if mode[0] > 0 else (-fastest - rate, np.inf)]

    w = [HEAD - Z0 * DRAWN, HEAD + Z0 * DRAWN, KEPT - Z0 * DRAWN, KEPT + Z0 * DRAWN]
    lines, steady = [pipe(500, 0.2, 1000)] * 2, [HEAD, HEAD, KEPT, KEPT, *w]
    return integrate(
        circuit, lines, 11.0, scale=[1.0], state=[start], steady=steady, corners=(1.0,), edges=edges, mode=(0,)
    )


@pytest.mark.parametrize("keeps", ["downstream", "flow"])
def test_a_valve_that_keeps_a_value_obeys_its_equation(keeps):
    """The tap moves after 1 s; until then nothing does."""
    result = simulate(scene(keeps), tol=1e-8)
    start = DRAWN / np.sqrt(HEAD - KEPT) / WIDE
    found = ByHand(lambda: by_hand(keeps, start), {"a": 1, "b": 2, "end": 3}, 1.0).differences(result.probes)
    assert max(found.values()) < 1e-9


def test_a_valve_is_no_faster_than_its_stroke():
    """Its rate bends where the stroke begins and ceases to bound it."""
    result = simulate(scene("downstream", stroke_time=20), tol=1e-6)
    start = DRAWN / np.sqrt(HEAD - KEPT) / WIDE
    found = ByHand(lambda: by_hand("downstream", start, 1 / 20), {"a": 1, "b": 2, "end": 3}, 1.0)
    assert max(found.differences(result.probes).values()) < 1e-6


@pytest.mark.parametrize("keeps", ["downstream", "upstream", "flow"])
def test_nothing_operated_nothing_moves(keeps):
    """Whether the value is given or that of the start, over a minute."""
    still = scene(keeps).table()
    still["loads"]["tap"]["opening"] = 1
    still["lines"]["up"]["friction"] = {"kind": "darcy", "factor": 0.08}
    given = Scene(**still | {"t_end": 60})
    kept = {key: value for key, value in still["links"]["valve"].items() if not key.startswith("set_")}
    kept |= {"opening": 0.11} | ({"flow_band": DRAWN} if keeps == "flow" else {})
    for each in (given, given.with_changes(links={"valve": kept})):
        result = simulate(each, tol=1e-4)
        for probe in result.probes.values():
            assert np.ptp(probe.u) <= 1e-9 * HEAD
            assert np.ptp(probe.y) <= 1e-9 * DRAWN


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (6e5, 3e5, (6e5, 3e5)),
        (9e5, 3e5, (None, 3e5)),
        (6e5, 9e5, (6e5, None)),
        (3e5, 6e5, (3e5, None)),
        (6e5, 5e4, (6e5, 5e4)),
    ],
)
def test_reducers_in_a_row_start_where_neither_moves(first, second, expected):
    """Each at its height; one that cannot reach its pressure is wide open."""
    reducer = {"kind": "regulating valve", "keeps": "downstream", "loss_coefficient": 5, "diameter": 0.15}
    reducer |= {"characteristic": "globe", "time_constant": 10}
    line = {**LINE, "friction": {"kind": "darcy", "factor": 0.02}}
    pipes = {"up": ["lake", "a"], "middle": ["b", "c"], "down": ["d", "end"]}
    heights = {"lake": 20, "a": 0, "b": 0, "c": 3, "d": 3, "end": -5}
    given = Scene(
        medium="hydraulic",
        t_end=60,
        start="steady",
        lines={name: {"nodes": nodes, **line} for name, nodes in pipes.items()},
        links={
            "one": {"nodes": ["a", "b"], "set_pressure": first, **reducer},
            "two": {"nodes": ["c", "d"], "set_pressure": second, **reducer},
        },
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": HEAD},
            "tap": {"at": "end", "kind": "orifice", "flow": 0.02, "pressure_drop": 3e5},
        },
        nodes={name: {"elevation": z} for name, z in heights.items()},
        probes={"b": {"at": "b"}, "d": {"at": "d"}},
    )
    result = simulate(given, tol=1e-3)
    for probe, kept, set_at in zip(result.probes.values(), expected, (first, second), strict=True):
        assert np.ptp(probe.u) <= 1e-9 * HEAD
        if kept is None:
            assert probe.gauge_pressure[0] < set_at
        else:
            assert probe.gauge_pressure[0] == pytest.approx(kept, rel=1e-9)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"keeps": "temperature"}, "links.valve.keeps: "),
        ({"set_flow": 0.1}, "links.valve.set_flow: is not what it keeps, expected none with keeps = 'downstream'"),
        ({"flow_band": 0.1}, "links.valve.flow_band: is for a flow, expected band"),
        ({"set_pressure": None}, "links.valve.opening: is missing, expected a set value, or the opening"),
        ({"keeps": "flow", "set_pressure": None, "opening": 0.1}, "links.valve.flow_band: is missing"),
        ({"stroke_time": 0}, "links.valve.stroke_time: "),
    ],
)
def test_a_valve_that_is_not_told_what_to_keep(more, said):
    table = scene("downstream").table()
    valve = {key: value for key, value in (table["links"]["valve"] | more).items() if value is not None}
    with pytest.raises(SceneError, match=re.escape(said)):
        Scene(**table | {"links": {"valve": valve}})


def test_what_the_start_has_needs_a_steady_one():
    table = scene("downstream").table()
    valve = {key: value for key, value in table["links"]["valve"].items() if key != "set_pressure"} | {"opening": 0.5}
    with pytest.raises(SceneError, match="set_pressure: is missing, expected a value, or start = 'steady'"):
        Scene(**table | {"links": {"valve": valve}, "start": "rest"})
