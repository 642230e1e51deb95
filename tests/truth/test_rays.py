"""Fronts of lines that remember, at all their arrivals, by Talbot's contour and damped FFTs of textbook formulas."""

import mpmath as mp
import numpy as np
import pytest
from lossy_scenes import cable

from tline import Scene, simulate
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution

DELAY, LENGTH, SURFACE = 1e-9, mp.mpf("0.2"), mp.mpf(60) / mp.sqrt(mp.pi * 10**10)
SKIN = {"skin": {"resistance": 60, "frequency": "10 GHz"}}
BEHIND = DELAY * (1 + np.array([1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.03, 0.4, 1.7]))


def first_arrival(t: float) -> float:
    """Of a step of 1 V behind 25 ohm at a load of 100 ohm."""

    def passed(s):
        series, shunt = s * mp.mpf("250e-9") + SURFACE * mp.sqrt(s), s * mp.mpf("100e-12")
        zc, late = mp.sqrt(series / shunt), mp.sqrt(series) * mp.sqrt(shunt) * LENGTH - s * mp.mpf(DELAY)
        return 200 / (100 + zc) * zc / (zc + 25) * mp.exp(-late) / s

    with mp.workdps(30):
        return float(mp.invertlaplace(passed, mp.mpf(t) - mp.mpf(DELAY), method="talbot", degree=40))


def step(t_end: str, at: float = 0.0) -> Scene:
    return cable({"shape": "step", "to": 1, "at": at}, t_end=t_end, **SKIN)


@pytest.mark.parametrize("at", [0.0, 0.33371e-9])
def test_a_jump_is_right_from_a_hundred_thousandth_of_the_delay_behind_its_front_on(at):
    result = simulate(step("3.3 ns", at), tol=1e-6)
    exact = [first_arrival(t) for t in BEHIND.tolist()]
    assert np.abs(result.probes["far"].at(at + BEHIND).u - exact).max() < 1e-6
    assert np.abs(result.probes["far"].at(at + DELAY * np.array([0.3, 0.999, 1 - 1e-9])).u).max() < 1e-9
    assert len(result.accuracy.attempts) <= 3


def test_the_error_beside_fronts_falls_with_the_slabs_of_each_width_and_not_with_their_width():
    scene, exact = Convolved(describe(step("3 ns")), []), np.array([first_arrival(t) for t in BEHIND.tolist()])

    def off(near: int, slabs: int) -> float:
        chosen = Resolution(5, DELAY / slabs, convolved=True, layers=1e-10, near=near)
        return float(np.abs(scene.run(chosen).probes["far"].at(BEHIND).u - exact).max())

    few, more, many = (off(near, 8) for near in (4, 8, 12))
    assert more < few / 8
    assert many < 1e-8
    assert off(8, 16) > more / 8


SINGLE = {
    "nodes": ["a", "b"], "length": 0.2, "inductance": 250e-9, "capacitance": 100e-12,
    "skin": {"resistance": 60, "frequency": "10 GHz"},
}  # fmt: skip
PAIR = {
    "nodes1": ["a", "c"], "nodes2": ["b", "d"], "length": 0.3, "resistance": [[8, 1], [1, 3]],
    "inductance": [[300e-9, 60e-9], [60e-9, 380e-9]], "capacitance": [[140e-12, -22e-12], [-22e-12, 105e-12]],
    "skin": {"resistance": [[33, 5], [5, 16]], "frequency": "1 GHz", "added": True},
}  # fmt: skip


@pytest.mark.parametrize("line", [SINGLE, PAIR])
def test_a_law_that_is_a_resistor_answers_fronts_as_one(line):
    ramp = {"shape": "ramp", "to": 1, "duration": "0.13 ns"}
    linear = {"at": "b", "kind": "table", "points": [[-1, -0.004], [0, 0], [1, 0.004]]}
    found = []
    for load in (linear, {"at": "b", "kind": "resistor", "resistance": 250}):
        scene = Scene(
            medium="electrical", t_end="8 ns", lines={"l": line}, probes={"near": {"at": "a"}, "far": {"at": "b"}},
            loads={"b": load, "c": {"at": "b", "kind": "capacitor", "capacitance": "0.7 pF"}},
            sources={"s": {"at": "a", "kind": "voltage", "resistance": 50, "value": ramp}},
        )  # fmt: skip
        runs = Convolved(describe(scene), [])
        found.append(runs.run(Resolution(5, 0.17e-9, convolved=True, layers=1e-9, near=12)).probes)
    t = np.random.default_rng(3).uniform(0, 8e-9, 2000)
    for name, probe in found[0].items():
        assert np.abs(probe.at(t).u - found[1][name].at(t).u).max() < 1e-7
        assert np.abs(probe.at(t).y - found[1][name].at(t).y).max() < 1e-9


STEM, LEFT, RIGHT = (("d", "f", 0.08), ("f", "a", 0.05), ("f", "b", 0.0713))
TREE = Scene(
    medium="electrical", t_end=4e-9,
    lines={
        one + other: {
            "nodes": [one, other], "length": length, "inductance": 350e-9, "capacitance": 140e-12, "resistance": 8,
            "skin": {"resistance": 25, "frequency": "1 GHz", "added": True},
        }
        for one, other, length in (STEM, LEFT, RIGHT)
    },
    sources={
        "s": {"at": "d", "kind": "voltage", "resistance": 30,
              "value": {"shape": "piecewise linear", "points": [[0, 0], [1.5e-10, 1], [1.1e-9, 1], [1.3e-9, 0.2]]}},
    },
    loads={
        "a": {"at": "a", "kind": "parallel", "resistance": 1e3, "capacitance": 1e-12},
        "b": {"at": "b", "kind": "resistor", "resistance": 60},
    },
    probes={at: {"at": at} for at in "dab"} | {"stem": {"at": "f", "line": "df"}},
)  # fmt: skip


def test_a_tree_of_unlike_delays():
    """Nodal analysis in s by a damped FFT; what half its frequencies leave out tells how well it knows corners."""
    n, period = 1 << 18, 8e-9
    damping = 12.5 / period * 2
    s = damping + 2j * np.pi * np.fft.rfftfreq(n, period / n)
    Y = np.zeros((len(s), 4, 4), complex)
    names, loads = "dfab", {"d": 1 / 30 + 0 * s, "a": 1e-3 + s * 1e-12, "b": 1 / 60 + 0 * s}
    series, shunt = 8 + 25 / np.sqrt(np.pi * 1e9) * np.sqrt(s) + s * 350e-9, s * 140e-12
    zc, gamma = np.sqrt(series / shunt), np.sqrt(series) * np.sqrt(shunt)
    for one, other, length in (STEM, LEFT, RIGHT):
        passed, here = np.exp(-gamma * length), [names.index(one), names.index(other)]
        for k in (0, 1):
            Y[:, here[k], here[k]] += (1 + passed**2) / (1 - passed**2) / zc
            Y[:, here[k], here[1 - k]] -= 2 * passed / (1 - passed**2) / zc
    for name, load in loads.items():
        Y[:, names.index(name), names.index(name)] += load
    corners = sum(bend * np.exp(-s * t) for t, bend in ((0, 1 / 0.15), (0.15e-9, -1 / 0.15), (1.1e-9, -4), (1.3e-9, 4)))
    right = np.zeros((len(s), 4, 1), complex)
    right[:, 0, 0] = corners * 1e9 / s**2 / 30
    t = np.arange(n) * period / n
    U = np.linalg.solve(Y, right)[:, :, 0]
    u, coarse = (
        np.fft.irfft(U[: m // 2 + 1], m, axis=0) * m / period * np.exp(damping * t[:: n // m])[:, None]
        for m in (n, n // 2)
    )
    knows = np.abs(u[::2] - coarse)[: n // 4].max()
    assert knows < 2e-5
    result = simulate(TREE, tol=1e-5)
    assert result.accuracy.met
    assert result.resolution.convolved
    k = np.random.default_rng(4).integers(1, n // 2 - 1, 5000)
    for name, probe in result.probes.items():
        exact = u[k, names.index({"stem": "f"}.get(name, name))]
        off = np.abs(probe.at(t[k]).u - exact).max() / np.abs(exact).max()
        assert off < 3 * result.accuracy.inside[name].u + knows / np.abs(exact).max()
