"""The steady state against cases solved by hand, against a slow rise from rest, and against time itself."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_scenes import random_scene

from tline import InputError, Scene, simulate
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state

ROUNDING = 1e-14  # a handful of operations, relative to the largest number of the case


def cable(one: str, two: str, z0: float = 1.0, delay: float = 1.0) -> dict:
    return {"nodes": [one, two], "z0": z0, "delay": delay}


def steady(lines: dict, medium: str = "electrical", **parts) -> dict[str, tuple[float, float]]:
    """Effort and flow of each line before t = 0."""
    first, (node, _) = next((name, line["nodes"]) for name, line in lines.items())
    probes = {"p": {"at": node, "line": first}}
    scene = Scene(medium=medium, t_end=10.0, start="steady", lines=lines, probes=probes, **parts)
    start = assemble(describe(scene), set()).start
    return {k: ((a + b) / 2, (a - b) / (2 * scene.lines[k].parameters.z0)) for k, (a, b, _, _) in start.items()}


def check(found: dict[str, tuple[float, float]], **expected: tuple[float, float]) -> None:
    assert found.keys() == expected.keys()
    size = max(abs(float(x)) for pair in expected.values() for x in pair) or 1.0
    for name, pair in expected.items():
        assert found[name] == pytest.approx([float(x) for x in pair], rel=ROUNDING, abs=ROUNDING * size), name


def resistors(**at: float) -> dict:
    return {f"r_{node}": {"at": node, "kind": "resistor", "resistance": value} for node, value in at.items()}


def source(at: str, kind: str, value, resistance: float | None = None) -> dict:
    return {"at": at, "kind": kind, "value": value} | ({} if resistance is None else {"resistance": resistance})


def test_a_pipe_between_a_reservoir_and_a_valve():
    """5 bar over 10⁸ Pa s/m³ make 5 L/s, whatever the pipe."""
    pipe = {"nodes": ["tank", "valve"], "radius": "10 cm", "wave_speed": 1200, "density": 998, "length": "300 m"}
    tank = {"at": "tank", "kind": "reservoir", "pressure": "5 bar"}
    valve = {"at": "valve", "kind": "valve", "before": 1e8, "after": float("inf"), "time": 0}
    check(steady({"pipe": pipe}, "hydraulic", loads={"tank": tank, "valve": valve}), pipe=(5e5, 5e-3))
    backwards = pipe | {"nodes": ["valve", "tank"]}
    check(steady({"pipe": backwards}, "hydraulic", loads={"tank": tank, "valve": valve}), pipe=(5e5, -5e-3))


@pytest.mark.parametrize(("time", "flow"), [(-1.0, 1 / 3), (0.0, 1 / 2), (1.0, 1 / 2)])
def test_a_switch_counts_as_it_is_just_before_zero(time, flow):
    switch = {"at": "b", "kind": "switch", "before": 1.0, "after": 2.0, "time": time}
    found = steady({"l": cable("a", "b")}, sources={"s": source("a", "voltage", 1.0, 1.0)}, loads={"sw": switch})
    check(found, l=(1 - flow, flow))


@pytest.mark.parametrize(
    ("value", "level"),
    [
        (3, 3),
        ({"shape": "step", "from": 3, "to": 7}, 3),
        ({"shape": "step", "from": 7, "to": 3, "at": -1}, 3),
        ({"shape": "ramp", "from": 1, "to": 5, "at": -1, "duration": 2}, 3),
        ({"shape": "sine", "amplitude": 2, "frequency": 1, "phase": "90 deg", "offset": 1, "at": 4}, 3),
        ({"shape": "pulses", "high": 3, "width": 1, "at": -0.5}, 3),
    ],
)
def test_a_source_counts_as_it_is_just_before_zero(value, level):
    found = steady({"l": cable("a", "b")}, sources={"s": source("a", "voltage", value, 1.0)}, loads=resistors(b=2.0))
    check(found, l=(level * 2 / 3, level / 3))


def test_a_tree():
    """Trunk, two branches, a twig; every resistance sees the same 6 V."""
    lines = {
        "trunk": cable("in", "j"),
        "left": cable("j", "l", 2.0),
        "right": cable("r", "j", 3.0),
        "twig": cable("r", "t"),
    }
    found = steady(lines, sources={"s": source("in", "voltage", 6.0)}, loads=resistors(l=2.0, r=3.0, t=6.0))
    check(found, trunk=(6, 6), left=(6, 3), right=(6, -3), twig=(6, 1))


def test_parallel_lines_share_inversely_to_their_inertia():
    """z0·T of 2, 3 and 6: shares of 3/6, 2/6, 1/6."""
    lines = {"a": cable("x", "y", 2.0, 1.0), "b": cable("y", "x", 1.0, 3.0), "c": cable("x", "y", 12.0, 0.5)}
    found = steady(lines, sources={"s": source("x", "current", 12.0)}, loads=resistors(y=0.5))
    check(found, a=(6, 6), b=(6, -4), c=(6, 2))


def test_a_balanced_bridge():
    """Arms 1 : 2 and 2 : 4 leave the bridge without flow, and share 2 : 1."""
    lines = {"a": cable("in", "p", 1.0), "b": cable("p", "out", 2.0), "bridge": cable("p", "q", 0.1, 0.7)}
    lines |= {"c": cable("in", "q", 2.0), "d": cable("q", "out", 4.0)}
    found = steady(lines, sources={"s": source("in", "current", 3.0)}, loads=resistors(out=1.0))
    check(found, a=(3, 2), b=(3, 2), c=(3, 1), d=(3, 1), bridge=(3, 0))


def test_an_unbalanced_bridge():
    """Mesh equations for arms 1, 1, 1, 2 and bridge 1 (z0·T) by hand: potentials in elevenths."""
    lines = {"a": cable("in", "p"), "b": cable("p", "out"), "bridge": cable("p", "q")}
    lines |= {"c": cable("in", "q"), "d": cable("q", "out", 2.0)}
    # potentials with out = 0: p: (p-i) + p + (p-q) = 0, q: (q-i) + q/2 + (q-p) = 0, in: (i-p) + (i-q) = 1
    matrix = [[3, -1, -1], [-1, Fraction(5, 2), -1], [-1, -1, 2]]
    p, q, i = Fraction(7, 11), Fraction(8, 11), Fraction(13, 11)
    assert [row[0] * p + row[1] * q + row[2] * i for row in matrix] == [0, 0, 1]
    found = steady(lines, sources={"s": source("in", "current", 1.0)}, loads=resistors(out=2.0))
    check(found, a=(2, i - p), b=(2, p), c=(2, i - q), d=(2, q / 2), bridge=(2, p - q))


def test_a_flow_into_parallel_branches():
    """3 A into 1, 1/2 and 1/3 ohm: half a volt."""
    lines = {"a": cable("in", "x", 5.0), "b": cable("in", "y", 0.2), "c": cable("z", "in")}
    found = steady(lines, sources={"s": source("in", "current", 3.0)}, loads=resistors(x=1.0, y=1 / 2, z=1 / 3))
    check(found, a=(0.5, 0.5), b=(0.5, 1), c=(0.5, -1.5))


def test_two_reservoirs_of_one_pressure_share_inversely_to_inertia():
    lines = {"a": cable("t1", "m", 1.0, 2.0), "b": cable("t2", "m", 1.0, 4.0)}
    tanks = {f"t{k}": {"at": f"t{k}", "kind": "reservoir", "pressure": 9.0} for k in (1, 2)}
    found = steady(lines, "hydraulic", loads=tanks | resistors(m=3.0))
    check(found, a=(9, 2), b=(9, 1))


def test_inductors_are_shorts_and_share_with_the_lines_by_inertia():
    """Line 1 with L = 2, line 2 with L = 5 behind: 3 A divide as 1/3 to 1/6."""
    lines = {"a": cable("in", "x"), "b": cable("in", "y")}
    coils = {n: {"at": n, "kind": "series", "inductance": L} for n, L in (("x", 2.0), ("y", 5.0))}
    found = steady(lines, sources={"s": source("in", "current", 3.0)}, loads=coils)
    check(found, a=(0, 2), b=(0, 1))
    driven = {"s": source("in", "voltage", 3.0, 1.0)}
    check(steady(lines, sources=driven, loads=coils), a=(0, 2), b=(0, 1))
    mixed = {"x": coils["x"] | {"kind": "parallel", "capacitance": 1.0, "resistance": 7.0}}  # the inductor shorts them
    check(steady({"a": lines["a"]}, sources=driven, loads=mixed), a=(0, 3))


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "parallel", "capacitance": 1.0},
        {"kind": "series", "capacitance": 1.0, "resistance": 2.0},
        {"kind": "series", "capacitance": 1.0, "inductance": 3.0},
        {"kind": "impedance", "expression": "1/(s^2 + s)"},
        {"kind": "open"},
        {"kind": "switch", "before": float("inf"), "after": 0, "time": 5},
    ],
)
def test_what_lets_nothing_pass(load):
    found = steady(
        {"a": cable("in", "x")}, sources={"s": source("in", "voltage", 3.0, 2.0)}, loads={"x": load | {"at": "x"}}
    )
    check(found, a=(3, 0))


def test_what_a_load_lets_pass_at_rest_is_its_resistance():
    loads = {
        "rl": {"at": "x", "kind": "series", "resistance": 3.0, "inductance": 1.0},
        "rc": {"at": "x", "kind": "parallel", "resistance": 6.0, "capacitance": 1.0},
        "z": {"at": "x", "kind": "impedance", "expression": "(2 + s)/(1 + 3*s)"},
        "m": {"at": "y", "kind": "matched"},
    }  # 3, 6 and 2 in parallel are 1; with the matched end of z0 = 1 they are 1/2
    found = steady(
        {"a": cable("in", "x"), "b": cable("x", "y")}, sources={"s": source("in", "current", 4.0)}, loads=loads
    )
    check(found, a=(2, 4), b=(2, 2))


def test_components_do_not_know_each_other():
    lines = {"a": cable("a1", "a2"), "b": cable("b1", "b2"), "c": cable("c1", "c2"), "d": cable("d1", "d2")}
    sources = {"a": source("a1", "voltage", 2.0), "b": source("b2", "current", 3.0), "d": source("d1", "voltage", 5.0)}
    found = steady(lines, sources=sources, loads=resistors(a2=4.0, b1=2.0, c1=1.0))
    check(found, a=(2, 0.5), b=(6, -3), c=(0, 0), d=(5, 0))


def test_lines_that_end_where_they_begin_rest():
    lines = {"a": cable("in", "x"), "loop": cable("x", "x", 3.0), "b": cable("y", "x"), "c": cable("y", "x")}
    found = steady(lines, sources={"s": source("in", "voltage", 2.0, 1.0)}, loads=resistors(x=1.0))
    check(found, a=(1, 1), loop=(1, 0), b=(1, 0), c=(1, 0))


def test_flows_that_balance_need_no_load():
    sources = {"in": source("a", "current", 2.0), "out": source("b", "current", -2.0)}
    check(steady({"l": cable("a", "b")}, sources=sources), l=(0, 2))


COIL = {"at": "b", "kind": "series", "inductance": 1}
SHORT = {"at": "b", "kind": "short"}
ACTIVE = {n: {"at": n, "kind": "impedance", "expression": z} for n, z in (("a", "s"), ("b", "-2*s"))}
TORN = "no steady state: lossless lines join different ideal efforts, got "


@pytest.mark.parametrize(
    ("medium", "sources", "loads", "message"),
    [
        (
            "hydraulic",
            {},
            {n: {"at": n, "kind": "reservoir", "pressure": p} for n, p in (("a", "2 bar"), ("b", "3 bar"))},
            f"nodes 'a' and 'b': {TORN}200000 and 300000 Pa",
        ),
        ("electrical", {"s": source("a", "voltage", 2)}, {"l": COIL}, f"nodes 'b' and 'a': {TORN}0 and 2 V"),
        ("electrical", {"s": source("a", "voltage", 2)}, {"l": SHORT}, f"nodes 'b' and 'a': {TORN}0 and 2 V"),
        (
            "electrical",
            {"s": source("b", "current", 2)},
            {},
            "sources.s: no steady state: nothing takes the flow, expected a load that does, got 2 A",
        ),
        ("electrical", {}, ACTIVE, "start: no steady state: active loads cancel the inertia of lines, expected 'rest'"),
    ],
)
def test_where_there_is_none(medium, sources, loads, message):
    with pytest.raises(InputError) as caught:
        steady({"l": cable("a", "b", 1.0, 1.0)}, medium, sources=sources, loads=loads)
    assert str(caught.value) == message


def test_a_load_without_inertia_at_rest():
    """Z = s² is a short to steady flow, and takes what comes."""
    load = {"at": "b", "kind": "impedance", "expression": "s^2"}
    check(steady({"l": cable("a", "b")}, sources={"s": source("a", "current", 2.0)}, loads={"l": load}), l=(0, 2))


def test_a_slow_rise_from_rest_leads_there():
    """Loop, coils and a tree, raised over 2,000 transits; what a ramp leaves behind falls with its slope."""
    lines = {
        "a": cable("in", "p", 1.0, 1.0),
        "b": cable("p", "q", 2.0, 0.75),
        "c": cable("q", "p", 0.7, 1.25),
        "d": cable("q", "x", 1.0, 0.5),
    }
    loads = resistors(p=2.0, q=3.0) | {"coil": {"at": "x", "kind": "series", "resistance": 1.5, "inductance": 4.0}}
    parts = {"medium": "electrical", "lines": lines, "loads": loads, "probes": {"p": {"at": "in"}}}
    ramp = {"shape": "ramp", "to": 5.0, "duration": 2000.0}
    solver = {"order": 3, "slab": 0.25}
    risen = Scene(**parts, t_end=4000.0, solver=solver, sources={"s": source("in", "voltage", ramp, 0.5)})
    result = simulate(risen, record=lines)
    found = steady(lines, loads=loads, sources={"s": source("in", "voltage", 5.0, 0.5)})
    for name, (u, y) in found.items():
        a, b = (wave.values[-1, -1] for wave in (result.lines[name].a1, result.lines[name].b1))
        assert ((a + b) / 2, (a - b) / (2 * lines[name]["z0"])) == pytest.approx((u, y), abs=1e-9), name


SLABS = 10_000
# per slab a wave is rounded a few times; flows that go round in loops and coils are not damped, so all may add up
DRIFT = 1e-15 * SLABS


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    order=st.integers(1, 8),
    slab=st.one_of(st.sampled_from([1 / 8, 1 / 16]), st.floats(0.05, 0.45)),
    whole=st.booleans(),
)
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # loads faster than the slab
def test_where_nothing_is_operated_nothing_changes(seed, order, slab, whole):
    rng = np.random.default_rng(seed)
    data = random_scene(seed, switches=False).table()
    if whole:
        for line in data["lines"].values():
            line["delay"] = max(round(line["delay"] / slab), 1) * slab
    first, *_, last = sorted({node for line in data["lines"].values() for node in line["nodes"]})
    data["sources"] = {
        "v": source(first, "voltage", 1.0, float(10 ** rng.uniform(-1, 1))),
        "i": source(last, "current", float(rng.normal())),
    }
    loads = data.setdefault("loads", {})
    before = float(10 ** rng.uniform(-1, 1))
    loads["switch"] = {"at": last, "kind": "switch", "before": before, "after": 0.5, "time": 1e9}
    scene = Scene(**data | {"start": "steady", "t_end": SLABS * slab, "solver": {"order": order, "slab": slab}})
    lines = simulate(scene, record=scene.lines).lines.values()
    waves = [wave for line in lines for wave in (line.a1, line.b1, line.a2, line.b2)]
    largest = max(1.0, *(abs(wave.before) for wave in waves))  # the source has 1 V
    assert max(np.abs(wave.values - wave.before).max() for wave in waves) < DRIFT * largest


def test_pipes_with_friction_in_which_nothing_flows_yet():
    """Rounding leaves flows of 1e-16 m³/s, which nothing has to take."""
    pipe = {"length": "1 km", "diameter": "0.5 m", "wave_speed": "1 km/s", "density": 1000}
    rough = pipe | {"friction": {"kind": "darcy", "factor": 0.02}}
    ends = {"a": ["t", "m"], "b": ["m", "n"], "c": ["n", "t"], "d": ["n", "e"]}
    scene = Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={name: rough | {"nodes": nodes} for name, nodes in ends.items()},
        loads={"t": {"at": "t", "kind": "reservoir", "pressure": "5 bar"}},
        sources={"s": {"at": "e", "kind": "flow", "value": {"shape": "ramp", "to": -0.1, "duration": 1}}},
        probes={"p": {"at": "e"}},
    )
    effort, flows = steady_state(describe(scene))
    assert list(effort.values()) == pytest.approx([5e5] * 4, rel=1e-12)
    assert np.abs(flows).max() < 1e-7  # what a fall of pressure within rounding carries
