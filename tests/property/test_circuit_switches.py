"""Circuits whose capacitors bind each other: nothing jumps where a switch moves without a flow, wherever it stands."""

import numpy as np
import pytest

from tline import InputError, Scene, simulate

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
