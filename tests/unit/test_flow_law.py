"""Laws of friction and of valves by their travel, flows that balance; lumped lines and their state space."""

from itertools import pairwise
from math import log10, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tline import InputError, Scene
from tline.errors import SceneError
from tline.loss.flow_law import Colebrook, FlowLaw, PowerLaw, SwameeJain, quadratic, side_by_side
from tline.scene.file import read_scene
from tline.scene.heights import GRAVITY
from tline.scene.line import Pipe
from tline.scene.valve import ADDED, Orifice, open_loss, opening_of, shares
from tline.solver.assembly.diamonds import _power_table
from tline.solver.description.description import describe
from tline.solver.description.resolution import short_lines
from tline.solver.kernel.diamonds.full import bent, power
from tline.solver.steady import balance
from tline.solver.steady.steady_state import steady_state

LENGTH, DIAMETER, DENSITY = 1000.0, 0.3, 1000.0
PIPE = {"nodes": ["a", "b"], "length": LENGTH, "diameter": DIAMETER, "wave_speed": 1000, "density": DENSITY}
LAWS = [
    quadratic(3e4),
    PowerLaw(2e4, 0.0, 1.852),
    PowerLaw(2e4, 1e3, 1.852),
    Colebrook(3e4, 10.0, 4e6, 1e-3),
    SwameeJain(3e4, 10.0, 4e6, 1e-3),
]


def head(flow: float, **friction) -> float:
    line = Pipe.model_validate(PIPE | {"friction": friction})
    return line.steady_drop(flow)[0] / (DENSITY * GRAVITY)


def test_hazen_williams_manning_and_swamee_jain_by_their_formulas():
    """The usual forms in metres; EPANET's constant for feet rounds Hazen's and Williams' to 4 digits."""
    Q, d, L = 0.1, DIAMETER, LENGTH
    v = Q / (np.pi / 4 * d**2)
    assert head(Q, kind="hazen-williams", coefficient=100) == pytest.approx(
        10.67 * L * Q**1.852 / (100**1.852 * d**4.8704), rel=2e-3
    )
    assert head(Q, kind="manning", coefficient=0.013) == pytest.approx(
        0.013**2 * v**2 * L / (d / 4) ** (4 / 3), rel=1e-12
    )
    viscosity, rough = 1e-3, 1e-4
    f = 0.25 / log10(rough / d / 3.7 + 5.74 / (v * d * DENSITY / viscosity) ** 0.9) ** 2
    swamee = {"kind": "swamee-jain", "viscosity": viscosity, "roughness": rough}
    assert head(Q, **swamee) == pytest.approx(f * L / d * v**2 / (2 * GRAVITY), rel=1e-12)
    slow = 1e-5
    poiseuille = 128 * viscosity * L * slow / (np.pi * d**4) / (DENSITY * GRAVITY)
    assert head(slow, **swamee) == pytest.approx(poiseuille, rel=1e-12)


def test_local_losses_and_the_length_over_which_friction_acts():
    Q, v = 0.1, 0.1 / (np.pi / 4 * DIAMETER**2)
    for kind, coefficient in (("hazen-williams", 100), ("manning", 0.013)):
        alone = head(Q, kind=kind, coefficient=coefficient)
        both = head(Q, kind=kind, coefficient=coefficient, minor_loss=7, length=LENGTH / 4)
        assert both == pytest.approx(alone / 4 + 7 * v**2 / (2 * GRAVITY), rel=1e-12)


@pytest.mark.parametrize("bad", [{"coefficient": 0}, {"coefficient": -3}, {}, {"coefficient": 100, "minor_loss": -1}])
def test_mistakes(bad):
    from tline.scene.scene import Scene

    pipe = PIPE | {"friction": {"kind": "hazen-williams"} | bad}
    with pytest.raises(InputError, match=r"lines\.p\.friction"):
        Scene(medium="hydraulic", t_end=1, lines={"p": pipe})


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_slopes_are_those_of_the_drops(law: FlowLaw):
    flow = np.geomspace(1e-5, 10, 200)
    reynolds = 4e6 * flow
    flow = flow[np.abs(reynolds / 2040 - 1) > 0.05]
    step = 1e-4 * flow
    slope = (law(flow + step)[0] - law(flow - step)[0]) / (2 * step)
    smooth = np.abs(4e6 * flow / 2000 - 1) > 1e-3
    assert law(flow)[1][smooth] == pytest.approx(slope[smooth], rel=5e-3)


def test_laws_side_by_side_are_the_same():
    laws = [*LAWS, None, PowerLaw(5.0, 0.0, 1.7), Colebrook(1.0, 0.0, 1e5, 0.0)]
    flow = np.array(0.02)
    seen = {}
    for places, law in side_by_side(laws, np.arange(len(laws))):
        drop, slope = law(np.full(len(places), 0.02))
        seen |= dict(zip(places.tolist(), zip(drop, slope, strict=True), strict=True))
    assert seen.keys() == {k for k, law in enumerate(laws) if law is not None}
    for k, found in seen.items():
        assert found == pytest.approx([float(each) for each in laws[k](flow)], rel=1e-14)


@pytest.mark.parametrize("n", [0.852, 1.0, 1 / 3, 2.0])
def test_powers_by_table_are_those_of_the_library(n):
    table = np.append(np.zeros(3), _power_table(n))  # at a place of its own
    x = np.append(np.exp(np.random.default_rng(1).uniform(-60, 60, 300)), [1.0, 2.0, np.nextafter(2.0, 0), 0.5])
    found = np.array([power(table, 3, each) for each in x])
    assert np.abs(found / x**n - 1).max() < 2e-14  # of n ln x, rounded
    assert power(table, 3, 0.0) == 0.0


def test_how_far_a_tangent_holds():
    """Of y² by three times what it is off, and not at all from rest, where its slope tells nothing."""
    base, away = 2.0, 0.1
    off = (base + away) ** 2 - (base**2 + 2 * base * away)
    assert off < bent(2 * base, base + away, base) < 3 * off
    assert bent(0.0, 1e-9, 0.0) > 1e200
    assert bent(0.0, 0.0, 0.0) == 0.0


NONE = 1e-12  # Pa, m³/s: where nothing drives
SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ["town", "pump_trip", "valve_closure", "pipe_friction"])
@pytest.mark.parametrize("exact", [balance.EXACT, 0.0], ids=["by elimination", "at once"])
def test_large_networks_are_solved_like_small_ones(monkeypatch, name, exact):
    scene = read_scene(SCENES / f"{name}.toml")
    small, flows = steady_state(describe(scene))
    monkeypatch.setattr(balance, "MOST_DENSE", 0)
    monkeypatch.setattr(balance, "EXACT", exact)
    large, same = steady_state(describe(scene))
    assert large == pytest.approx(small, rel=1e-9, abs=1e-9 * max(small.values()) + NONE)
    assert same == pytest.approx(flows, abs=1e-9 * abs(flows).max() + NONE)


def test_a_pipe_between_reservoirs_follows_darcy(monkeypatch):
    """Δp = ρ f l/(2 d A²) Q², also where no effort is left to be found."""
    monkeypatch.setattr(balance, "MOST_DENSE", 0)
    pipe = {"nodes": ["high", "low"], "length": 100, "diameter": 0.2, "wave_speed": 1000, "density": 1000}
    scene = Scene(
        medium="hydraulic",
        t_end=1,
        start="steady",
        lines={"pipe": pipe | {"friction": {"kind": "darcy", "factor": 0.02}}},
        loads={
            "upper": {"at": "high", "kind": "reservoir", "pressure": 2e5},
            "lower": {"at": "low", "kind": "reservoir", "pressure": 1e5},
        },
        probes={"p": {"at": "low"}},
    )
    _, flows = steady_state(describe(scene))
    area = pi * 0.2**2 / 4
    assert flows[0] == pytest.approx(area * (1e5 * 2 * 0.2 / (1000 * 0.02 * 100)) ** 0.5)


def valve_of(**given: Any) -> Orifice:
    return Orifice(at="a", **given)


PERRY = [
    ("gate", 0.5, 4.5, 0.17),
    ("globe", 0.75, 13.0, 9.0),
    ("ball", 1 - 40 / 90, 17.3, 0.0),
    ("butterfly", 1 - 20 / 90, 1.54, 0.0),
]


@pytest.mark.parametrize(("kind", "x", "k", "k_open"), PERRY)
@pytest.mark.parametrize("k0", [0.01, 0.3, 9.0])
def test_a_valve_loses_what_the_handbook_says(kind, x, k, k_open, k0):
    valve = valve_of(loss_coefficient=k0, diameter=0.2, characteristic=kind, opening=x)
    share = _share(kind, valve.loss, x)
    assert valve.loss == pytest.approx(k0)
    assert k0 / share**2 == pytest.approx(k0 + k - k_open)


def _share(kind: str, loss: float, x: float) -> float:
    return next(share for opening, share in shares(kind, loss) if opening == pytest.approx(x))


@pytest.mark.parametrize("kind", ADDED)
def test_openings_and_shares_rise_together(kind):
    points = shares(kind, 0.2)
    assert list(points) == sorted(points)
    for x in (0.1, 0.3, 0.6, 0.95):
        (low, below), (high, above) = next(pair for pair in pairwise(points) if pair[1][0] >= x)
        share = below + (x - low) / (high - low) * (above - below)
        assert opening_of(points, share) == pytest.approx(x)
    assert open_loss(kind, 0.05) > open_loss(kind, 1.0) > 0


def test_the_capacity_may_be_given_in_any_way_beside_the_bore():
    by_kv = valve_of(kv=300, diameter=0.1, characteristic="gate")
    assert by_kv.capacity is not None
    by_loss = valve_of(loss_coefficient=by_kv.loss, area=pi / 4 * 0.01, characteristic="gate")
    assert by_loss.capacity == pytest.approx(by_kv.capacity)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"characteristic": "gait", "diameter": 1}, "characteristic: not a kind of valve, expected 'gate' or 'globe'"),
        ({"characteristic": "gate"}, "diameter: is missing, expected the bore of the gate valve"),
        ({"diameter": 1}, "its capacity is not given once"),
    ],
)
def test_mistakes_of_travels(given, said):
    with pytest.raises(SceneError, match=said):
        valve_of(kv=3, **given)


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
