"""The error at slab ends falls at the order the method declares."""

from fractions import Fraction
from math import exp, pi, sqrt

import numpy as np
import pytest

from tline import Scene, simulate
from tline.scene.waveform import Shape
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.loop.march import march
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
