"""A circuit written in two ways does the same."""

from typing import Any

import numpy as np
import pytest

from tline import Scene, simulate

RAMP = {"shape": "ramp", "to": 10.0, "duration": 0.5}
DRIVE = {"kind": "voltage", "value": RAMP}
SOURCE = {"s": DRIVE | {"at": "source", "resistance": 20.0}}
EARTH = {"earth": {"at": "earth", "kind": "short"}}
TABLE = {"kind": "table", "points": [[-5, -0.1], [0, 0], [3, 0.05], [9, 0.9]]}


def part(kind: str, nodes: str, value: float) -> dict[str, Any]:
    key = {"resistor": "resistance", "inductor": "inductance", "capacitor": "capacitance"}[kind]
    return {"kind": kind, "nodes": nodes.split(), key: value}


def circuit(*links: dict[str, Any], sources: dict[str, Any] = SOURCE, **loads: dict[str, Any]) -> dict[str, Any]:
    return {"links": {f"link{k}": link for k, link in enumerate(links)}, "sources": sources, "loads": loads}


def load(kind: str, at: str, value: float) -> dict[str, Any]:
    table = part(kind, at, value)
    return table | {"at": table.pop("nodes")[0]}


R = part("resistor", "a b", 10.0)
BEHIND = part("resistor", "source source2", 20.0)
PAIRS = {
    "two resistors in a row": (
        circuit(part("resistor", "a m", 4.0), part("resistor", "m b", 6.0)),
        circuit(R),
    ),
    "two inductors in a row beside a capacitor": (
        circuit(part("inductor", "a m", 20.0), part("inductor", "m b", 40.0), c=load("capacitor", "b", 0.02)),
        circuit(part("inductor", "a b", 60.0), c=load("capacitor", "b", 0.02)),
    ),
    "two capacitors side by side beside a third": (
        circuit(part("capacitor", "a b", 0.01), part("capacitor", "a b", 0.03), R, c=load("capacitor", "b", 0.02)),
        circuit(part("capacitor", "a b", 0.04), R, c=load("capacitor", "b", 0.02)),
    ),
    "star and delta": (
        circuit(part("resistor", "a m", 10.0), part("resistor", "b m", 20.0), r=load("resistor", "m", 30.0)),
        circuit(part("resistor", "a b", 1100 / 30), r=load("resistor", "a", 1100 / 20), q=load("resistor", "b", 110.0)),
    ),
    "an expression and a chain": (
        circuit({"kind": "impedance", "nodes": ["a", "b"], "expression": "10 + s*20 + 1/(s*0.01)"}),
        circuit(part("resistor", "a m", 10.0), part("inductor", "m n", 20.0), part("capacitor", "n b", 0.01)),
    ),
    "side by side in one and in three": (
        circuit({"kind": "parallel", "nodes": ["a", "b"], "resistance": 10, "inductance": 20, "capacitance": 0.02}),
        circuit(R, part("inductor", "a b", 20.0), part("capacitor", "a b", 0.02)),
    ),
    "two tables in a row and one of twice the effort": (
        circuit(TABLE | {"nodes": ["a", "m"]}, TABLE | {"nodes": ["m", "b"]}, c=load("capacitor", "a", 0.01)),
        circuit(
            TABLE | {"nodes": ["a", "b"], "points": [[2 * u, i] for u, i in TABLE["points"]]},
            c=load("capacitor", "a", 0.01),
        ),
    ),
    "two tables side by side and one of twice the flow": (
        circuit(TABLE | {"nodes": ["a", "b"]}, TABLE | {"nodes": ["a", "b"]}, c=load("capacitor", "b", 0.01)),
        circuit(
            TABLE | {"nodes": ["a", "b"], "points": [[u, 2 * i] for u, i in TABLE["points"]]},
            c=load("capacitor", "b", 0.01),
        ),
    ),
    "a transformer of two nodes and of four": (
        circuit({"kind": "transformer", "nodes": ["a", "b"], "ratio": 2.0}),
        circuit({"kind": "transformer", "nodes": ["a", "earth", "b", "earth"], "ratio": 2.0}, **EARTH),
    ),
    "a transformer that floats and none": (
        circuit(
            {"kind": "transformer", "nodes": ["a", "earth", "m", "earth"], "ratio": 1.0},
            part("resistor", "m b", 10.0),
            **EARTH,
        ),
        circuit(R),
    ),
    "a source at a node and one to earth": (
        circuit(R),
        circuit(R, sources={"s": DRIVE | {"nodes": ["source", "earth"], "resistance": 20.0}}, **EARTH),
    ),
    "a source and its resistance apart": (
        circuit(R),
        circuit(R, BEHIND, sources={"s": DRIVE | {"nodes": ["source2", "earth"]}}, **EARTH),
    ),
    "a source turned round": (
        circuit(R, sources={"s": DRIVE | {"nodes": ["a", "b"], "resistance": 20.0}}),
        circuit(R, sources={"s": DRIVE | {"nodes": ["b", "a"], "resistance": 20.0, "value": RAMP | {"to": -10.0}}}),
    ),
    "a voltage behind a resistance and a current beside it": (
        circuit(R),
        circuit(
            R,
            sources={"s": {"nodes": ["source", "earth"], "kind": "current", "value": RAMP | {"to": 0.5}}},
            r=load("resistor", "source", 20.0),
            **EARTH,
        ),
    ),
}  # fmt: skip


def efforts(tables: dict[str, Any], order: int) -> np.ndarray:
    scene = Scene(
        medium="electrical",
        t_end=6.0,
        lines={
            "first": {"nodes": ["source", "a"], "z0": 50.0, "delay": 1.0},
            "second": {"nodes": ["b", "end"], "z0": 70.0, "delay": 1.0},
        },
        probes={name: {"at": name} for name in ("source", "a", "b", "end")},
        solver={"order": order, "slab": 0.1},
        **tables | {"loads": tables["loads"] | {"end": {"at": "end", "kind": "resistor", "resistance": 30.0}}},
    )
    return np.array([probe.u for probe in simulate(scene).probes.values()])


@pytest.mark.parametrize("order", [1, 4])
@pytest.mark.parametrize("pair", PAIRS)
def test_both_do_the_same(pair, order):
    first, second = (efforts(tables, order) for tables in PAIRS[pair])
    assert np.abs(first - second).max() < 1e-11 * np.abs(first).max()
    assert np.abs(first[2]).max() > 0.5
