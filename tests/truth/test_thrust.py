"""Forces on bends, pipes that drain, waves in ten thousand pipes: against formulas and volumes."""

import runpy
from math import comb, cos, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

import tline as tl
from tline import Scene, simulate
from tline.scene.heights import GRAVITY
from tline.surge.thrust import thrusts
from tline.surge.worst import DRAINS, worst

HEAD, WAVE, DENSITY, DIAMETER, FLOW, ANGLE = 6e5, 1000.0, 1000.0, 0.5, 0.2, radians(60)
AREA = pi / 4 * DIAMETER**2
RISE = DENSITY * WAVE * FLOW / AREA


def bent(up: float = 0.0) -> tl.scene.Scene:
    """A main that turns by an angle in its middle, so far below both ends, and shuts at once at its end."""
    pipe = {"length": 500, "diameter": DIAMETER, "wave_speed": WAVE, "density": DENSITY}
    shut = {"shape": "step", "from": 1, "to": 0, "at": 0.5}
    drop = HEAD - DENSITY * 9.80665 * up
    return tl.Scene(
        medium="hydraulic",
        t_end=1.9,
        start="steady",
        lines={
            "one": {"nodes": ["lake", "bend"], **pipe},
            "two": {"nodes": ["bend", "end"], **pipe, "vertices": [[3 * sin(ANGLE), 5 + 3 * cos(ANGLE)]]},
        },
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": HEAD},
            "valve": {"at": "end", "kind": "orifice", "flow": FLOW, "pressure_drop": drop, "opening": shut},
        },
        nodes={
            "lake": {"position": [0, 0], "elevation": up},
            "bend": {"position": [0, 5], "elevation": 0},
            "end": {"position": [99, 0], "elevation": up},
        },
        probes={"end": {"at": "end"}},
        solver={"order": 3, "slab": 0.1},
    )


def forces(scene: tl.Scene):
    return thrusts(tl.simulate(scene, envelope=True, record=[*scene.lines]))


def test_a_bend_and_a_dead_end():
    """2 (p A + density Q²/A) sin(angle/2) on the bend, p A on what is shut; none where the pressure is held."""
    found = forces(bent())
    assert found.keys() == {"bend", "end"}
    flowing = HEAD * AREA + DENSITY * FLOW**2 / AREA
    assert found["bend"].before == pytest.approx(2 * flowing * sin(ANGLE / 2), rel=1e-9)
    assert found["bend"].highest == pytest.approx(2 * (HEAD + RISE) * AREA * sin(ANGLE / 2), rel=1e-6)
    assert found["end"].highest == pytest.approx((HEAD + RISE) * AREA, rel=1e-6)
    assert 1.0 <= found["bend"].at <= 1.2


def test_slopes_count():
    """A bend 30 m below both of its ends: in space, not on the map; at the end the gauge pressure is less by that."""
    found, slope = forces(bent(30.0)), 30 / 500
    level = (1 - slope**2) ** 0.5
    ways = np.array([[0, -level, slope], [level * sin(ANGLE), level * cos(ANGLE), slope]])
    flowing = HEAD * AREA + DENSITY * FLOW**2 / AREA
    assert found["bend"].before == pytest.approx(flowing * np.linalg.norm(ways.sum(axis=0)), rel=1e-9)
    assert found["end"].highest == pytest.approx((HEAD - DENSITY * 9.80665 * 30 + RISE) * AREA, rel=1e-6)


def test_without_places_only_single_pipes_have_one():
    assert forces(bent().with_changes(nodes={})).keys() == {"end"}


HEIGHT, LENGTH, WIDTH, CAPACITY, OPENS, TAKES = 30.0, 120.0, 0.2, 4e-5, 1.0, 0.5
PIPE = {"nodes": ["top", "low"], "length": LENGTH, "diameter": WIDTH, "wave_speed": 1000, "density": 1000}
VOLUME, OUTFLOW = pi / 4 * WIDTH**2 * LENGTH, CAPACITY * sqrt(1000 * GRAVITY * HEIGHT)


def scene(t_end: float) -> tl.Scene:
    """A lake feeds it, until it is shut off."""
    opening, shutting = (
        {"shape": "ramp", "from": 1 - to, "to": to, "at": at, "duration": TAKES} for to, at in ((1, OPENS), (0, 0.2))
    )
    return tl.Scene(
        medium="hydraulic",
        t_end=t_end,
        start="steady",
        nodes={"lake": {"elevation": HEIGHT}, "top": {"elevation": HEIGHT}, "low": {"elevation": 0}},
        lines={"pipe": PIPE},
        links={"feed": {"nodes": ["lake", "top"], "kind": "orifice", "kv": 100, "opening": shutting}},
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": 1000 * GRAVITY * HEIGHT + 1e3},
            "air": {"at": "top", "kind": "air valve", "inlet_diameter": 0.2, "outlet_diameter": 0.05},
            "drain": {"at": "low", "kind": "orifice", "flow": CAPACITY, "pressure_drop": 1.0, "opening": opening},
        },
        probes={"low": {"at": "low"}},
        solver={"order": 3, "slab": 0.01},
    )


def test_air_takes_the_room_of_what_flows_out_and_from_a_tenth_on_no_class_is_named():
    """Under the head of a full pipe the flow settles, for the waves that the opening makes die out at the drain."""
    late = OPENS + TAKES / 2 + 0.1 * VOLUME / OUTFLOW
    short, long = (tl.simulate(scene(t_end), envelope=True) for t_end in (late - 0.2, late + 1))
    (air,) = (trace for trace in long.states if trace.word == "air volume")
    drawn = np.trapezoid(long.probes["low"].y, long.t)
    assert air.values[-1] == pytest.approx(drawn, rel=1e-3)
    assert air.values[-1] == pytest.approx(0.1 * VOLUME + OUTFLOW, rel=0.01)
    (note,) = (note for note in long.notes if "they drain" in note)
    assert float(note.partition("after ")[2].partition(" s")[0]) == pytest.approx(late, rel=0.01)
    assert worst(long).untold == DRAINS
    assert worst(short).untold != DRAINS
    assert not any("they drain" in note for note in short.notes)


grid = runpy.run_path(str(Path(__file__).parents[2] / "scenes" / "street_grid.py"))["grid"]
SIDE, SHUT, ROUNDING = 71, 0.1, 1e-9


def simulated(side, nodes, **given):
    """A grid with a probe at each of some nodes."""
    tables = grid(side, **given)
    ends = {pipe["nodes"][0]: name for name, pipe in tables["lines"].items()}
    tables["probes"] |= {node: {"at": node, "line": ends[node]} for node in nodes}
    return simulate(Scene(**tables))


def test_a_wave_from_node_to_node_halves_and_adds_up():
    """Where four equal pipes meet, a half goes on in each: so many paths of so many halves, as a random walk."""
    middle, flow = SIDE // 2, 5e-3
    places = [(3, 2), (0, 4), (-5, 1), (2, -2)]
    names = [f"n{middle + i}_{middle + j}" for i, j in places]
    result = simulated(SIDE, names, friction=False, lengths=[80], diameters=[200])
    z0 = 1000 * 1000 / (np.pi * 0.1**2)
    assert len(result.scene.lines) == 9940
    for (i, j), name in zip(places, names, strict=True):
        steps = abs(i) + abs(j)
        arrival = SHUT + steps * 0.08
        u = result.probes[name].u
        before, after = (u[np.searchsorted(result.t, arrival + d)] - 5e5 for d in (-0.005, 0.005))
        assert before == pytest.approx(0, abs=ROUNDING * 5e5)
        assert after == pytest.approx(flow * z0 / 4 * comb(steps, abs(i)) / 2**steps, rel=ROUNDING * 5e5 / 100)


def test_waves_arrive_by_the_shortest_way():
    names = ["n15_18", "n26_23", "n20_14"]
    result = simulated(41, names, friction=False)
    lines = result.scene.lines.values()
    number = {node: k for k, node in enumerate(dict.fromkeys(node for line in lines for node in line.nodes))}
    first, second = np.array([[number[node] for node in line.nodes] for line in lines]).T
    delays = coo_array(([line.parameters.delay for line in lines], (first, second)), shape=(len(number),) * 2)
    times = dijkstra(delays.tocsr(), directed=False, indices=number["n20_20"])
    for name in names:
        moved = np.abs(result.probes[name].u - 5e5) > 1.0  # Pa; the wave is thousands of times higher
        assert result.t[moved][0] == pytest.approx(SHUT + times[number[name]] + 0.01)  # the first slab end behind it


def test_a_network_with_friction_stands_still_until_something_is_shut():
    result = simulated(21, ["n9_9"])
    for probe in result.probes.values():
        still = result.t < SHUT - 1e-6
        assert np.ptp(probe.u[still]) < ROUNDING * 5e5
        assert np.ptp(probe.u) > 100.0
