"""Runs side by side against exact solutions, copy by copy."""

import math

import numpy as np
import pytest

from tline import Scene, sweep
from tline.compiled.structure import pack
from tline.solver.kernel.finished import extremes, find_extremes
from tline.solver.many.copies import slab_edges
from tline.solver.radau import basis
from tline.study.reference import Solution

TOL, BOUND = 1e-8, 1e-8  # asked of the estimate, and held to on copies that were not in the sample
COPIES, SHOWN, INSTANTS = 300, 3, 25

CABLE = {
    "medium": "electrical",
    "t_end": 20.0,
    "lines": {"cable": {"nodes": ["near", "far"], "z0": 50.0, "delay": 1.0}},
    "loads": {"end": {"at": "far", "kind": "parallel", "resistance": 100.0, "capacitance": 4e-3}},
    "probes": {"near": {"at": "near"}, "far": {"at": "far"}},
}
TEE = {
    "medium": "electrical",
    "t_end": 12.0,
    "lines": {
        "in": {"nodes": ["near", "tee"], "z0": 50.0, "delay": 1.0},
        "up": {"nodes": ["tee", "top"], "z0": 75.0, "delay": 1.5},
        "on": {"nodes": ["far", "tee"], "z0": 60.0, "delay": 0.5},
    },
    "loads": {
        "top": {"at": "top", "kind": "series", "resistance": 20.0, "inductance": 10.0, "capacitance": 0.01},
        "far": {"at": "far", "kind": "parallel", "inductance": 30.0, "capacitance": 0.005},
        "tee": {"at": "tee", "kind": "resistor", "resistance": 300.0},
    },
    "probes": {"tee": {"at": "tee", "line": "on"}, "top": {"at": "top"}, "far": {"at": "far"}},
}
RAMP = {"shape": "ramp", "to": 1.0, "duration": 0.1}
PULSE = {"shape": "pulses", "low": 0.2, "high": 1.0, "at": 0.3, "rise": 0.15, "width": 0.9, "fall": 0.0}


def source(value, kind="voltage"):
    return {"sources": {"source": {"at": "near", "kind": kind, "value": value, "resistance": 25.0}}}


def spread(**nominal):
    """Numbers around the nominal ones, by place."""
    rng = np.random.default_rng(1)
    return {place.replace("__", "."): value * rng.uniform(0.9, 1.1, COPIES) for place, value in nominal.items()}


def cable_numbers():
    return spread(
        lines__cable__z0=50.0,
        lines__cable__delay=1.0,
        loads__end__resistance=100.0,
        loads__end__capacitance=4e-3,
        sources__source__resistance=25.0,
    )


def fast_numbers():
    """A receiver that settles in a hundred-thousandth of the delay."""
    return cable_numbers() | {"loads.end.capacitance": 1e-4 * cable_numbers()["loads.end.capacitance"]}


def tee_numbers():
    numbers = spread(
        lines__up__z0=75.0, loads__top__resistance=20.0, loads__top__inductance=10.0, loads__far__capacitance=5e-3
    )
    stretch = spread(x=1.0)["x"]
    return numbers | {f"lines.{name}.delay": line["delay"] * stretch for name, line in TEE["lines"].items()}


def copy_of(data, numbers, k):
    """The scene of one copy."""
    copy = {**data, **{part: {n: dict(t) for n, t in data[part].items()} for part in ("lines", "loads", "sources")}}
    for where, values in numbers.items():
        part, name, key = where.split(".")
        copy[part][name][key] = float(values[k])
    return Scene(**copy)


@pytest.mark.parametrize(
    ("data", "numbers"),
    [
        (CABLE | source(RAMP), cable_numbers()),
        (CABLE | source({"shape": "step", "to": 1.0, "at": 0.37}, "current"), cable_numbers()),
        (CABLE | source({"shape": "step", "to": 1.0, "at": 0.37}), fast_numbers()),
        (CABLE | source({"shape": "sine", "amplitude": 1.0, "frequency": 0.3}), cable_numbers()),
        (TEE | source(PULSE), tee_numbers()),
    ],
    ids=["ramp", "step", "fast", "sine", "tee"],
)
def test_any_copy_is_exact_at_any_instant(data, numbers):
    rng = np.random.default_rng(2)
    times = np.sort(rng.uniform(0.0, data["t_end"], INSTANTS))
    runs = sweep(Scene(**data), numbers, sample="list", keep=["extremes", times], tol=TOL)
    assert runs.method == "vectorised"
    assert runs["estimate"].max() <= TOL
    for k in rng.integers(COPIES, size=SHOWN):
        scene = copy_of(data, numbers, k)
        for j, name in enumerate(runs.probes):
            exact = Solution(scene, name).at(times.tolist())
            amplitude = max(runs["highest"][k, j], -runs["lowest"][k, j])
            np.testing.assert_allclose(runs["u"][k, j], exact.efforts, rtol=0, atol=BOUND * amplitude)
            np.testing.assert_allclose(runs["y"][k, j], exact.flows, rtol=0, atol=BOUND * np.abs(exact.flows).max())


def test_extremes_are_those_of_the_exact_solution():
    numbers = cable_numbers()
    runs = sweep(Scene(**CABLE | source(RAMP)), numbers, sample="list", tol=TOL)
    highest, highest_at, lowest = (runs[name][:, 1] for name in ("highest", "highest_at", "lowest"))
    for k in range(SHOWN):
        solution = Solution(copy_of(CABLE | source(RAMP), numbers, k), "far")
        top_at = highest_at[k]
        around = np.clip(np.concatenate([top_at + np.linspace(-0.05, 0.05, 11), np.linspace(0.0, 20.0, 60)]), 0.0, 20.0)
        assert solution.at(around.tolist()).efforts.max() <= highest[k] + BOUND
        assert abs(solution.at([float(top_at)]).efforts[0] - highest[k]) <= BOUND
        assert abs(lowest[k]) <= BOUND


@pytest.mark.parametrize("s", [6, 9])
def test_extremes_of_waves_that_are_known(s):
    """Oscillations that die away or grow, cut in slabs and ended anywhere, against a fine grid."""
    rng = np.random.default_rng(s)
    copies, periods, t_end = 40, 9, 5.2
    order, unit = basis(s), rng.uniform(0.7, 1.0, copies)
    frequency, phase, rate = (rng.uniform(*limits, (copies, 1)) for limits in ((0.5, 3.0), (0.0, 6.0), (-0.3, 0.2)))

    def wave(t):
        return np.exp(rate * t) * np.sin(frequency * t + phase)

    fronts = np.stack([np.zeros(copies), rng.uniform(0.3, 0.6, copies), np.ones(copies)])
    edges = slab_edges(fronts, 4, 1.5)
    shares = edges[:-1, None] + np.diff(edges, axis=0)[:, None] * order.c[:, None]
    t = (np.arange(periods)[:, None, None, None] + shares) * unit
    values = wave(t.reshape(-1, copies).T).T.reshape(periods * len(shares), s, copies)
    found = np.empty((4, copies))
    sampled = np.ascontiguousarray(values)
    find_extremes(pack(extremes(sampled, unit, edges, t_end, order.c, order.to_powers, found)))
    grid = np.linspace(1e-9, t_end, 20_001)
    fine = wave(grid)
    width = np.diff(edges, axis=0).max()  # of polynomials that follow |λ| < 3.1, by the remainder of interpolation
    bound = 3 * 2 * (3.1 * width / 4) ** s / math.factorial(s) + 3 * (3.1 * grid[1]) ** 2 / 8  # and of the fine grid
    for k, pick in ((0, np.min), (2, np.max)):
        best = pick(np.concatenate([fine, np.zeros((copies, 1))], axis=1), axis=1)
        np.testing.assert_allclose(found[k], best, rtol=0, atol=bound)
        there = found[k] != 0
        at = wave(found[k + 1][:, None])[:, 0]
        np.testing.assert_allclose(found[k][there], at[there], rtol=0, atol=bound)
