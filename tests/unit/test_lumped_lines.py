"""Lumped lines: their state space, the steady state in it, and which lines may be lumped."""

import numpy as np
import pytest

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import short_lines

LONG = {"z0": 50, "delay": "1 ns"}
SHORT = {"z0": 70, "delay": "0.1 ps"}
DRIVE = {"s": {"at": "a", "kind": "voltage", "value": 1, "resistance": 20}}
LOAD = {"r": {"at": "d", "kind": "parallel", "resistance": 60, "capacitance": "1 pF"}}
RESISTOR = {"r": {"at": "d", "kind": "resistor", "resistance": 60}}


def scene(**parts) -> Scene:
    """A line, two short ones behind it, and a second line beside the first of these."""
    whole = {
        "medium": "electrical",
        "t_end": "10 ns",
        "lines": {
            "one": {"nodes": ["a", "b"], **LONG},
            "two": {"nodes": ["b", "e"], "z0": 80, "delay": "1.25 ns"},
            "x": {"nodes": ["b", "c"], **SHORT},
            "y": {"nodes": ["d", "c"], "z0": 30, "delay": "0.1 fs"},
        },
        "sources": DRIVE,
        "loads": LOAD,
        "probes": {"p": {"at": "a"}},
    }
    return Scene(**whole | parts)


def group_of(made: Scene, sections: dict[str, int]):
    groups, nodes = describe(made).grouped(sections)
    (group,) = (group for group in groups if group.lumped_lines)
    return group, [name for name, node in nodes.items() if any(node is one for one in group.nodes)]


def ladder(line, n: int, s: complex) -> np.ndarray:
    """Admittance matrix of n LC sections, from their chain matrix."""
    L, C = line.z0 * line.delay / n, line.delay / line.z0 / n
    half, coil = np.array([[1, 0], [s * C / 2, 1]]), np.array([[1, s * L], [0, 1]])
    (a, b), (_, d) = np.linalg.matrix_power(half @ coil @ half, n)
    return np.array([[d, -1], [-1, a]]) / b


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("s", [2e12 + 1e12j, -1e11 + 4e12j, 1e11])
def test_a_group_is_its_nodal_equations(n, s):
    """With G the conductances to the waves and Y the admittances: (G + Y) u = G w; node c conducts to nothing else."""
    made, sections = scene(), {"x": n, "y": 2 * n}
    group, names = group_of(made, sections)
    Y = np.zeros((3, 3), complex)
    for name in sections:
        at = [names.index(node) for node in made.lines[name].nodes]
        Y[np.ix_(at, at)] += ladder(made.lines[name].parameters, sections[name], s)
    G = np.diag([{"b": 1 / 50 + 1 / 80, "c": 0.0, "d": 0.0}[name] for name in names])
    Y[names.index("d"), names.index("d")] += 1 / 60 + s * 1e-12
    waves = np.diag([0.0 if node.dead else node.total for node in group.nodes])  # nothing drives the others
    A, B, C, D = group.circuit(0.0).system
    found = C @ np.linalg.solve(s * np.eye(len(A)) - A, B) + D
    assert np.abs(found - np.linalg.solve(G + Y, waves)).max() < 1e-10 * np.abs(found).max()


def test_sections_approach_the_line_with_the_square_of_their_number():
    line, s = scene().lines["x"].parameters, 2e12 + 3e12j
    theta = s * line.delay
    exact = np.array([[np.cosh(theta), -1], [-1, np.cosh(theta)]]) / np.sinh(theta) / line.z0
    errors = [np.abs(ladder(line, n, s) - exact).max() for n in (2, 4, 8, 16)]
    assert np.log2(errors[-2] / errors[-1]) == pytest.approx(2, abs=0.01)


def test_a_group_at_rest_stays_there():
    made, sections = scene(), {"x": 2, "y": 1}
    groups, nodes = describe(made).grouped(sections, {"x": 0.0125, "y": -0.0125})
    (group,) = (group for group in groups if group.lumped_lines)
    waves = {"b": 0.75 + 0.0125 / (1 / 50 + 1 / 80), "c": 0.0, "d": 0.0}
    w = np.array([waves[name] for name in nodes if name in waves])
    x = group.at_rest_under(waves, dict.fromkeys(waves, 0.75), {})
    A, B, C, D = group.circuit(0.0).system
    assert np.abs(A @ x + B @ w).max() < 1e-12 * np.abs(A).max()
    assert C @ x + D @ w == pytest.approx(np.full(3, 0.75), rel=1e-12)


@pytest.mark.parametrize(
    ("parts", "lumped"),
    [
        ({}, ["x", "y"]),
        ({"probes": {"p": {"at": "a"}, "q": {"line": "x", "position": "50 %"}}}, ["y"]),
        ({"probes": {"p": {"at": "d"}}}, []),  # the other would be the shorter one
        ({"loads": LOAD}, []),  # nothing damps y between two capacitors
        ({"t_end": "1 ps"}, ["y"]),
        ({"t_end": "10 fs"}, []),  # y would not settle in that time
        ({"solver": {"slab": "0.1 fs"}}, []),
        ({"loads": RESISTOR | {"s": {"at": "c", "kind": "switch", "before": 1, "after": 2, "time": "1 ns"}}}, []),
        ({"loads": RESISTOR | {"a": {"at": "b", "kind": "impedance", "expression": "-500"}}}, ["y"]),
    ],
)
def test_what_may_be_lumped(parts, lumped):
    assert short_lines(describe(scene(**{"loads": RESISTOR} | parts)), [])[0] == lumped


def test_recorded_lines_stay_lines():
    assert short_lines(describe(scene(loads=RESISTOR)), ["y"])[0] == []


def test_a_matched_end_of_a_short_line_keeps_its_resistance():
    made = scene(loads={"m": {"at": "d", "kind": "matched"}})
    assert describe(made).grouped({"x": 1, "y": 1})[1]["d"].conductance == 1 / 30
