"""Laws and switches beside lines that remember, against BDF2's quadrature and inverse Laplace of a formula."""

import mpmath as mp
import numpy as np
import pytest
from lossy_scenes import cable
from memory_by_bdf2 import efforts_at_laws
from random_memory import judge, random_memory
from remembering_scenes import SCENES, two_clamps

from tline import Scene, simulate
from tline.scene.file import as_scene
from tline.solver.convolution.rays import arrivals
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution

SKIN, LENGTH, R0, L0, C0, THERMAL = 3e-4, 2.0, 1.0, 250e-9, 100e-12, 0.025864925786328753


def rest_of_two_clamps(s):
    """Z at both clamps, and efforts there without them per volt: 50 ohm, the line, 200 ohm and 2 pF."""
    series, shunt = np.sqrt(R0**2 + SKIN**2 * s) + s * L0, s * C0
    zc, passed = np.sqrt(series) / np.sqrt(shunt), np.exp(-np.sqrt(series) * np.sqrt(shunt) * LENGTH)
    Y = np.empty((len(s), 2, 2), complex)
    Y[:, 0, 0] = Y[:, 1, 1] = (1 + passed**2) / (1 - passed**2) / zc
    Y[:, 0, 1] = Y[:, 1, 0] = -2 * passed / (1 - passed**2) / zc
    Y[:, 0, 0] += 1 / 50
    Y[:, 1, 1] += 1 / 200 + s * 2e-12
    Z = np.linalg.inv(Y)
    return Z, Z[:, :, 0] / 50


def clamp(v):
    grown = 1e-12 * np.exp(np.minimum(v, 2.0) / THERMAL)
    return grown - 1e-12, grown / THERMAL


@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_two_clamps_at_a_cable_with_skin_effect(tol):
    """Allowed is what is told, and what two grids of BDF2 differ by."""
    t_end, n = 14e-9, 5600
    source = lambda t: 3.0 * np.clip(t / 2e-9, 0, 1)  # noqa: E731
    t, coarse = efforts_at_laws(rest_of_two_clamps, source, clamp, t_end, n)
    fine = efforts_at_laws(rest_of_two_clamps, source, clamp, t_end, 2 * n)[1][1::2]
    knows = np.abs(fine - coarse).max()
    result = simulate(two_clamps().with_changes(t_end=t_end), tol=tol)
    assert knows < 2e-3
    assert result.accuracy.met
    assert result.resolution.convolved
    for name, exact in zip(("near", "far"), fine.T, strict=True):
        u = result.probes[name].at(t).u
        assert np.abs(u - exact).max() < 3 * result.accuracy.inside[name].u * np.abs(exact).max() + knows


@pytest.mark.parametrize(("tol", "silent"), [(1e-4, False), (1e-6, False), (1e-4, True)])
def test_a_switch_that_closes_sends_a_step(tol, silent):
    """1 V behind a switch of 25 ohm, closed at 0.33 ns: what arrives once, by Talbot's contour.

    Another that opens at the far end before anything is there to be seen has both on edges of slabs.
    """
    skin = {"resistance": 60, "frequency": "10 GHz"}
    table = cable(t_end="3.2 ns", skin=skin).table()
    table["sources"] = {"s": {"at": "s", "kind": "voltage", "value": 1}}
    table["links"] = {"w": {"kind": "switch", "nodes": ["s", "a"], "before": "inf", "after": 25, "time": "0.33371 ns"}}
    if silent:
        table["loads"]["w"] = {"at": "b", "kind": "switch", "before": 50, "after": "inf", "time": "0.17171 ns"}
    result = simulate(table, tol=tol)
    k, L, C, length, delay = (
        mp.mpf(60) / mp.sqrt(mp.pi * 10**10),
        mp.mpf("250e-9"),
        mp.mpf("100e-12"),
        mp.mpf("0.2"),
        1e-9,
    )

    def once(s):
        series, shunt = s * L + k * mp.sqrt(s), s * C
        zc = mp.sqrt(series / shunt)
        late = mp.exp(-(mp.sqrt(series) * mp.sqrt(shunt) * length - s * delay))
        return 200 / (100 + zc) * zc / (zc + 25) * late / s

    behind = delay * np.array([0.0203, 0.0717, 0.31, 0.83, 1.37])
    with mp.workdps(30):
        exact = [float(mp.invertlaplace(once, mp.mpf(float(t)), method="talbot", degree=40)) for t in behind]
    assert result.slabs.number < 4000 * (1e-4 / tol)
    assert result.accuracy.met
    assert np.abs(result.probes["far"].at(0.33371e-9 + delay + behind).u - exact).max() < 2 * tol
    assert np.abs(result.probes["far"].at(np.array([0.5e-9, 1.3e-9])).u).max() < tol


@pytest.mark.parametrize(
    "name", ["stripline_with_ibis", "lightning_and_arrester", "breaker_beside_rg58", "tree_with_clamps"]
)
def test_what_is_told_is_no_less_than_a_third_of_the_difference_to_a_closer_run(name):
    rough, close = simulate(SCENES[name](), tol=1e-3), simulate(SCENES[name](), tol=5e-5)
    assert rough.accuracy.met
    t = np.sort(np.random.default_rng(1).uniform(0, float(close.scene.t_end), 2000))
    for probe in close.probes.values():
        u = probe.at(t).u
        off = np.abs(rough.probes[probe.name].at(t).u - u).max() / np.abs(u).max()
        assert off < 3 * max(rough.accuracy.inside[probe.name].u, 5e-5) + 1e-9


@pytest.mark.parametrize("corner", [0.30123, 0.57823, 0.76277])
def test_a_ramp_between_edges_of_slabs_beside_a_switch(corner):
    """What a matched source sees of a cable with skin effect before its far end answers, by Talbot's contour.

    The switch there moves at an edge of a slab, and corners of the ramp lie inside others, at places that change with
    their width: that two runs agree by accident says nothing of the next.
    """
    skin, per_root = mp.mpf(0.1) / mp.sqrt(mp.pi), {"resistance": 0.1, "frequency": 1}

    def answer(s):
        zc = mp.sqrt(1 + skin / mp.sqrt(s))
        return zc / (zc + 1) / s**2

    def risen(t):
        return np.array([float(mp.invertlaplace(answer, at, method="talbot", degree=16)) if at > 0 else 0 for at in t])

    value = {"shape": "piecewise linear", "points": [[0, 0], [corner, 0], [corner + 0.1, 1]]}
    table = {
        "medium": "electrical",
        "t_end": 1.9,
        "lines": {"l": {"nodes": ["a", "b"], "z0": 1, "delay": 1, "length": 1, "skin": per_root}},
        "sources": {"s": {"at": "a", "kind": "voltage", "resistance": 1, "value": value}},
        "loads": {"w": {"at": "b", "kind": "switch", "before": 1, "after": 2, "time": 0.25}},
        "probes": {"a": {"at": "a"}},
    }
    result = simulate(table, tol=1e-3)
    wide = np.linspace(-1.5, 1.5, 13) * result.resolution.h
    t = np.concatenate([corner + wide, corner + 0.1 + wide])
    exact = (risen(t - corner) - risen(t - corner - 0.1)) / 0.1
    assert result.accuracy.met
    assert np.abs(result.probes["a"].at(t).u - exact).max() < 2 * result.accuracy.inside["a"].u * np.abs(exact).max()


@pytest.mark.parametrize(("seed", "tol"), [(0, 1e-3), (8, 1e-3), (18, 1e-3), (12, 1e-5)])
def test_what_is_told_of_a_tree_or_a_bundle_is_no_less_than_a_third_of_the_error(seed, tol):
    """Beyond what two grids of BDF2 differ by; `python tests/attack.py memory` has more seeds, and laws."""
    found = judge(random_memory(seed), tol)
    assert found.met
    assert found.over < 3
    assert found.knows < tol


def test_laws_in_silence_find_their_flow():
    """Tables as large as 1 under waves that are rounding: what is left of these is no residual."""
    scene = random_memory(11).scene
    result = simulate(Scene.model_validate(scene.table() | {"t_end": 1.0}), tol=1e-2)
    assert result.accuracy.met


def test_nothing_is_there_before_it_arrives_on_slabs_at_whose_edges_switches_do_not_move():
    table = cable(t_end="3.2 ns", skin={"resistance": 60, "frequency": "10 GHz"}).table()
    table["sources"] = {"s": {"at": "s", "kind": "voltage", "value": 1}}
    table["links"] = {"w": {"kind": "switch", "nodes": ["s", "a"], "before": "inf", "after": 25, "time": "0.33371 ns"}}
    table["loads"]["w"] = {"at": "b", "kind": "switch", "before": 50, "after": "inf", "time": "0.17171 ns"}
    scene = Convolved(describe(as_scene(table)), [])
    h = 2.68e-12
    assert not scene.follows(h)
    seen = scene.run(Resolution(5, h)).probes["far"].at(np.array([0.9e-9, 1.1e-9, 1.3e-9, 1.5e-9])).u
    assert np.abs(seen[:3]).max() < 1e-6
    assert seen[3] > 0.5


@pytest.mark.parametrize(("opens", "again"), [("1.907 ns", "2.531 ns"), ("0.171 ns", "1.913 ns")])
def test_switches_at_edges_of_no_common_slabs(opens, again):
    """On slabs of 14 ps as on those of 1 ps, which have all instants at edges; not just behind fronts."""
    table = cable(t_end="3.2 ns", skin={"resistance": 60, "frequency": "10 GHz"}).table()
    table["sources"] = {"s": {"at": "s", "kind": "voltage", "value": 1}}
    table["links"] = {"w": {"kind": "switch", "nodes": ["s", "a"], "before": "inf", "after": 25, "time": "0.331 ns"}}
    for name, before, after, instant in (("w", 50, 1000, opens), ("x", "inf", 30, again)):
        table["loads"][name] = {"at": "b", "kind": "switch", "before": before, "after": after, "time": instant}
    description = describe(as_scene(table))
    scene, h = Convolved(description, []), 1e-9 / 70
    wide, narrow, fronts = scene.run(Resolution(5, h)), scene.run(Resolution(5, 1e-12)), arrivals(description)
    assert len(scene.laws.clocks(h)) == 3
    t = np.linspace(0.01e-9, 3.19e-9, 400)
    t = t[np.abs(t[:, None] - np.concatenate(list(fronts.values()))).min(axis=1) > 6 * h]
    for name, probe in wide.probes.items():
        u = narrow.probes[name].at(t).u
        assert np.abs(probe.at(t).u - u).max() < 2e-6 * np.abs(u).max()
