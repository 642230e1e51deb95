"""What operations on a network do, against closed forms, and within their time."""

import numpy as np
import pytest

import tline as tl
from tline import InputError, Scene, operate, simulate
from tline.scene.heights import GRAVITY
from tline.surge.event import Event
from tline.surge.operate import operated, usual_inertia
from tline.surge.report import band_text
from tline.surge.worst import RISES, SEPARATES, STOOD, worst

SPEED, DENSITY, DIAMETER, HEAD, DRAWN = 1000.0, 1000.0, 0.2, 60.0, 0.01
Z0 = DENSITY * SPEED / (np.pi / 4 * DIAMETER**2)
PIPE = {"length": 500, "diameter": DIAMETER, "wave_speed": SPEED, "density": DENSITY}


def line_with(friction, flow: float) -> Scene:
    """A pipe from a reservoir to a valve that lets this flow out, m³/s."""
    return Scene(
        medium="hydraulic", t_end=3, start="steady", lines={"p": {"nodes": ["a", "b"], **PIPE, "friction": friction}},
        loads={
            "a": {"at": "a", "kind": "reservoir", "pressure": 6e5},
            "v": {"at": "b", "kind": "orifice", "flow": flow, "pressure_drop": 6e5},
        },
        probes={"b": {"at": "b"}},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("unsteady", "flow", "steady", "whole"),
    [
        ("vardy-brown", 2e-2, {"kind": "quasi-steady", "viscosity": 1e-3, "roughness": 0}, "vardy-brown"),
        ("zielke", 2e-4, {"kind": "swamee-jain", "viscosity": 1e-3, "roughness": 0}, "zielke"),
    ],
)
def test_unsteady_friction_of_a_whole_network_is_that_of_its_pipes(unsteady, flow, steady, whole):
    t, shut = np.linspace(0, 1.5, 400), {"close": "v@0.3s+0.2s", "t_end": 1.5, "order": 2}
    seen = operate(line_with(steady, flow), unsteady=unsteady, **shut).result.probes["b"]
    table = {"kind": whole, "viscosity": 1e-3}
    if whole == "vardy-brown":
        reynolds = 4 * DENSITY * abs(seen.y[0]) / (np.pi * DIAMETER * 1e-3)
        table |= {"roughness": 0, "reynolds": reynolds}
    other = operate(line_with(table, flow), **shut).result.probes["b"].at(t).u
    alone = operate(line_with(steady, flow), **shut).result.probes["b"].at(t).u
    assert np.abs(seen.at(t).u - other).max() < 0.2 * np.abs(alone - other).max()


def network(**more) -> Scene:
    """A reservoir, two pipes in a row without friction, and a demand at their end, 10 m above the zero of heights."""
    outlet = {"at": "c", "kind": "check valve", "flow": DRAWN, "pressure_drop": (HEAD - 10) * DENSITY * GRAVITY}
    return Scene(
        medium="hydraulic",
        t_end=3,
        start="steady",
        lines={"p1": {"nodes": ["a", "b"], **PIPE}, "p2": {"nodes": ["b", "c"], **PIPE}},
        loads={"a": {"at": "a", "kind": "reservoir", "pressure": HEAD * DENSITY * GRAVITY}, "c": outlet},
        nodes={"a": {"elevation": 0}, "b": {"elevation": 5}, "c": {"elevation": 10}},
        probes={"c": {"at": "c"}},
        **more,
    )


def run(*events: Event, scene: Scene | None = None):
    changed, _ = operated(scene or network(), events)
    return simulate(changed, tol=1e-6, envelope=True)


def test_a_pipe_shut_at_once_has_joukowskys_rise_before_its_valve():
    """The valve that is put into the pipe takes its loss from the flow; it is that flow that stops."""
    result = run(Event("close", "p2", 0.5))
    found = worst(result)
    p0 = (HEAD - 10) * DENSITY * GRAVITY
    flow = DRAWN * (result.probes["c"].gauge_pressure[0] / p0) ** 0.5
    assert found.risen[0].rise == pytest.approx(Z0 * flow, rel=1e-6)
    assert flow == pytest.approx(DRAWN, rel=1e-3)
    assert found.needed == 1.0e6


@pytest.mark.parametrize("stage", [(), (0.2, 1.5)])
def test_a_closure_in_one_stage_and_in_two_is_allievis_chain(stage):
    """At the valve u + z0·q is what arrives, q = C·opening·sqrt(u), and the reservoir sends 2·p0 less what came."""
    p0, capacity = 6e5, 2e-4
    valve = {"at": "b", "kind": "orifice", "flow": capacity * p0**0.5, "pressure_drop": p0}
    scene = Scene(
        medium="hydraulic", t_end=4, start="steady", lines={"p": {"nodes": ["a", "b"], **PIPE}},
        loads={"a": {"at": "a", "kind": "reservoir", "pressure": p0}, "v": valve}, probes={"b": {"at": "b"}},
    )  # fmt: skip
    event = Event("close", "v", 0.25, 1.0, stage=stage)
    bends = [0.25, 1.25, *([2.75] if stage else [])], [1.0, *([0.2] if stage else []), 0.0]
    changed, _ = operated(scene, [event])
    probe = simulate(changed, tol=1e-9).probes["b"]

    def pressure(t: float) -> float:
        """By the chain of echoes, each 1 s after the other."""
        sent = p0 - Z0 * capacity * p0**0.5
        for k in range(int(t), -1, -1):
            arrives, share = 2 * p0 - sent, capacity * np.interp(t - k, *bends)
            root = 2 * arrives / (Z0 * share + np.sqrt((Z0 * share) ** 2 + 4 * abs(arrives)))
            sent = root * abs(root) - Z0 * share * root
        return root * abs(root)

    for t in (0.3, 0.7, 1.2, 1.6, 2.3, 2.7, 3.3, 3.9):
        assert probe.at(t).u == pytest.approx(pressure(t), rel=1e-8)


def test_a_burst_takes_its_flow_at_the_pressure_that_was_there():
    """q = Q·sqrt(p/p0) and p = p0 - z0·q/2 where two pipes meet, until echoes are back."""
    flow = 0.02
    result = run(Event("burst", "b", 0.5, 0.0, flow))
    p0 = (HEAD - 5) * DENSITY * GRAVITY
    share = np.roots([1, Z0 / 2 * flow / p0, -1]).max()
    probed = simulate(result.scene.with_changes(probes={"b": {"at": "b"}}), tol=1e-6).probes["b"]
    assert probed.gauge_pressure[probed.t < 0.45][-1] == pytest.approx(p0, rel=1e-9)
    assert probed.at(0.8).u - 5 * DENSITY * GRAVITY == pytest.approx(p0 * share**2, rel=1e-6)


@pytest.mark.parametrize(("change", "share"), [(-DRAWN, 0.0), (-DRAWN / 2, 0.5), (DRAWN, 2.0)])
def test_a_demand_that_changes(change, share):
    """q = share·Q·sqrt(p/p0) at the end of a pipe into which the wave p0 + z0·Q comes."""
    result = run(Event("demand", "c", 0.5, 0.0, change))
    p0 = (HEAD - 10) * DENSITY * GRAVITY
    root = np.roots([1, Z0 * share * DRAWN / p0, -1 - Z0 * DRAWN / p0]).max()
    probe = result.probes["c"]
    assert probe.at(0.8).u - 10 * DENSITY * GRAVITY == pytest.approx(p0 * root**2, rel=1e-6)


def test_a_regulating_valve_that_is_shut_regulates_no_more():
    """It shuts from the opening at which it stood."""
    keeps = {"kind": "regulating valve", "keeps": "downstream", "set_pressure": 2e5, "loss_coefficient": 2}
    valve = keeps | {"nodes": ["b", "b2"], "diameter": DIAMETER}
    nodes = network().table()["nodes"] | {"b2": {"elevation": 5}}
    pipes = {"p1": {"nodes": ["a", "b"], **PIPE}, "p2": {"nodes": ["b2", "c"], **PIPE}}
    scene = network().with_changes(lines=pipes, links={"valve": valve}, nodes=nodes, probes={"b2": {"at": "b2"}})
    changed, (note,) = operated(scene, [Event("close", "valve", 0.5, 0.2)])
    assert "it regulates no more" in note
    probe = simulate(changed, tol=1e-6).probes["b2"]
    assert probe.gauge_pressure[0] == pytest.approx(2e5, rel=1e-9)
    assert abs(probe.at(0.71).y) < 1e-9


def pumped() -> Scene:
    """The same, with a pump that runs at 0.9 of its speed in front, and a reservoir before it."""
    pump = {"kind": "pump", "nodes": ["s", "a"], "curve": [[DRAWN, HEAD * DENSITY * GRAVITY]], "speed": 0.9}
    return network().with_changes(
        loads=network().table()["loads"] | {"a": {"at": "s", "kind": "reservoir", "pressure": 2e5}},
        links={"lift": pump}, nodes=network().table()["nodes"] | {"s": {"elevation": 0}},
    )  # fmt: skip


@pytest.mark.parametrize("duration", [0.0, 0.7])
def test_a_pump_that_stops_lets_back_what_its_standing_wheel_does(duration):
    """Joukowsky's fall by the flow that stops and the one that turns, which a third of the rated head drives at rest.

    So it is until the wave returns after 2 s. A curve of one point is a parabola from 4/3 of the head there.
    """
    scene = pumped().with_changes(probes={"a": {"at": "a"}, "c": {"at": "c"}})
    changed, notes = operated(scene, [Event("stop", "lift", 0.5, duration)])
    probes = simulate(changed, tol=1e-6).probes
    a, flow = probes["a"], abs(probes["c"].y[0])
    loss = HEAD * DENSITY * GRAVITY / 3 / DRAWN**2
    back = max(np.roots([loss, Z0, -(a.u[0] - Z0 * flow - 2e5)]))
    after = a.u[(a.t > 0.55 + duration) & (a.t < 2.45)]
    assert notes == []
    assert after == pytest.approx(2e5 + loss * back**2, abs=1e-5 * Z0 * flow)


def test_a_pump_that_trips_has_a_usual_inertia_unless_it_is_given():
    scene = pumped()
    changed, (note,) = operated(scene, [Event("trip", "lift", 0.5)])
    tripped = changed.links["lift"]
    before = simulate(scene, tol=1e-4)
    result = simulate(changed, tol=1e-4)
    assert result.probes["c"].u[0] == pytest.approx(before.probes["c"].u[0], rel=1e-9)
    assert result.probes["c"].u[-1] < 0.9 * result.probes["c"].u[0]
    flow = abs(before.probes["c"].y[0])
    power = (before.probes["c"].u[0] - 2e5) * flow / 0.75
    assert tripped.inertia == pytest.approx(usual_inertia(power, 1450 / 60), rel=5e-3)
    assert "1450 rpm" in note
    changed, notes = operated(scene, [Event("trip", "lift", 0.5)], inertia="2 kg m^2", rated_speed="1000 rpm")
    assert (float(changed.links["lift"].inertia), notes) == (2.0, [])


@pytest.mark.parametrize("change", [0.005, -0.004])
def test_a_pulse_of_demand_is_its_rise_until_it_falls_and_nothing_between_fall_and_echo(change):
    pulse = run(Event("demand", "c", 1.0, 0.2, -change), Event("demand", "c", 0.25, 0.25, change)).probes["c"]
    single = run(Event("demand", "c", 0.25, 0.25, change)).probes["c"]
    assert abs(single.at(0.9).u / single.u[0] - 1) > 0.05
    t = np.linspace(0, 1.0, 41)
    assert pulse.at(t).u == pytest.approx(single.at(t).u, rel=3e-6)
    assert pulse.at(1.23).u == pytest.approx(pulse.u[0], rel=3e-6)


@pytest.mark.parametrize(
    ("events", "said"),
    [
        (
            [(1, 1.0, 0.005), (1.5, 0, -0.005)],
            "demand: changes at 'c' overlap, expected one after the other, got 1.5 s",
        ),
        ([(1, 0, 0.005), (2, 0, -0.006)], "demand: changes at 'c' lead above and below what it drew, expected sums"),
    ],
)
def test_a_pulse_is_in_order_and_on_one_side(events, said):
    with pytest.raises(InputError, match=said):
        operated(network(), [Event("demand", "c", *event) for event in events])


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (Event("open", "p1", 1), "open: pipe 'p1' is open already, expected a valve that is not"),
        (Event("trip", "p1", 1), "trip: not a pump, expected a scene that has one, got 'p1'"),
        (Event("close", "p3", 1), "close: not a valve, or an open pipe, expected one of 'p1', 'p2', got 'p3'"),
        (Event("burst", "d", 1, 0, 0.1), "burst: no such node, expected one of"),
        (Event("demand", "c", 1, 0, -0.1), "demand: node 'c' draws less, expected at least 100 L/s, got 10 L/s"),
        (Event("demand", "b", 1, 0, -0.1), "demand: node 'b' draws less, expected at least 100 L/s, got 0 L/s"),
    ],
)
def test_what_cannot_be_operated(event, said):
    with pytest.raises(InputError, match=said):
        operated(network(), [event])


def test_nothing_is_operated_twice():
    with pytest.raises(InputError, match="'p1' is operated twice"):
        operated(network(), [Event("close", "p1", 1), Event("open", "p1", 2)])
    with pytest.raises(InputError, match="nothing to be operated"):
        operated(network().with_changes(start="rest"), [])


def test_a_pipe_shut_where_its_end_is_probed_by_its_name():
    scene = network().with_changes(probes={"c": {"at": "c", "line": "p2"}})
    changed, _ = operated(scene, [Event("close", "p2", 0.5)])
    assert changed.probes["c"].line is None
    assert changed.lines["p2"].nodes[1] == "p2:gate"


def test_a_node_at_which_no_pipe_ends_is_judged_too():
    """What is pushed in behind a valve that shuts finds no way out: no class bears that."""
    valve = {"kind": "orifice", "nodes": ["c", "d"], "flow": DRAWN, "pressure_drop": 1e5}
    table = network().table()
    scene = network().with_changes(
        links={"v": valve},
        sources={"in": {"at": "d", "kind": "flow", "value": DRAWN}},
        nodes=table["nodes"] | {"d": {"elevation": 10}},
    )
    seen = run(Event("close", "v", 0.5), scene=scene)
    found = worst(seen)
    assert seen.envelope is not None
    assert found.highest.before == pytest.approx(seen.envelope.of("c")["start"] + 1e5 - 10 * DENSITY * GRAVITY)
    assert (found.highest.node, found.needed) == ("d", None)
    assert 0.5 <= found.highest.highest_at < 0.5 + seen.slabs.width  # as high, but for rounding, from then on


def test_the_rotor_of_a_pump_that_lifts_nothing_is_that_of_its_largest_power():
    held = {"kind": "pump", "nodes": ["a", "b"], "curve": [[0.01, 1e2]], "check_valve": True}
    scene = network(links={"held": held}).change({"loads.a.pressure": 6e5})
    changed, (note,) = operated(scene, [Event("trip", "held", 1)])
    assert changed.links["held"].inertia > 0
    assert "what is usual for" in note


@pytest.mark.parametrize("kind", ["trip", "stop"])
def test_a_pump_that_stands_neither_trips_nor_stops(kind):
    standing = {"kind": "pump", "nodes": ["a", "b"], "curve": [[0.01, 2e5]], "check_valve": True, "speed": 0}
    scene = network(links={"pump": standing})
    with pytest.raises(InputError, match=f"{kind}: pump 'pump' stands already, expected a pump that runs"):
        operated(scene, [Event(kind, "pump", 1)])


@pytest.mark.parametrize(("takes", "notes"), [(0.0, 2), (1.5, 0)])
def test_a_pump_that_is_started_comes_to_lift_what_it_lifts(takes, notes):
    """Between equal tanks, through a pipe without loss and a valve: rise and loss are equal in the end."""
    p0, rest, last, capacity = 3e5, 4e5, 0.03, 3e-5
    scene = Scene(
        medium="hydraulic", t_end=30, start="steady", lines={"p": {"nodes": ["c", "b"], **PIPE}},
        loads={name: {"at": name, "kind": "reservoir", "pressure": p0} for name in ("s", "t")},
        links={
            "pump": {"kind": "pump", "nodes": ["s", "c"], "curve": [[0, rest], [last, 0]], "speed": 0},
            "valve": {"kind": "orifice", "nodes": ["b", "t"], "flow": capacity * p0**0.5, "pressure_drop": p0},
        },
        probes={"b": {"at": "b"}},
    )  # fmt: skip
    event = Event("start", "pump", 1.0, takes)
    changed, told = operated(scene, [event])
    assert len(told) == notes
    probe = simulate(changed, tol=1e-4).probes["b"]
    assert np.ptp(probe.u[probe.t < 1]) < 1e-6 * rest
    flow = (rest / (capacity**-2 + rest / last**2)) ** 0.5
    assert probe.y[-1] == pytest.approx(flow, rel=1e-3)
    tables = scene.table()
    tables["links"]["pump"]["speed"] = 1
    with pytest.raises(InputError, match="start: pump 'pump' runs already"):
        operated(Scene(**tables), [event])


def test_no_class_where_columns_separate_and_one_beside_cavities():
    """A pipe shut at once sends a fall of Joukowsky's 65 m downstream, where 50 m stand."""
    table = network().table()
    table["loads"]["c"]["flow"] = 2 * DRAWN
    closing, scene = Event("close", "p1", 0.5), Scene(**table)
    found = worst(run(closing, scene=scene))
    boiling = {one.node for one in found.boiling}
    assert boiling
    assert (found.needed, found.untold) == (None, SEPARATES)
    changed, _ = operated(scene, [closing])
    table = changed.table() | {"solver": {"order": 1}}
    table["loads"] |= {f"{node}:cavity": {"at": node, "kind": "vapour cavity"} for node in boiling}
    held = worst(simulate(Scene(**table), envelope=True))
    assert not held.boiling
    assert held.untold != SEPARATES


def test_water_that_boils_before_anything_is_operated_is_the_networks_own_fault():
    table = network().table()
    table["lines"]["hill"] = {"nodes": ["b", "top"], **PIPE}
    table["loads"]["top"] = {"at": "top", "kind": "closed"}
    table["nodes"]["top"] = {"elevation": HEAD + 12}
    assert worst(run(Event("demand", "c", 0.5, 0.5, 1e-4), scene=Scene(**table))).untold == STOOD


@pytest.mark.parametrize(("t_end", "cut"), [(0.999, True), (3.0, False)])
def test_no_class_where_the_run_ends_at_its_highest_pressure(t_end, cut):
    """A demand that falls for a second raises the pressure all the while."""
    changed, _ = operated(network(), [Event("demand", "c", 0.1, 1.0, -0.008)])
    found = worst(simulate(changed.with_changes(t_end=t_end), tol=1e-4, envelope=True))
    assert (found.highest.node in {one.node for one in found.unfinished}) == cut
    assert found.untold == (RISES if cut else "")
    assert (found.needed is None) == cut


TOWN = tl.examples["town"]


def test_a_class_comes_with_the_error_that_is_left():
    brief, long = (tl.operate(TOWN, close="ab@1s+1s", t_end="4 s", seconds=s, cavities=False) for s in (1e-3, 20))
    assert [len(each.result.accuracy.attempts) for each in (brief, long)] == [2, 3]
    highest = [each.worst.highest for each in (brief, long)]
    assert abs(highest[0].highest - highest[1].highest) <= highest[0].highest_error + highest[1].highest_error
    assert brief.worst.spread >= highest[0].highest_error > 0


def test_no_class_where_cavities_had_no_time():
    surge = tl.operate(TOWN, trip="duty@1s", close="ab@1s", t_end="4 s", seconds=1e-3)
    assert surge.worst.needed is None
    assert "no pressure class is named" in str(surge)
    assert any("another run would take the total beyond 0.001 s" in note for note in surge.notes)


def test_time_is_asked_in_seconds():
    with pytest.raises(tl.InputError, match="seconds: duration out of range"):
        tl.operate(TOWN, seconds=0)


def test_guesses_for_which_no_time_is_left_are_named():
    surge = tl.operate(TOWN, close="ab@1s+1s", t_end="1 s", cavities=False)
    band = surge.band(seconds=1e-3)
    assert band.varied == ()
    assert "wave speed × 0.85" in band.left
    assert "not varied, for want of time: wave speed × 0.85" in "\n".join(band_text(surge.result, band))
