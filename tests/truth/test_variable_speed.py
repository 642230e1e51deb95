"""A pump that goes to another speed ends in the steady state that it has there."""

import pytest

import tline as tl


def test_a_pump_slows_down_to_its_new_steady_state():
    main = {"length": 400, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    scene = tl.Scene(
        medium="hydraulic",
        t_end=90,
        start="steady",
        lines={"main": {"nodes": ["out", "end"], "friction": {"kind": "darcy", "factor": 0.02}, **main}},
        links={"lift": {"kind": "pump", "nodes": ["sump", "out"], "curve": [["60 L/s", "4 bar"]]}},
        loads={
            "sump": {"at": "sump", "kind": "reservoir", "pressure": "0.2 bar"},
            "tap": {"at": "end", "kind": "orifice", "flow": "60 L/s", "pressure_drop": "3 bar"},
        },
        probes={"end": {"at": "end"}},
    )
    slow = tl.simulate(scene.change({"links.lift.speed": 0.8, "t_end": 1}), tol=1e-3).probes["end"]
    surge = tl.operate(scene, speed="lift:80%@1s+5s", t_end="90 s", cavities=False)
    assert surge.result.probes["out"].y[0] > 1.2 * slow.y[0]
    assert surge.result.probes["out"].y[-1] == pytest.approx(slow.y[0], rel=1e-3)
