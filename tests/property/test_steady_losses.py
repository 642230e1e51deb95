"""A run that begins steady stays so while nothing is operated, whatever its lines lose."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.run import run
from tline.solver.steady.steady_state import steady_state

TURBULENT = {"viscosity": "1 mPa s", "roughness": "0.1 mm"}
FRICTION = {
    "linear": {"kind": "linear", "resistance": 1e5},
    "laminar": {"kind": "laminar", "viscosity": "0.1 Pa s"},
    "zielke": {"kind": "zielke", "viscosity": "0.1 Pa s"},
    "darcy": {"kind": "darcy", "factor": 0.02},
    "hazen-williams": {"kind": "hazen-williams", "coefficient": 100, "minor_loss": 3},
    "manning": {"kind": "manning", "coefficient": 0.013},
    "swamee-jain": {"kind": "swamee-jain", **TURBULENT},
    "quasi-steady": {"kind": "quasi-steady", **TURBULENT},
    "vardy-brown": {"kind": "vardy-brown", **TURBULENT, "reynolds": 1e5},
}
CREEP = {"wall_thickness": "1 cm", "creep": [{"compliance": 1e-10, "time": 0.05}]}
SAME, CIRCUITS = 1e-11, 1e-9  # segments of circuits are known as well as needed beside the circuits' own error
LEAK_AND_RESISTANCE = 1e-8


def pipes(friction: dict, lengths=(100.0, 100.0), flow: float = 0.02, **more) -> Scene:
    """Two pipes with losses in a row, and one without at their joint."""
    pipe = {"diameter": 0.1, "wave_speed": 1000, "density": 1000}
    rough = pipe | {"friction": friction} | more
    return Scene(
        medium="hydraulic",
        t_end=3,
        start="steady",
        lines={
            "first": rough | {"nodes": ["tank", "joint"], "length": lengths[0]},
            "second": rough | {"nodes": ["tap", "joint"], "length": lengths[1]},
            "branch": pipe | {"nodes": ["joint", "drip"], "length": 50},
        },
        loads={
            "tank": {"at": "tank", "kind": "reservoir", "pressure": "5 bar"},
            "tap": {"at": "tap", "kind": "orifice", "flow": flow, "pressure_drop": "3 bar"},
            "drip": {"at": "drip", "kind": "orifice", "flow": 1e-3, "pressure_drop": "3 bar"},
        },
        probes={"joint": {"at": "joint", "line": "first"}},
    )


def cables(**losses) -> Scene:
    """A lossy cable and one without losses, with a capacitor between them."""
    cable = {"z0": 50, "delay": "1 ns", "length": "20 cm"}
    return Scene(
        medium="electrical",
        t_end=2e-8,
        start="steady",
        lines={"lossy": cable | {"nodes": ["a", "b"]} | losses, "other": cable | {"nodes": ["b", "c"]}},
        sources={"s": {"at": "a", "kind": "voltage", "value": 1, "resistance": 10}},
        loads={
            "end": {"at": "c", "kind": "resistor", "resistance": 30},
            "middle": {"at": "b", "kind": "parallel", "capacitance": "1 pF"},
        },
        probes={"end": {"at": "c"}},
    )


def drift(scene: Scene, s: int) -> float:
    """How far any end of a line gets from where it began, relative to the largest effort."""
    chosen = resolution(describe(scene), s)._replace(fit=1e-4)  # of few terms, which segments are found faster of
    result = run(describe(scene), chosen, record=scene.lines)
    records = result.lines.values()
    waves = [wave for line in records for wave in (line.a1, line.b1, line.a2, line.b2)]
    return max(np.abs(wave.values - wave.before).max() for wave in waves) / max(abs(wave.before) for wave in waves)


@pytest.mark.parametrize("friction", FRICTION.values(), ids=FRICTION)
@pytest.mark.parametrize("wall", [{}, CREEP], ids=["stiff", "creep"])
@pytest.mark.parametrize("second", [100.0, 141.421356])
def test_pipes(friction, wall, second):
    assert drift(pipes(friction, (100.0, second), **wall), s=3) < (SAME if friction["kind"] != "zielke" else CIRCUITS)


@given(kind=st.sampled_from(list(FRICTION)), flow=st.floats(1e-5, 0.1), share=st.floats(0.3, 3.0), s=st.integers(2, 4))
@settings(max_examples=10, deadline=None)
def test_any_flow(kind, flow, share, s):
    assert drift(pipes(FRICTION[kind], (100.0, 100.0 * share), flow), s) < (SAME if kind != "zielke" else CIRCUITS)


@pytest.mark.parametrize("skin", [{}, {"skin": {"resistance": 100, "frequency": 1e9}}])
@pytest.mark.parametrize("delay", ["1 ns", "0.77712 ns"])
def test_cables_with_resistance(skin, delay):
    assert drift(cables(resistance=20, **skin, delay=delay), s=4) < CIRCUITS


def test_cables_that_leak():
    assert drift(cables(conductance=0.1), s=4) < SAME
    assert drift(cables(resistance=100, conductance=0.04), s=4) < SAME  # without distortion
    assert drift(cables(resistance=20, conductance=0.1), s=4) < LEAK_AND_RESISTANCE  # the profile is no polynomial


def test_the_steady_state_is_the_one_of_the_telegraph_equation():
    r, g, load = 20.0, 0.1, 30.0
    gamma, Zc = np.sqrt(r * g), np.sqrt(r / g)
    c, s = np.cosh(0.2 * gamma), np.sinh(0.2 * gamma)
    u1, y1 = load * c + Zc * s, c + load / Zc * s  # per ampere in the load
    scene = cables(resistance=r, conductance=g)
    effort, flows = steady_state(describe(scene))
    current = 1 / (u1 + 10 * y1)
    assert [effort[node] for node in "abc"] == pytest.approx([u1 * current, load * current, load * current], rel=1e-12)
    assert flows == pytest.approx(np.array([[y1, 1], [1, 1]]) * current, rel=1e-12)
