"""A vessel whose bladder shuts it once it fills it, or that empties, at a lossless line, against DOP853 with events.

The other end is matched, so what arrives is what the source sent a delay ago: V' = -(w - p(V))/z0 with p absolute and
p V^n constant, up to the vessel's volume; there nothing flows until the wave exceeds the pressure of the gas.
"""

from typing import Any

import numpy as np
import pytest
from energy import never_grows
from matched_sine import MatchedSine
from scipy.integrate import solve_ivp

import tline as tl
from tline.solver.result.states import emptied
from tline.surge.worst import EMPTIES, worst

Z0, DELAY, HEAD, SWING, RATE, T_END = 2e7, 0.1, 3e5, 2e5, 0.5, 4.0
LINE = MatchedSine(Z0, DELAY, HEAD, -SWING, RATE, T_END)
GAS, TOTAL, N, OUTSIDE = 0.02, 0.022, 1.2, 101_325.0


def scene(**more) -> tl.Scene:
    vessel = {"kind": "air vessel", "gas_volume": GAS, "gas_pressure": HEAD, "total_volume": TOTAL, "bladder": True}
    return LINE.scene({"vessel": vessel | more}, order=4, slab=1e-3)


def gauge(volume: float) -> float:
    return (HEAD + OUTSIDE) * (GAS / volume) ** N - OUTSIDE


def by_hand():
    """Volume of the gas at any instant, and instants at which the vessel is shut and opens again."""
    pieces, met, t, volume, shut = [], [], 0.0, GAS, False
    while t < T_END - 1e-12:
        moves = not shut

        def event(s, y, moves=moves):
            return y[0] - TOTAL if moves else LINE.wave(s) - gauge(TOTAL)

        ends: Any = event
        ends.terminal, ends.direction = True, 1
        done = solve_ivp(
            lambda s, y, moves=moves: [-moves * (LINE.wave(s) - gauge(y[0])) / Z0],
            (t, DELAY if t < DELAY else T_END), [volume], "DOP853",
            rtol=1e-12, atol=1e-15, dense_output=True, events=ends, max_step=0.01,
        )  # fmt: skip
        pieces.append((done.t[-1], done.sol))
        t, volume = done.t[-1], done.y[0, -1]
        if done.status == 1:
            met.append(t)
            shut = not shut
    return lambda s: next(sol(s)[0] for until, sol in pieces if s <= until), met


def test_it_is_its_differential_equation():
    exact, met = by_hand()
    assert len(met) == 4  # it is shut and opens twice
    result = tl.simulate(scene(), envelope=True)
    t = result.t[1:]
    t = t[np.abs(t[:, None] - np.array([DELAY, *met])).min(axis=1) > 0.01]
    (gas,) = (trace for trace in result.states if trace.word == "gas volume")
    volume = np.array([exact(s) for s in t])
    assert np.interp(t, gas.t, gas.values) == pytest.approx(volume, abs=1e-6 * GAS)
    opened = np.searchsorted(met, t) % 2 == 0
    pressure = [gauge(v) if free else LINE.wave(s) for s, v, free in zip(t, volume, opened, strict=True)]
    assert result.probes["b"].at(t).u == pytest.approx(np.array(pressure), abs=1e-6 * (HEAD + SWING))
    assert worst(result).untold != EMPTIES


def test_without_a_bladder_it_is_told_when_it_is_empty():
    """Until then the equation is the same; gas would enter the pipe from there on, and no class is named."""
    exact, met = by_hand()
    result = tl.simulate(scene(bladder=False), envelope=True)
    t = result.t[result.t < met[0]][1:]
    (gas,) = (trace for trace in result.states if trace.word == "gas volume")
    assert gas.values[1 : len(t) + 1] == pytest.approx([exact(s) for s in t], abs=1e-6 * GAS)
    assert emptied(result)["loads.vessel"] == (pytest.approx(met[0], abs=1e-6 * T_END), TOTAL)
    assert any(f"it is empty after {met[0]:.4g} s: its {TOTAL} m^3 are gas" in note for note in result.notes)
    assert worst(result).untold == EMPTIES
    larger = tl.simulate(scene(bladder=False, total_volume=1.0), envelope=True)
    assert not emptied(larger)
    assert worst(larger).untold != EMPTIES


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_stored_energy_never_grows(order, exponent):
    vessel = {"kind": "air vessel", "gas_volume": 1.0, "gas_pressure": 0.0, "atmosphere": 1.0, "exponent": exponent}
    one = tl.Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b", "total_volume": 1.1, "bladder": True} | vessel},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": 0.23},
    )

    def held(assembly):
        laws = assembly.network.laws
        v, n = np.exp(assembly.state.load[laws.state_at[0]]), exponent
        work = -np.log(v) if n == 1 else (v ** (1 - n) - 1) / (n - 1)
        return work + v - 1

    for seed in range(5):
        never_grows(one, seed, held, 2e-14)


def test_volumes_that_a_vessel_does_not_have():
    with pytest.raises(tl.SceneError, match=r"total_volume: no room for liquid, expected more than the gas, 0\.02 m"):
        scene(total_volume=0.01)
    with pytest.raises(tl.SceneError, match="total_volume: is missing, expected the volume that the bladder may fill"):
        scene(total_volume=None)
