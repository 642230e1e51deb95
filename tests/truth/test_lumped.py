"""Runs with lumped short lines, against the inverse Laplace transform of what the lines truly do."""

import numpy as np
import pytest
from talbot import original

from tline import Scene, simulate

TOLERANCES = (1e-3, 1e-5, 1e-6, 1e-8)
NS = 1e-9
# what drives the scene, and its transform with time in ns
SOURCES = {
    "smooth": ({"shape": "exponential", "to": 1, "time_constant": "0.4 ns"}, [(0.0, lambda s: 1 / s - 1 / (s + 2.5))]),
    "ramp": ({"shape": "ramp", "to": 1, "duration": "0.5 ns"}, [(0.0, lambda s: 2 / s**2), (0.5, lambda s: -2 / s**2)]),
    "step": ({"shape": "step", "to": 1}, [(0.0, lambda s: 1 / s)]),
}


def scene(short: dict, value: dict, *, end: str, resistance: float, load: float) -> Scene:
    lines = {"line": {"nodes": ["in", "mid"], "z0": 50, "delay": "1 ns"}} | short
    return Scene(
        medium="electrical",
        t_end="10 ns",
        lines=lines,
        sources={"s": {"at": "in", "kind": "voltage", "value": value, "resistance": resistance}},
        loads={"r": {"at": end, "kind": "resistor", "resistance": load}},
        probes={"p": {"at": end, "line": "line" if end == "mid" else "on"}},
    )


def stub(value: dict, delay: str = "0.1 ps") -> Scene:
    """A dangling end beside the load."""
    short = {"stub": {"nodes": ["mid", "open"], "z0": 70, "delay": delay}}
    return scene(short, value, end="mid", resistance=20, load=75)


def at_stub(parts: list, delay: float, t: float) -> float:
    """Effort beside the stub at t, in ns: the sum over the round trips on the line."""

    def reflection(s):
        y = 50 / 75 + np.tanh(s * delay) * 50 / 70
        return (1 - y) / (1 + y)

    total, back = 0.0, (20 - 50) / (20 + 50)
    for begin, transform in parts:
        for k in range(5):
            late = t - begin - 1 - 2 * k
            if late > 0:
                total += original(
                    lambda s, k=k, transform=transform: (
                        transform(s) * 50 / 70 * (1 + reflection(s)) * (back * reflection(s)) ** k
                    ),
                    late,
                )
    return total


def jumper(value: dict, delay: str = "0.1 ps") -> Scene:
    """A piece of another impedance between two lines, matched at both ends."""
    short = {
        "jumper": {"nodes": ["mid", "next"], "z0": 120, "delay": delay},
        "on": {"nodes": ["next", "end"], "z0": 75, "delay": "1.5 ns"},
    }
    return scene(short, value, end="end", resistance=50, load=75)


def behind_jumper(made: Scene, t: np.ndarray) -> np.ndarray:
    """Effort at the far end: every wave that has run to and fro in the jumper k times."""
    lines, source = made.lines, made.sources["s"].value
    before, inside, behind = (lines[name].parameters.z0 for name in ("line", "jumper", "on"))
    passed = 2 * inside / (before + inside) * 2 * behind / (inside + behind)
    back = (before - inside) / (before + inside) * (behind - inside) / (behind + inside)
    total = np.zeros_like(t)
    for k in range(40):
        late = t - sum(line.parameters.delay for line in lines.values()) - 2 * k * lines["jumper"].parameters.delay
        total += passed * back**k * np.where(late > 1e-15 * NS, source.value(late, late - 1e-9 * NS), 0.0) / 2
    return total


def off(made: Scene, result, parts) -> float:
    """Largest error at slab ends, at some forty where that takes a transform, relative to the largest effort."""
    probe = result.probes["p"]
    t, u = probe.t, probe.u
    if "jumper" in made.lines:
        expected = behind_jumper(made, t)
    else:
        chosen = np.unique(np.linspace(0, len(t) - 1, 40).astype(int))
        delay = made.lines["stub"].parameters.delay / NS
        t, u = t[chosen], u[chosen]
        expected = np.array([at_stub(parts, delay, instant) for instant in t / NS])
    return float(np.abs(u - expected).max() / np.abs(u).max())


CASES = {"stub": stub, "jumper": jumper}


@pytest.mark.parametrize("tol", TOLERANCES)
@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("case", CASES)
def test_a_short_line_costs_little_and_the_tolerance_holds(case, source, tol):
    """At most three times the line-end samples of the scene without it, as was asked."""
    value, parts = SOURCES[source]
    made = CASES[case](value)
    result = simulate(made, tol=tol)
    assert result.accuracy.met
    assert set(result.resolution.sections) == {case}
    assert any(f"'{case}'" in note and "lumped" in note for note in result.notes)
    assert off(made, result, parts) <= 3 * tol
    without = simulate(scene_without(made), tol=tol)
    cost, plain = (sum(run.samples for run in r.accuracy.attempts) for r in (result, without))
    assert cost <= 3 * plain


@pytest.mark.parametrize("tol", TOLERANCES)
@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("delay", ["1 ps", "4 ps", "20 ps"])
def test_longer_ones_get_more_sections_or_stay_lines(delay, source, tol):
    value, parts = SOURCES[source]
    made = jumper(value, delay)
    result = simulate(made, tol=tol)
    assert result.accuracy.met
    assert off(made, result, parts) <= 3 * tol


def scene_without(made: Scene) -> Scene:
    """The same scene without its shortest line, whose nodes become one."""
    table = made.table()
    name = min(made.lines, key=lambda n: made.lines[n].parameters.delay)
    one, other = table["lines"].pop(name)["nodes"]
    for line in table["lines"].values():
        line["nodes"] = [one if node == other else node for node in line["nodes"]]
    return Scene(**table)


def test_a_short_line_among_very_long_ones():
    """1 cm between pipes of 1 km: as pipes of their own they would need 10⁵ times the samples."""
    pipe = {"radius": "10 cm", "wave_speed": 1000, "density": 1000}
    scene = Scene(
        medium="hydraulic",
        t_end="20 s",
        lines={
            "one": {"nodes": ["tank", "a"], "length": "1 km"} | pipe,
            "jumper": {"nodes": ["a", "b"], "length": "1 cm"} | pipe,
            "two": {"nodes": ["b", "valve"], "length": "1.3 km"} | pipe,
        },
        sources={"tank": {"at": "tank", "kind": "pressure", "value": "3 bar"}},
        loads={"valve": {"at": "valve", "kind": "resistor", "resistance": "2e7 Pa s/m^3"}},
        probes={"valve": {"at": "valve"}},
    )
    result = simulate(scene)
    assert result.accuracy.met
    assert set(result.resolution.sections) == {"jumper"}
    plain = simulate(scene_without(scene))
    cost, least = (sum(run.samples for run in r.accuracy.attempts) for r in (result, plain))
    assert cost <= 3 * least


def test_what_rings_on_stays_a_line():
    """A dead end behind a line that nothing damps: a front runs to and fro in it for ever."""
    value = {"shape": "step", "to": 1}
    lines = {
        "line": {"nodes": ["in", "out"], "z0": 50, "delay": "1 ns"},
        "closed": {"nodes": ["far", "end"], "z0": 50, "delay": "10 ps"},
    }
    scene = Scene(
        medium="electrical",
        t_end="5 ns",
        lines=lines,
        sources={
            "s": {"at": "in", "kind": "voltage", "value": value, "resistance": 20},
            "t": {"at": "far", "kind": "voltage", "value": value},
        },
        probes={"p": {"at": "out"}},
    )
    assert not simulate(scene).resolution.sections


def test_steady_flow_goes_on_through_a_lumped_line():
    """Nothing moves in a steady state, through inductors neither; a slab's 200 delays of it multiply the rounding."""
    made = jumper({"shape": "constant", "level": 1})
    result = simulate(Scene(**made.table() | {"start": "steady"}))
    assert result.resolution.sections
    assert np.abs(result.probes["p"].u - 75 / 125).max() < 1e-12
    assert np.abs(result.probes["p"].y - 1 / 125).max() < 1e-12 / 75
