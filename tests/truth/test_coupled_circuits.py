"""Circuits at coupled conductors: a pair driven alike is two single lines, whatever stands at its ends."""

import numpy as np
import pytest

from tline import Scene, simulate

NS = 1e-9
LL, LM, CC, CM = 3e-7, 1e-7, 1e-10, -2e-11
STEP = {"shape": "pulses", "high": 2, "width": 4 * NS, "rise": 0.5 * NS, "fall": 0.5 * NS, "at": 0.3 * NS}
PAIR = {"p": {
    "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": 0.2, "inductance": [[LL, LM], [LM, LL]],
    "capacitance": [[CC, CM], [CM, CC]],
}}  # fmt: skip
SINGLE = {
    f"p{k}": {"nodes": [f"a{k}", f"b{k}"], "length": 0.2, "inductance": LL + LM, "capacitance": CC + CM} for k in "12"
}
EXTRA = {
    "links": {},
    "a switch": {"loads": {"S": {"at": "b", "kind": "switch", "before": 1e3, "after": 20, "time": 5 * NS}}},
    "a diode": {"loads": {"D": {"at": "b", "kind": "diode", "saturation": 1e-9}}},
    "a source between nodes": {
        "sources": {"O": {"nodes": ["b", "y"], "kind": "voltage", "value": 0.2}},
        "loads": {"Y": {"at": "y", "kind": "resistor", "resistance": 200}},
    },
    "a transformer": {
        "links": {"N": {"kind": "transformer", "nodes": ["b", "y"], "ratio": 2}},
        "loads": {"Y": {"at": "y", "kind": "resistor", "resistance": 20}},
    },
}  # fmt: skip
COMMON = {
    "sources": {"V": {"at": "s", "kind": "voltage", "value": STEP}},
    "links": {
        "R": {"nodes": ["s", "a"], "kind": "resistor", "resistance": 30},
        "L": {"nodes": ["b", "x"], "kind": "inductor", "inductance": 3e-9},
    },
    "loads": {"C": {"at": "x", "kind": "capacitor", "capacitance": 2e-12}},
}


def twice(section: str, extra: dict) -> dict:
    """Elements once for each conductor, their nodes with its number."""
    tables = COMMON[section] | extra.get(section, {})
    return {
        name + k: table
        | ({"at": table["at"] + k} if "at" in table else {"nodes": [node + k for node in table["nodes"]]})
        for name, table in tables.items()
        for k in "12"
    }


@pytest.mark.parametrize("extra", EXTRA.values(), ids=EXTRA)
def test_a_pair_driven_alike_is_two_single_lines(extra):
    elements = {section: twice(section, extra) for section in COMMON}
    pair, single = (
        simulate(
            Scene(
                medium="electrical", t_end=12 * NS, lines=lines, solver={"tol": 1e-7},
                probes={at: {"at": f"{at}1"} for at in "abx"}, **elements,
            )
        )
        for lines in (PAIR, SINGLE)
    )  # fmt: skip
    t = np.linspace(0.01 * NS, 11.9 * NS, 500)
    for at in "abx":
        one, other = (result.probes[at].at(t).u for result in (pair, single))
        assert np.abs(one - other).max() < 2e-7 * np.abs(other).max()
