"""Machines against the equations of their penstock, rotor and governor by DOP853, and their steady states."""

import numpy as np
import pytest
from hydraulic_by_hand import pipe
from method_of_steps import ByHand, Motion, integrate

import tline as tl

HEAD, TAIL, FLOW, DROP, SPEED, INERTIA, RUNAWAY = 22e5, 1e5, 2.0, 20e5, 500 / 60, 60e3, 1.8
PENSTOCK, OUTLET = pipe(550, 1.0, 1100), pipe(500, 1.2, 1000)
AT, LEFT = 0.5, 0.4
LINES = {
    "penstock": {"nodes": ["lake", "in"], "length": 550, "diameter": 1.0, "wave_speed": 1100, "density": 1000},
    "outlet": {"nodes": ["out", "river"], "length": 500, "diameter": 1.2, "wave_speed": 1000, "density": 1000},
}
TURBINE = {
    "kind": "turbine", "nodes": ["in", "out"], "rated_flow": FLOW, "rated_drop": DROP, "rated_speed": SPEED,
    "inertia": INERTIA, "rejects": AT, "load_left": LEFT, "opening": 0.8,
}  # fmt: skip


def scene(**more) -> tl.Scene:
    return tl.Scene(
        medium="hydraulic",
        t_end=6.0,
        start="steady",
        lines=LINES,
        links={"turbine": TURBINE | more},
        loads={
            "lake": {"at": "lake", "kind": "reservoir", "pressure": HEAD},
            "river": {"at": "river", "kind": "reservoir", "pressure": TAIL},
        },
        probes={"in": {"at": "in"}, "out": {"at": "out"}},
    )


def by_hand(droop: float = np.inf, reset: float = 6.0, stroke: float = 10.0) -> Motion:
    """J ω² n' = torque - load, with the torque of the jets, and x' from the governor; t counts from the rejection."""
    z, unit = PENSTOCK.z0 + OUTLET.z0, 0.88 * DROP / (RUNAWAY - 1)
    start = 0.8 * FLOW * np.sqrt((HEAD - TAIL) / DROP)
    load = unit * start * (RUNAWAY * np.sqrt((HEAD - TAIL) / DROP) - 1)

    def at(x, w):
        d, c = w[1] - w[2], x[1] * FLOW / np.sqrt(DROP)
        q = 2 * d * c / (z * c + np.sqrt((z * c) ** 2 + 4 * d))
        turns = (unit * q * (RUNAWAY * np.sqrt((d - z * q) / DROP) - x[0]) - LEFT * load) / INERTIA
        return q, turns / (2 * np.pi * SPEED) ** 2

    def wanted(x, turns):
        return ((1 - x[0]) / reset - turns) / droop

    def circuit(t, x, w, mode):
        q, turns = at(x, w)
        rates = np.array([turns, np.clip(wanted(x, turns), -1 / stroke, 1 / stroke)])
        return rates, np.array([HEAD, w[1] - PENSTOCK.z0 * q, w[2] + OUTLET.z0 * q, TAIL])

    def edges(t, x, w, mode):
        rate = wanted(x, at(x, w)[1]) * stroke
        return [(1 - rate, rate + 1)] if mode[0] == 0 else [(np.inf, rate - 1) if mode[0] > 0 else (-1 - rate, np.inf)]

    u = np.array([HEAD, HEAD, TAIL, TAIL])
    along = start * np.array([PENSTOCK.z0, PENSTOCK.z0, OUTLET.z0, OUTLET.z0])
    before = np.concatenate([u, u + along * [-1, 1, -1, 1]])
    mode = (-1,) if wanted([1.0, 0.8], at([1.0, 0.8], before[4:])[1]) * stroke < -1 else (0,)
    return integrate(
        circuit, [PENSTOCK, OUTLET], 5.5, scale=[1.0, 1.0], state=[1.0, 0.8], steady=before, edges=edges, mode=mode,
        rtol=1e-9,
    )  # fmt: skip


@pytest.mark.parametrize("governor", [{}, {"droop": 2.0}, {"droop": 0.4, "stroke_time": 15.0}])
def test_it_runs_up_as_its_equations_say(governor):
    """Without a governor, with one that is never too slow, and with one that runs at its fastest at first."""
    keys = {"droop": "droop", "stroke_time": "stroke"}
    exact = by_hand(**{keys[key]: value for key, value in governor.items()})
    result = tl.simulate(scene(**governor), tol=1e-7)
    found = ByHand(lambda: exact, {"in": 1, "out": 2}, AT).differences(result.probes)
    speed, gates = (trace for trace in result.states if trace.word in ("speed", "opening"))
    turned, opened = np.array([exact.at(t - AT)[8:10] for t in speed.t]).T
    assert np.abs(gates.values - opened).max() < 1e-6
    assert max(found.values()) < 1e-6
    assert np.abs(speed.values / SPEED - turned).max() < 1e-6 * turned.max()
    assert turned.max() > 1.02


def test_without_a_rejection_it_stands_still():
    still = {key: value for key, value in TURBINE.items() if key not in ("rejects", "load_left")}
    result = tl.simulate(scene().with_changes(links={"turbine": still | {"droop": 0.4}}), tol=1e-4)
    assert np.ptp(result.probes["in"].u) < 1e-9 * HEAD
    (speed,) = (trace for trace in result.states if trace.word == "speed")
    assert np.ptp(speed.values) < 1e-9 * SPEED


def test_energy_is_only_taken():
    """All that the water loses in it goes to the rotor or is lost: at any order and slab."""
    for order, slab in ((1, 0.1), (3, 0.25), (5, 0.17)):
        result = tl.simulate(
            scene(droop=0.4).with_changes(solver={"order": order, "slab": slab}), ledger=True, envelope=True
        )
        assert result.ledger is not None
        assert result.ledger.of("links.turbine").dissipated > 0
        assert result.ledger.residual < 1e-6 if order > 1 else result.ledger.residual < 1e-2


def test_a_share_without_an_instant_is_refused():
    with pytest.raises(tl.SceneError, match=r"rejects: is missing, expected when the load changes to load_left"):
        scene(rejects=None)


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
