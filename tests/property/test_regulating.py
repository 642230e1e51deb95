"""Openings that move by themselves in scenes left to themselves: waves lose energy, whatever the slab and the order."""

import numpy as np
import pytest

from tline import Scene, simulate

LINE = {"diameter": 0.2, "wave_speed": 1000, "density": 1000}
KEEPS = {"downstream": "set_pressure", "upstream": "set_pressure", "level": "set_pressure", "flow": "set_flow"}


def valve(rng: np.random.Generator, keeps: str) -> dict:
    time = {"time_constant": float(10 ** rng.uniform(-1, 1))} | ({"stroke_time": 0.1} if rng.random() < 0.5 else {})
    kept = {KEEPS[keeps]: float(rng.uniform(0.1, 2)) * (1e-3 if keeps == "flow" else 1e5)}
    bore = {"loss_coefficient": 2, "diameter": 0.2, "opening": float(rng.random())}
    return {"kind": "regulating valve", "keeps": keeps} | time | kept | bore


def disc(rng: np.random.Generator) -> dict:
    moves = {"disc_mass": float(10 ** rng.uniform(0, 2)), "travel": 0.1, "damping": float(rng.choice([0, 100]))}
    return {"kind": "check valve", "loss_coefficient": 2, "diameter": 0.2, "cracking_pressure": 100} | moves


def chattering(seed):
    """Seeds whose discs or valves once left flows so near to zero that they were not found within 20 s."""
    return pytest.param(seed, 20, id=f"{seed} for longer")


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # corners of the pulse
@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize(("seed", "t_end"), [*((k, 8) for k in range(3)), *map(chattering, (127, 155, 171))])
def test_energy_never_grows(order, seed, t_end):
    """Three pipes and two of them in a row, after a pulse at one end; both ends are dead."""
    rng = np.random.default_rng(seed)
    first = valve(rng, [*KEEPS][seed % 4])
    second = disc(rng) if seed % 2 else valve(rng, "downstream")
    kick = {"shape": "piecewise linear", "points": [[0, 0], [0.05, 0.02], [0.3, 0.0]]}
    scene = Scene(
        medium="hydraulic",
        t_end=t_end,
        lines={
            "p1": {"nodes": ["s", "a"], "length": 100, **LINE},
            "p2": {"nodes": ["b", "e"], "length": float(rng.uniform(50, 300)), **LINE},
            "p3": {"nodes": ["c", "f"], "length": 70, **LINE},
        },
        links={"one": {"nodes": ["a", "b"], **first}, "two": {"nodes": ["b", "c"], **second}},
        sources={"kick": {"at": "s", "kind": "flow", "value": kick}},
        probes={"e": {"at": "e"}},
        solver={"order": order, "slab": float(rng.uniform(0.005, 0.03))},
    )
    ledger = simulate(scene, ledger=True).ledger
    for entry in ledger.entries:
        if entry.where.startswith("links"):
            assert entry.created <= 1e-12 * ledger.turnover, entry
