"""Baseline methods fall at the order they declare, against closed forms of one line, and say what they cannot do."""

from functools import partial
from math import comb

import numpy as np
import pytest
from one_line import FAR, one_line

from tline import InputError, Scene
from tline.scene.waveform import Shape
from tline.study.baseline import BASELINES
from tline.study.charts.scenes import chart_scene
from tline.study.reference.friction import FrictionSolution

LAST = 1.5  # s, of the bell
COUNTS = {  # steps per delay from which on each error falls as it should; odd ones are not whole delays
    "moc_trapezoid": (16.4, 32.4, 64.4, 128.4),
    "moc_forward_euler": (16.4, 32.4, 64.4, 128.4),
    "moc_backward_euler": (16.4, 32.4, 64.4, 128.4),
    "moc_linear": (64, 128, 256),
    "moc_cubic": (32, 64, 128),
    "upwind": (500, 1000, 2000),
    "lax_wendroff": (80, 160, 320),
    "fdtd": (80, 160, 320),
    "lumped_t": (20, 40),
    "lumped_pi": (20, 40),
    "pade": (24, 48),
    "slabs_pointwise": (8, 12, 16, 24, 32),
}


class Bell(Shape):
    """A pulse with nine continuous derivatives, so that nothing but the method limits the order."""

    def breaks(self, t_end):
        return np.array([0.0, LAST])

    def value(self, t, inside):
        return np.where((inside > 0) & (inside < LAST), np.sin(np.pi * t / LAST) ** 10, 0.0)


def line(source: float, load: dict, t_end: float) -> Scene:
    scene = one_line(t_end, {"z0": 1, "delay": 1}, 1, source, load, probes=FAR)
    return scene.model_copy(update={"sources": {"s": scene.sources["s"].model_copy(update={"value": Bell()})}})


def bounces(t):
    """Behind 1/2 ohm into 3 ohm: H1 = -1/3, H2 = 1/2, every round trip of 2 multiplies by their product."""
    return sum(2 / 3 * 1.5 * (-1 / 6) ** k * Bell().value(t - 2 * k - 1, t - 2 * k - 1) for k in range(3))


def charge(t):
    """Behind 1 ohm into 2 ohm beside 0.3 F: u' = (w - u)/C - u/(R C), the bell's ten sines one by one."""
    rate, t = (1 + 1 / 2) / 0.3, t - 1
    seen, u = np.clip(t, 0, LAST), 0
    for k in range(11):
        turn = 1j * (10 - 2 * k) * np.pi / LAST
        u = u - comb(10, k) * (-1) ** k / 1024 * (np.exp(turn * seen) - np.exp(-rate * seen)) / (rate + turn)
    return np.real(u) / 0.3 * np.exp(-rate * np.maximum(t - LAST, 0))


def slope(name: str, scene: Scene, exact, counts, probe: str = "far") -> float:
    errors = []
    for n in counts:
        trace = BASELINES[name].run(scene, n)
        errors.append(np.abs(trace.u[probe] - exact(trace.t)).max())
    return -np.polyfit(np.log(counts), np.log(errors), 1)[0]


@pytest.mark.parametrize("name", COUNTS)
def test_lines_converge_at_the_declared_order(name):
    scene = line(0.5, {"kind": "resistor", "resistance": 3}, 4.0)
    assert slope(name, scene, bounces, COUNTS[name]) == pytest.approx(BASELINES[name].order, abs=0.35)


@pytest.mark.parametrize("name", COUNTS)
def test_loads_converge_at_the_declared_order(name):
    scene = line(1.0, {"kind": "parallel", "resistance": 2, "capacitance": 0.3}, 4.0)
    baseline, counts = BASELINES[name], COUNTS[name]
    whole = [round(n) for n in counts]
    lowest = baseline.load_order if name.startswith("moc_") else min(baseline.order, baseline.load_order)
    assert slope(name, scene, charge, whole) == pytest.approx(lowest, abs=0.35)


@pytest.mark.parametrize(
    ("name", "finest", "counts"), [("friction", 1024, (32, 64, 128)), ("network", 256, (8, 16, 32))]
)
def test_friction_on_a_grid_converges_at_the_declared_order(name, finest, counts):
    scene = chart_scene(name).scene
    solution = FrictionSolution(scene, finest)  # good to 4e-7 of the surge, a tenth of the least error here
    for probe in scene.probes:
        exact = partial(solution.at, probe)
        assert slope("moc_grid", scene, exact, counts, probe) == pytest.approx(BASELINES["moc_grid"].order, abs=0.1)


def test_extrapolation_of_a_grid_gains_an_order_at_least():
    """It gains two where no flow turns, and one where flows do."""
    scene = chart_scene("friction").scene
    exact = partial(FrictionSolution(scene, 1024).at, "far")
    assert slope("moc_extrapolated", scene, exact, (8, 16, 32)) > 2.7


def test_two_halves_of_a_pipe_are_the_pipe():
    given = chart_scene("friction").scene.table()
    half = given["lines"]["pipe"] | {"length": "2000 ft", "delay": 0.5}
    lines = {"one": half | {"nodes": ["tank", "mid"]}, "two": half | {"nodes": ["mid", "far"]}}
    halves = BASELINES["moc_grid"].run(Scene(**given | {"lines": lines}), 16).u["far"]
    whole = BASELINES["moc_grid"].run(Scene(**given), 32).u["far"]
    assert np.abs(halves - whole).max() < 1e-12 * np.abs(whole).max()  # another order of sums


@pytest.mark.parametrize("name", ["friction", "network"])
def test_nothing_moves_on_a_grid_from_the_steady_state(name):
    given = chart_scene(name).scene.table()
    before = {"draw": "-200 L/s", "plant": "-100 L/s", "houses": "-50 L/s"}
    still = {key: draw | {"value": before[key]} for key, draw in given["sources"].items()}
    trace = BASELINES["moc_grid"].run(Scene(**given | {"sources": still}), 64)
    for u in trace.u.values():
        assert np.abs(u / u[0] - 1).max() < 1e-11  # thousands of steps of rounding, on a surge 7 times larger


def test_characteristics_at_courant_1_are_exact_between_resistances():
    trace = BASELINES["moc_trapezoid"].run(line(0.5, {"kind": "resistor", "resistance": 3}, 5.0), 16)
    assert np.abs(trace.u["far"] - bounces(trace.t)).max() < 1e-14


def test_a_grid_is_for_friction_alone():
    baseline, capacitor = BASELINES["moc_grid"], {"kind": "parallel", "resistance": 2, "capacitance": 0.3}
    assert "without friction" in baseline.incompatibility(line(0.5, {"kind": "resistor", "resistance": 3}, 4.0))
    assert baseline.incompatibility(line(0.5, capacitor, 4.0)) == "loads.load: has a state"


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"probes": {"p": {"line": "line", "position": "25 %"}}}, "probes.p: baseline methods see nodes only"),
        ({"start": "steady"}, "start: baseline methods start at rest only"),
        (
            {"loads": {"v": {"at": "far", "kind": "switch", "before": 1, "after": 2, "time": 1}}},
            "loads.v: baseline methods have no switches",
        ),
    ],
)
@pytest.mark.parametrize("name", ["moc_linear", "pade"])
def test_what_no_baseline_method_can_do(name, changed, sentence):
    base = {
        "medium": "electrical",
        "t_end": 3.0,
        "lines": {"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
        "sources": {"s": {"at": "near", "kind": "voltage", "resistance": 1, "value": 1}},
        "probes": {"far": {"at": "far"}},
    }
    scene = Scene(**base | changed)
    assert BASELINES[name].incompatibility(scene) == sentence
    with pytest.raises(InputError, match=sentence):
        BASELINES[name].run(scene, 4)


def test_inductances_take_no_jump_of_flow():
    current = {"s": {"at": "near", "kind": "current", "value": 1}}
    scene = one_line(3.0, {"z0": 1, "delay": 1}, None, None, probes=FAR, sources=current)
    assert "would have to jump in the inductances" in str(BASELINES["lumped_t"].incompatibility(scene))
    assert BASELINES["lumped_pi"].incompatibility(scene) is None


@pytest.mark.parametrize("name", ["moc_trapezoid", "fdtd", "upwind", "lumped_pi", "slabs_pointwise"])
def test_bounds_on_n(name):
    scene = line(0.5, {"kind": "resistor", "resistance": 3}, 5.0)
    with pytest.raises(InputError, match="too few steps per shortest delay, expected at least 2, got 1"):
        BASELINES[name].run(scene, 1)
    with pytest.raises(InputError, match=r"n: takes .* numbers"):
        BASELINES[name].run(scene, 1e8)


def test_a_stiff_load_is_integrated_implicitly():
    """A load ten thousand times faster than a section: still the closed form of a resistor."""
    load = {"kind": "parallel", "resistance": 3, "capacitance": 1e-6}
    trace = BASELINES["lumped_t"].run(line(0.5, load, 4.0), 40)
    assert np.abs(trace.u["far"] - bounces(trace.t)).max() < 0.03  # as far off as with the resistor alone
