"""Errors fall at the order the method declares: at slab ends, between them, and with elements between lines."""

from fractions import Fraction
from math import exp, pi, sqrt

import numpy as np
import pytest
from bounces import COILS, SERIES, closed_form, scene_of
from curve_cases import LOSSLESS, Case
from electrical_by_hand import behind
from method_of_steps import Line, integrate
from one_line import from_tank

from tline import Scene, simulate
from tline.scene.waveform import Shape
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.loop.march import march
from tline.solver.run import run
from tline.study.reference.exact import Solution
from tline.study.reference.network import ReferenceNetwork
from tline.study.reference.rays import Scatterer, rays

DELAYS = {"a": 1.0, "b": sqrt(2), "c": pi / 2}
TOPOLOGIES = {
    "Y": {"a": ("in", "mid"), "b": ("mid", "p"), "c": ("mid", "q")},
    "loop": {"a": ("in", "p"), "b": ("p", "q"), "c": ("q", "p")},
}
Z0 = {"a": 1.0, "b": 2.0, "c": 0.5}


class Bell(Shape):
    """A pulse with nine continuous derivatives, so that no front limits the order."""

    def breaks(self, t_end):
        return np.array([0.0, 1.5])

    def value(self, t, inside):
        return np.where((inside > 0) & (inside < 1.5), np.sin(np.pi * t / 1.5) ** 10, 0.0)


def network(lines, order, slab, t_end):
    return Scene(
        medium="electrical",
        t_end=t_end,
        solver={"order": order, "slab": slab},
        lines={k: {"nodes": nodes, "z0": Z0[k], "delay": DELAYS[k]} for k, nodes in lines.items()},
        sources={"s": {"at": "in", "kind": "voltage", "resistance": 0.5, "value": 1}},
        loads={"p": {"at": "p", "kind": "resistor", "resistance": 3}},
        probes={"q": {"at": "q", "line": "c"}},
    )


def efforts_at_q(lines, order, slab, t_end):
    """Effort at slab ends."""
    assembly = assemble(describe(network(lines, order, slab, t_end)), {"c"})
    assembly.excitations[0] = [(Bell(), share) for _, share in assembly.excitations[0]]
    record, _ = march(assembly, round(t_end / slab))
    side = lines["c"].index("q")
    return record[assembly.recorded["c"] + side].mean(axis=0).reshape(-1, order)[:, -1]


def paths_to_q(lines, t_end):
    """Delay of every path from the source to q, and the effort there per effort of the source."""
    exact, side = ReferenceNetwork(network(lines, 1, 1.0, t_end)), lines["c"].index("q")
    scatterers = {name: Scatterer(name, junction, exact.z0) for name, junction in exact.junctions.items()}
    leaving = rays(exact, scatterers, "in", Fraction(t_end), line=2)
    for wave, way in zip(leaving, (side, 1 - side), strict=True):
        for passed, ray in wave.items():
            yield float(passed + way * exact.delay[2]), float(ray.direct.real.mid())


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("order", range(2, 7))
def test_smooth_waves_on_lines_without_common_measure(topology, order):
    """Slope of the largest error against the exact lattice, which adds up every path a wave can take."""
    lines, t_end = TOPOLOGIES[topology], 6.0
    instants = np.linspace(2.25, t_end, 16)
    expected = sum(gain * Bell().value(instants - late, instants - late) for late, gain in paths_to_q(lines, t_end))
    counts = {2: 4, 3: 2}.get(order, 1) * np.array([16, 20, 24, 32, 40, 48, 64, 80, 96])  # many fractional rests
    errors = []
    for n in counts:
        u = efforts_at_q(lines, order, 1.0 / n, t_end)
        errors.append(np.abs(u[np.round(instants * n).astype(int) - 1] - expected).max())
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope >= order - 0.3, (slope, errors)


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
@pytest.mark.parametrize("order", range(1, 6))
def test_loads_reach_the_order_of_radau_at_slab_ends(order):
    """Aligned delays leave only Radau IIA: order 2s - 1; a step charges a capacitor through a matched line."""
    rates, errors = [], []
    for n in {1: (64, 128, 256), 2: (16, 32, 64), 3: (8, 16, 32), 4: (4, 8, 16), 5: (2, 4, 8)}[order]:
        scene = Scene(
            medium="electrical",
            t_end=3,
            solver={"order": order, "slab": 1.0 / n},
            lines={"line": {"nodes": ["in", "out"], "z0": 1, "delay": 1}},
            sources={"s": {"at": "in", "kind": "voltage", "resistance": 1, "value": {"shape": "step", "to": 1}}},
            loads={"c": {"at": "out", "kind": "parallel", "capacitance": 0.5}},
            probes={"out": {"at": "out"}},
        )
        u = simulate(scene).probes["out"].u
        errors.append(max(abs(u[k] - (1 - exp(-2 * (k / n - 1)))) for k in range(n + 1, 3 * n)))
        rates.append(1.0 / n)
    slope = np.polyfit(np.log(rates), np.log(errors), 1)[0]
    assert slope >= 2 * order - 1 - 0.3, (slope, errors)


SLABS = {2: (16, 32, 64), 3: (8, 16, 32), 4: (6, 12, 24), 5: (5, 8, 12)}  # in a delay


def charged(value) -> Scene:
    """A capacitor and a resistor at the end of a line."""
    return Scene(
        medium="electrical",
        t_end=6,
        lines={"line": {"nodes": ["in", "out"], "z0": 1, "delay": 1}},
        sources={"s": {"at": "in", "kind": "voltage", "resistance": 0.4, "value": value}},
        loads={"c": {"at": "out", "kind": "parallel", "resistance": 3, "capacitance": 0.5}},
        probes={"out": {"at": "out"}},
    )


def errors(scene: Scene, order: int, slab: float, seen, own: bool) -> float:
    """Largest one of the effort at random instants; of slabs' own polynomials, or of what is made of them."""
    probe = run(describe(scene), Resolution(order, slab)).probes["out"]
    t, exact = seen
    a, b = (probe.record.a2, probe.record.b2) if own else probe.waves
    return float(np.abs((a(t) + b(t)) / 2 - exact).max())


@pytest.mark.parametrize("shape", ["sine", "step"])
@pytest.mark.parametrize("order", SLABS)
def test_inside_slabs_errors_fall_faster_than_their_polynomials_let_them(order, shape):
    """Of order s + 2, but no better than slab ends; behind a step, where a slab has no start, of order s + 1."""
    sine = {"shape": "sine", "amplitude": 1, "frequency": 0.3}
    scene, expected = charged(sine), min(order + 2, 2 * order - 1)
    if shape == "step":
        scene, expected = charged({"shape": "step", "to": 1}), order + 1
    t = np.sort(np.random.default_rng(1).uniform(0, 6, 1500))
    seen = t, Solution(scene, "out").at(t.tolist(), 15).efforts
    own, made = ([errors(scene, order, 1 / n, seen, which) for n in SLABS[order]] for which in (True, False))
    widths = np.log([1 / n for n in SLABS[order]])
    slopes = [np.polyfit(widths, np.log(each), 1)[0] for each in (own, made)]
    assert slopes[0] < order + 0.5, (slopes, own)
    assert slopes[1] > expected - 0.5, (slopes, made)
    assert made[-1] < own[-1] / 30, (own, made)


@pytest.mark.parametrize("kind", [kind for kind in LOSSLESS if kind not in ("ratio", "switch")])
@pytest.mark.parametrize("order", [2, 4])
def test_nothing_gets_worse_across_fronts(kind, order):
    """Jumps, corners and kinks of laws at slabs' edges and inside, on slabs as narrow as some reflections are apart."""
    case: Case = LOSSLESS[kind](np.random.default_rng(5))
    result = run(
        describe(case.scene), Resolution(order, min(x.parameters.delay for x in case.scene.lines.values()) / 8)
    )
    t = np.sort(np.random.default_rng(2).uniform(0, float(result.t[-1]), 400))
    for name in ("near", "far"):
        probe = result.probes[name]
        exact, record = case.exact(name, t)[0], probe.record
        pairs = (record.a1, record.b1) if probe.share == 0 else (record.a2, record.b2), probe.waves
        own, made = (np.abs((a(t) + b(t)) / 2 - exact).max() for a, b in pairs)
        assert made <= 1.1 * own + 1e-13


def test_the_case_above_is_what_scipy_makes_of_its_equation():
    def circuit(t, x, w, mode):
        return np.array([(w[1] - x[0] - x[0] / 3) / 0.5]), np.array(
            [behind(1.0 if t > 0 else 0.0, 0.4, w[0], 1.0), x[0]]
        )

    motion = integrate(circuit, [Line(1.0, 1.0)], 6.0, scale=[1.0])
    t = np.linspace(0.05, 5.95, 60)
    u, _ = motion.probe(1, t)
    exact = Solution(charged({"shape": "step", "to": 1}), "out").at(t.tolist(), 15).efforts
    assert np.abs(u - exact).max() < 1e-11


SWING = {"shape": "sine", "amplitude": 0.2, "frequency": 0.7, "offset": 0.7, "phase": "90 deg"}


def efforts(order: int, slab: float, loads: dict) -> np.ndarray:
    out = {"out": {"at": "end", "kind": "flow", "value": SWING | {"amplitude": 0.01, "offset": -0.02}}}
    solver = {"order": order, "slab": slab}
    probe = simulate(from_tank(3.2, {"z0": 2e7, "delay": 0.1173}, 6e5, loads, sources=out, solver=solver)).probes["end"]
    return probe.u[:: round(0.1 / slab)]


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize(
    "loads",
    [
        {"valve": {"at": "end", "kind": "orifice", "kv": 90, "opening": SWING}},
        {"vessel": {"at": "end", "kind": "air vessel", "gas_volume": "20 L", "gas_pressure": 6e5}},
    ],
    ids=["valve", "vessel"],
)
def test_the_error_falls_at_the_declared_order(order, loads):
    exact = efforts(10, 0.0125, loads)
    slabs = np.array([0.05, 0.025, 0.0125])
    errors = [np.abs(efforts(order, slab, loads) - exact).max() for slab in slabs]
    assert np.polyfit(np.log(slabs), np.log(errors), 1)[0] > order - 0.2


ELEMENT_SLABS = np.array([0.125, 0.0625, 0.03125])
INSTANTS = np.arange(0.5, 10, 0.5)[3::2]  # halfway between echoes


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("link", [SERIES, COILS], ids=["series RLC", "coupled coils"])
def test_the_error_falls_at_twice_the_order_less_one(link, order):
    exact = closed_form(link, INSTANTS)
    errors = []
    for slab in ELEMENT_SLABS:
        probes = simulate(scene_of(link, order, slab)).probes
        ends = np.round(INSTANTS / slab).astype(int)
        assert np.abs(probes["far"].t[ends] - INSTANTS).max() < 1e-12
        errors.append(
            max(np.abs(probes[name].u[ends] - u).max() for name, u in zip(("near", "far"), exact, strict=True))
        )
    assert np.polyfit(np.log(ELEMENT_SLABS), np.log(errors), 1)[0] > 2 * order - 1.3
