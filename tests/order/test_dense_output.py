"""Between slab ends errors fall faster than slabs' own polynomials let them, and nowhere are they larger."""

import numpy as np
import pytest
from curve_cases import LOSSLESS, Case
from electrical_by_hand import behind
from method_of_steps import Line, integrate

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.reference.exact import Solution

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
