"""A network of ten thousand pipes: when a wave arrives at a node, how high it is, and that nothing else moves."""

import runpy
from math import comb
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from tline import Scene, simulate

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
