"""A scene's transfer function with exact delays: against closed forms, and its Padé state space against itself."""

from itertools import pairwise

import numpy as np
import pytest
from one_line import one_line
from random_scenes import random_scene

from tline import InputError, Scene
from tline.frequency.delay_system import DelaySystem

T, Z0, RS, R, C = 1e-9, 50.0, 25.0, 100.0, 4e-12


def cable(**more) -> Scene:
    probes = {"near": {"at": "near"}, "far": {"at": "far"}, "inside": {"line": "line", "position": "30 %"}}
    loads = {"c": {"at": "far", "kind": "parallel", "resistance": R, "capacitance": C}}
    return one_line(1, {"z0": Z0, "delay": T}, 3, RS, **{"probes": probes, "loads": loads} | more)


def clamped() -> Scene:
    return cable(loads={"d": {"at": "far", "kind": "diode", "saturation": 1e-14}})


def chain(s, x):
    """Voltage and current at the share x of the cable, per volt of the source, by its chain matrix."""
    load = 1 / (1 / R + s * C)
    v, i = load, 1.0  # at the far end, per unit of current there
    there = np.cosh(s * T) * v + Z0 * np.sinh(s * T) * i + RS * (np.sinh(s * T) * v / Z0 + np.cosh(s * T) * i)
    way = s * T * (1 - x)
    return (np.cosh(way) * v + Z0 * np.sinh(way) * i) / there, (np.sinh(way) * v / Z0 + np.cosh(way) * i) / there


@pytest.mark.parametrize(("probe", "share"), [("near", 0.0), ("far", 1.0), ("inside", 0.3)])
def test_values_are_those_of_the_chain_matrix(probe, share):
    s = np.array([0.3e9 + 2e9j, 1e9j, 1e8])
    u, y = chain(s, share)
    np.testing.assert_allclose(DelaySystem(cable(), probe)(s), u, rtol=1e-12)
    np.testing.assert_allclose(DelaySystem(cable(), probe, quantity="y")(s), y, rtol=1e-12)


def test_a_step_is_exact_between_the_fronts():
    """Before the second arrival the capacitor charges by one exponential."""
    H, t = DelaySystem(cable(), "far"), np.linspace(1.01e-9, 2.9e-9, 50)
    incoming, behind = 2 * Z0 / (Z0 + RS), R * Z0 / (R + Z0)
    expected = incoming * R / (R + Z0) * -np.expm1(-(t - T) / (behind * C))
    np.testing.assert_allclose(H.step(t, tol=1e-10), expected, atol=1e-8)
    assert H.step([-1.0, 0.0, 0.5e-9]).tolist() == [0.0, 0.0, 0.0]


def test_the_phase_has_no_jumps_and_ends_at_the_delay():
    matched = cable(loads={"r": {"at": "far", "kind": "resistor", "resistance": Z0}})
    size, phase = DelaySystem(matched, "far").bode(np.linspace(0, 5e9, 101))
    np.testing.assert_allclose(size, Z0 / (Z0 + RS), rtol=1e-12)
    assert phase[-1] == pytest.approx(-2 * np.pi * 5e9 * T)


@pytest.mark.parametrize("quantity", ["u", "y", "a", "b"])
@pytest.mark.parametrize("probe", ["near", "far", "inside"])
def test_pade_approaches_the_delays(probe, quantity):
    H, s = DelaySystem(cable(), probe, quantity=quantity), 2j * np.pi * np.linspace(0, 4e8, 9)
    exact = H(s)
    errors = [np.abs(H.to_control(n)(s) - exact).max() / np.abs(exact).max() for n in (2, 4, 6, 8)]
    assert all(later < earlier / 3 for earlier, later in pairwise(errors))
    assert errors[-1] < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_pade_of_a_passive_scene_is_stable_and_near(seed):
    scene = random_scene(seed, sources=True)
    H, s = DelaySystem(scene, "p"), 2j * np.pi * np.linspace(0.01, 0.2, 7)
    approximate = H.to_control(9)
    assert approximate.poles().real.max() < 1e-9
    assert np.abs(approximate(s) - H(s)).max() < 1e-5 * np.abs(H(s)).max()


def test_pade_knows_what_stands_between_nodes():
    """A source between two nodes, and a coil behind one without a line."""
    between = cable(
        sources={"s": {"nodes": ["near", "inner"], "kind": "voltage", "value": 1, "resistance": RS}},
        links={"coil": {"nodes": ["inner", "other"], "kind": "inductor", "inductance": "5 nH"}},
        lines={
            "line": {"nodes": ["near", "far"], "z0": Z0, "delay": T},
            "second": {"nodes": ["other", "end"], "z0": 70, "delay": T},
        },
        loads={node: {"at": node, "kind": "resistor", "resistance": r} for node, r in (("far", R), ("end", 70))},
    )
    H, s = DelaySystem(between, "far"), 2j * np.pi * np.linspace(1e7, 4e8, 9)
    assert np.abs(H.to_control(9)(s) - H(s)).max() < 1e-6 * np.abs(H(s)).max()
    assert H.step([100e-9], tol=1e-9)[0] == pytest.approx(R / (R + RS + 70), rel=1e-8)


@pytest.mark.parametrize(("resistance", "stable"), [(-20, True), (-40, False)])
def test_stability(resistance, stable):
    """A loop gain of (R - z)/(R + z) times -1/3: 7/9 or 3."""
    active = {"a": {"at": "far", "kind": "impedance", "expression": str(resistance)}}
    assert DelaySystem(cable(loads=active), "far").is_stable() == stable


def test_oscillations():
    shorted = cable(loads={"s": {"at": "far", "kind": "short"}})
    assert DelaySystem(shorted, "near").oscillations(6e8)[0].frequency == pytest.approx(0.5e9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DelaySystem(cable(), "fra"), "probe: no such probe"),
        (lambda: DelaySystem(cable(), "far", source="t"), "source: no such source"),
        (lambda: DelaySystem(cable(), "far", quantity="i"), "quantity: unknown"),
        (lambda: DelaySystem(cable(), "far").to_control(0), "order: not an order"),
        (lambda: DelaySystem(clamped(), "far").to_control(3), "loads.d: is non-linear"),
        (lambda: DelaySystem(cable(), "far").step([1.0]), "t: an instant beyond"),
        (lambda: DelaySystem(cable(), "far").step([np.nan]), "t: an instant"),
    ],
)
def test_mistakes(make, message):
    with pytest.raises(InputError, match=message):
        make()
