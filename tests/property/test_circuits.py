"""Lumped circuits between lines: they add no energy, always have a flow, and do the same however they are written."""

import contextlib
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from circuit_energy import largest_growth
from energy import silent
from random_chains import fade, random_chains
from random_circuits import Table, random_circuit

from tline import ActiveError, InputError, Scene, simulate
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.loop.march import Stepper
from tline.solver.run import run

SLABS, SCENES = 40, 8
AT_ONCE = 1e-13  # of the energy at the start, in one slab: roundings
SAME = 1e-11  # of the largest wave


@pytest.mark.parametrize("order", range(1, 9))
def test_energy_in_lines_and_circuits_never_grows(order):
    """Time constants over six decades around the slab, loops of capacitors, cuts of inductors, laws."""
    for seed in range(1000 * order, 1000 * order + SCENES):
        assert largest_growth(random_circuit(seed, order), seed, SLABS) <= AT_ONCE, seed


@pytest.mark.parametrize(
    "seed",
    [
        1524,
        4510,  # many points at kinks at once
        10879,
        3801,  # ideal transformers hold both nodes of a check valve at zero
        6778,
        11323,  # five check valves around a node, all of them shut
        18910,
    ],
)
def test_kinks_that_stop_a_step_are_crossed(seed):
    """In these circuits laws found no flow when steps had to make the residual less."""
    assert largest_growth(random_circuit(seed, 1 + seed % 8), seed, SLABS) <= AT_ONCE


@pytest.mark.parametrize("seed", [1357, 1452, 5707, 9387])
def test_diodes_that_block_against_each_other_find_the_effort_between_them(seed):
    """In these rows next to nothing flows, and Newton's method leads far away."""
    assert fade(random_chains(seed, 1 + seed % 16), seed) < 1e-12


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_energy_in_gas_tanks_and_cavities_never_grows(order):
    for seed in range(1000 * order, 1000 * order + SCENES):
        with contextlib.suppress(InputError):  # some waves are too large for some vessels
            assert largest_growth(random_circuit(seed, order, vessels=True), seed, SLABS) <= AT_ONCE, seed


@pytest.mark.parametrize(
    "seed",
    [
        187,  # waves that could fill the vessel four times in a slab
        188,  # searched for more than four minutes
        68,
        111,
        117,
        900,  # a tank beside a cavity, in strides of a millionth
    ],
)
def test_slabs_far_too_long_for_stores_are_divided_for_all_waves_alike(seed):
    """Flows into gas and vapour jumped from wave to wave, as a step or an opening was found or not: none fitted."""
    assert largest_growth(random_circuit(seed, 1 + seed % 8, vessels=True), seed, SLABS) <= AT_ONCE


def after(table: Table, seed: int) -> np.ndarray:
    """Waves under way after some slabs, over the largest at the start."""
    assembly = silent(Scene(**table), seed)
    start = np.abs(assembly.state.waves).max()
    Stepper(assembly, SLABS, np.zeros((0, 2, SLABS * table["solver"]["order"]))).advance(0, SLABS)
    return assembly.state.waves / start


def shuffled(table: Table, seed: int) -> Table:
    """The same circuit with its elements in another order."""
    rng = np.random.default_rng(seed)
    mixed = {}
    for part in ("loads", "links"):
        names = rng.permutation(list(table[part])).tolist()
        mixed[part] = {name: table[part][name] for name in names}
    return table | mixed


REVERSIBLE = {"resistor", "inductor", "capacitor", "series", "parallel", "transformer", "gyrator", "coupled inductors"}


def reversed_(table: Table, _: int) -> Table:
    """The same circuit with all linear elements turned round."""
    table = deepcopy(table)
    for link in table["links"].values():
        nodes = link["nodes"]
        if link["kind"] in ("transformer", "coupled inductors", "gyrator"):
            if len(nodes) == 4:
                link["nodes"] = [nodes[1], nodes[0], nodes[3], nodes[2]]
            elif link["kind"] == "transformer":
                link |= {"nodes": nodes[::-1], "ratio": 1 / link["ratio"]}
            elif link["kind"] == "coupled inductors":
                link |= {"nodes": nodes[::-1], "inductance": link["inductance"][::-1]}
        elif link["kind"] in REVERSIBLE:
            link["nodes"] = nodes[::-1]
    return table


TIME, IMPEDANCE = 1000.0, 1000.0
SCALES = {
    "z0": IMPEDANCE, "delay": TIME, "resistance": IMPEDANCE, "inductance": IMPEDANCE * TIME,
    "capacitance": TIME / IMPEDANCE, "flow": 1 / IMPEDANCE, "saturation": 1 / IMPEDANCE,
}  # fmt: skip


def rescaled(table: Table, _: int) -> Table:
    """The same circuit in other units of time and of flow."""
    table = deepcopy(table)
    table["t_end"] *= TIME
    table["solver"]["slab"] *= TIME
    for element in (*table["lines"].values(), *table["links"].values(), *table["loads"].values()):
        for key, scale in SCALES.items():
            if isinstance(element.get(key), list):
                element[key] = [value * scale for value in element[key]]
            elif key in element:
                element[key] *= scale
        if "points" in element:
            element["points"] = [[u, i / IMPEDANCE] for u, i in element["points"]]
    return table


@pytest.mark.parametrize("changed", [shuffled, reversed_, rescaled])
@pytest.mark.parametrize("laws", [False, True])
def test_another_way_to_write_a_circuit_changes_nothing(changed, laws):
    for seed in range(2 * SCENES):
        table = random_circuit(seed, 1 + seed % 8, laws=laws)
        distance = np.abs(after(table, seed) - after(changed(table, seed), seed)).max()
        assert distance <= SAME, seed


@pytest.mark.parametrize("order", [*range(1, 9), 12, 16])
def test_rows_of_laws_always_have_a_flow(order):
    """However weak the waves become, and whatever shuts."""
    for seed in range(1000 * order, 1000 * order + 4):
        assert fade(random_chains(seed, order), seed) < 1e-12


ROW = {
    "medium": "electrical",
    "t_end": 8.0,
    "solver": {"order": 4, "slab": 0.1},
    "lines": {
        "first": {"nodes": ["source", "a"], "z0": 50.0, "delay": 1.0},
        "second": {"nodes": ["b", "end"], "z0": 70.0, "delay": 1.0},
    },
    "sources": {
        "s": {"at": "source", "kind": "voltage", "value": {"shape": "ramp", "to": 1, "duration": 0.5}, "resistance": 20}
    },
    "probes": {"a": {"at": "a"}, "b": {"at": "b"}},
}
ALIKE = {
    "a gyrator before a capacitor, and an inductor": (
        {"g": {"kind": "gyrator", "nodes": ["a", "b", "m", "earth"], "resistance": 30}},
        {"c": {"at": "m", "kind": "capacitor", "capacitance": 0.05}, "earth": {"at": "earth", "kind": "short"}},
        {"l": {"kind": "inductor", "nodes": ["a", "b"], "inductance": 30**2 * 0.05}},
        {},
    ),
    "two capacitors in a row, and one": (
        {
            "one": {"kind": "capacitor", "nodes": ["a", "m"], "capacitance": 0.04},
            "two": {"kind": "capacitor", "nodes": ["b", "m"], "capacitance": 0.12},
        },
        {},
        {"c": {"kind": "capacitor", "nodes": ["a", "b"], "capacitance": 0.03}},
        {},
    ),
    "two inductors side by side, and one": (
        {
            "one": {"kind": "inductor", "nodes": ["a", "b"], "inductance": 30},
            "two": {"kind": "inductor", "nodes": ["b", "a"], "inductance": 60},
        },
        {},
        {"l": {"kind": "inductor", "nodes": ["a", "b"], "inductance": 20}},
        {},
    ),
}


@pytest.mark.parametrize("pair", ALIKE)
def test_circuits_that_are_alike_do_the_same(pair):
    links, loads, others, other_loads = ALIKE[pair]
    end = {"end": {"at": "end", "kind": "resistor", "resistance": 30}}
    one = simulate(Scene(**ROW, links=links, loads=loads | end)).probes
    other = simulate(Scene(**ROW, links=others, loads=other_loads | end)).probes
    for name in one:
        assert np.abs(one[name].u - other[name].u).max() <= SAME
        assert np.abs(one[name].u).max() > 0.1


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_active_links_are_refused_or_told():
    negative = {"x": {"kind": "impedance", "nodes": ["a", "b"], "expression": "s - 30"}}
    end = {"end": {"at": "end", "kind": "resistor", "resistance": 30}}
    scene = Scene(**ROW, links=negative, loads=end)
    with pytest.raises(ActiveError, match=r"links\.x"):
        simulate(scene)
    assert any("links.x" in note for note in simulate(scene, active=True, ledger=True).notes)
    amplifier = {"x": {"kind": "controlled source", "nodes": ["a", "b"], "gain": 3, "resistance": 40}}
    scene = Scene(**ROW, links=amplifier, loads=end)
    with pytest.raises(ActiveError, match=r"links\.x may feed waves"):
        simulate(scene)
    assert any("links.x" in note for note in simulate(scene, active=True, ledger=True).notes)


def test_a_slab_far_too_long_for_a_vessel_in_a_circuit_is_divided():
    """Each would fill and empty it some hundred times: without parts no flow is found in one of the slabs."""
    levels = np.random.default_rng(0).uniform(-3, 3, 20)
    points = [[0.1 * k, float(v) if k else 0.0] for k, v in enumerate(levels)]
    value = {"shape": "piecewise linear", "points": points}
    scene = Scene(
        medium="hydraulic",
        t_end=2.0,
        lines={"l": {"nodes": ["a", "b"], "z0": 0.176, "delay": 0.2033}},
        sources={"s": {"at": "a", "kind": "pressure", "resistance": 0.1, "value": value}},
        loads={"v": {"at": "b", "kind": "air vessel", "gas_volume": 0.0132, "gas_pressure": 0.0, "atmosphere": 0.161}},
        links={"c": {"nodes": ["a", "b"], "kind": "check valve"}},
        probes={"b": {"at": "b"}},
    )
    rough = run(describe(scene), Resolution(7, 0.0508))
    fine = run(describe(scene), Resolution(4, 0.0508 / 16))
    ends = rough.probes["b"].t[2:-1]
    assert len(rough.probes["b"].record.a1.pieces.slab) > 3 * len(ends)
    off = np.abs(rough.probes["b"].at(ends).u - fine.probes["b"].at(ends).u)
    assert np.median(off) <= 0.05 * np.abs(fine.probes["b"].u).max()


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
