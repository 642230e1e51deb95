"""What starts steady stays so, and nothing jumps where a switch moves without a flow, whatever the circuit."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from random_circuits import random_circuit

from tline import InputError, Scene, simulate

NAMES = ["a", "b", "m1", "m2"]


def random_element(rng: np.random.Generator, medium: str) -> dict[str, Any]:
    """A linear one or a law, without its nodes."""
    kind = rng.choice(["resistor", "inductor", "capacitor", "series", "law", "law"])
    r, inductance = float(10 ** rng.uniform(0, 2)), float(10 ** rng.uniform(-1, 2))
    match kind:
        case "resistor":
            return {"kind": "resistor", "resistance": r}
        case "inductor":
            return {"kind": "inductor", "inductance": inductance}
        case "capacitor":
            return {"kind": "capacitor", "capacitance": float(10 ** rng.uniform(-4, -1))}
        case "series":
            return {"kind": "series", "resistance": r, "inductance": inductance}
    if medium == "hydraulic":
        return {"kind": "orifice", "flow": 1 / r, "pressure_drop": 1.0}
    return {"kind": "table", "points": [[-5, -1 / r], [0, 0], [3, 0.3 / r], [9, 9 / r]]}


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
@pytest.mark.parametrize("medium", ["hydraulic", "electrical"])
def test_a_steady_state_lasts(medium):
    for seed in range(60):
        rng = np.random.default_rng(seed)
        links = {
            f"link{k}": random_element(rng, medium) | {"nodes": list(pair)}
            for k, pair in enumerate(pairwise(["a", "m1", "m2", "b"]))
        }
        for k in range(rng.integers(0, 4)):
            pair = [str(name) for name in rng.choice(NAMES, 2, replace=False)]
            links[f"across{k}"] = random_element(rng, medium) | {"nodes": pair}
        loads = {"end": {"at": "end", "kind": "resistor", "resistance": float(10 ** rng.uniform(1, 2))}}
        if rng.random() < 0.5:
            loads["capacitor"] = {"at": "m2", "kind": "capacitor", "capacitance": float(10 ** rng.uniform(-4, -1))}
        if rng.random() < 0.5:
            loads["resistor"] = {"at": "m1", "kind": "resistor", "resistance": float(10 ** rng.uniform(1, 2))}
        source = {"kind": "pressure" if medium == "hydraulic" else "voltage", "value": 10.0}
        scene = Scene(
            medium=medium,
            t_end=6.0,
            start="steady",
            lines={
                "first": {"nodes": ["source", "a"], "z0": 50.0, "delay": 1.0},
                "second": {"nodes": ["b", "end"], "z0": 70.0, "delay": 1.3},
            },
            sources={"s": source | {"at": "source", "resistance": float(10 ** rng.uniform(0, 2))}},
            links=links,
            loads=loads,
            probes={"a": {"at": "a"}, "b": {"at": "b"}, "end": {"at": "end"}},
            solver={"order": 4, "slab": 0.1},
        )
        for name, probe in simulate(scene).probes.items():
            assert np.abs(probe.u - probe.u[0]).max() < 1e-9 * 10, (seed, name)
            assert np.abs(probe.y - probe.y[0]).max() < 1e-9 * 10 / 50, (seed, name)


ROUNDING = 1e-9  # over six decades of time constants; of 900 such circuits one, coupled by 0.9999, moved by 1.6e-9


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # what does not move needs no resolution
def test_nothing_moves_from_a_steady_start(seed):
    table = random_circuit(seed, 1 + seed % 8, laws=bool(seed % 2))
    ends = {at: name for name, line in table["lines"].items() for at in line["nodes"]}
    driven = {"at": next(iter(ends)), "kind": "pressure", "value": 1.7, "resistance": 0.8}
    probes = {at: {"at": at, "line": name} for at, name in ends.items()}
    result = simulate(Scene(**table | {"start": "steady", "sources": {"s": driven}, "probes": probes}))
    for probe in result.probes.values():
        assert np.abs(probe.u - probe.u[0]).max() < ROUNDING


SEEDS = range(12)


def capacitor(rng: np.random.Generator, **place) -> dict:
    return {"kind": "capacitor", "capacitance": float(rng.uniform(0.1, 0.5))} | place


def bound(seed: int, *, law: bool) -> Scene:
    """Four nodes with a capacitor at each and rings of capacitors between them, in a steady state; a switch moves."""
    rng = np.random.default_rng(seed)
    names = ["n1", "m0", "m1", "m2"]
    loads = {f"c{k}": capacitor(rng, at=name) for k, name in enumerate(names)}
    loads["r"] = {"at": "m0", "kind": "resistor", "resistance": float(rng.uniform(0.3, 3))}
    pairs = [("m0", "n1"), ("m1", "m0"), ("m1", "n1")][: int(rng.integers(2, 4))]
    links: dict = {f"k{k}": capacitor(rng, nodes=pair) for k, pair in enumerate(pairs)}
    before, after = rng.uniform(0.2, 2, 2).tolist()
    links["switch"] = {"nodes": ["m0", "m2"], "kind": "switch", "before": before, "after": after, "time": 1.3}
    if law:
        links["law"] = {"nodes": ["m2", "m0"], "kind": "table", "points": [[-1, -2], [0, 0], [0.5, 0.5], [1, 2]]}
    return Scene(
        medium="electrical",
        t_end=3.0,
        start="steady",
        lines={"l": {"nodes": ["n0", "n1"], "z0": 1.5, "delay": 0.5}},
        sources={"s": {"at": "n0", "kind": "voltage", "value": 1, "resistance": 1.8}},
        loads=loads,
        links=links,
        probes={name: {"at": name} for name in names},
        solver={"order": int(rng.integers(1, 6)), "slab": 0.02},
    )


@pytest.mark.parametrize("law", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_a_switch_without_a_flow_moves_nothing(seed, law):
    for probe in simulate(bound(seed, law=law)).probes.values():
        assert np.ptp(probe.u) < 1e-12


def test_an_ideal_source_round_a_lossless_line_has_no_steady_state():
    scene = Scene(
        medium="electrical",
        t_end=3.0,
        start="steady",
        lines={"l": {"nodes": ["n0", "n1"], "z0": 1.5, "delay": 0.5}},
        sources={"s": {"nodes": ["n0", "n1"], "kind": "voltage", "value": 0.3}},
        loads={"r": {"at": "n0", "kind": "resistor", "resistance": 3}},
        probes={"p": {"at": "n0"}},
    )
    with pytest.raises(InputError, match=r"sources\.s: no steady state: lossless lines join its two nodes"):
        simulate(scene)
