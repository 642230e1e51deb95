"""A transformer that nothing joins to a network leaves its steady state as it is, though other equations are solved."""

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from random_elements import random_elements
from random_pockets import random_pockets

from tline import InputError, Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import above_level

EFFORT, FLOW = 1e-9, 1e-6  # of the largest; flows as roots of drops that are rounded
PIPE = {"length": 300, "diameter": 0.1, "wave_speed": 1000, "density": 1000}
BESIDE = {
    "lines": {"apart": PIPE | {"nodes": ["apart0", "apart1"]}},
    "links": {"apart": {"kind": "transformer", "nodes": ["apart1", "apart2"], "ratio": 2.0}},
    "loads": {
        "apart0": {"at": "apart0", "kind": "reservoir", "pressure": 1e5},
        "apart2": {"at": "apart2", "kind": "resistor", "resistance": 1e8},
    },
}


def beside(scene: Scene) -> Scene:
    table = scene.table()
    return Scene(**table | {part: table.get(part, {}) | more for part, more in BESIDE.items()})


@pytest.mark.parametrize("network", [random_pockets, lambda seed: random_elements(seed, driven=True)])
@given(seed=st.integers(0, 2**32 - 1))
@example(seed=15683)  # a check valve with no drop, beside efforts 3e4 times those there
@settings(max_examples=10, deadline=None)
def test_both_ways_of_balance_agree(network, seed):
    scene = network(seed)
    alone, both = above_level(describe(scene)), above_level(describe(beside(scene)))
    effort = np.array(list(alone.effort.values()))
    assert np.array([both.effort[node] for node in alone.effort]) == pytest.approx(
        effort, abs=EFFORT * np.abs(effort).max()
    )
    largest = max(np.abs(alone.flows).max(), np.abs(effort).max() / 1e9)
    assert both.flows[: len(alone.flows)] == pytest.approx(alone.flows, abs=FLOW * largest)
    assert both.effort["apart2"] == pytest.approx(5e4, rel=EFFORT)  # half of 1 bar


def test_a_pocket_beside_a_multiport_starts_with_what_it_is_said_to():
    def pocket(start: float) -> Scene:
        return beside(
            Scene(
                medium="hydraulic",
                t_end=1,
                start="steady",
                lines={"pocket": PIPE | {"nodes": ["a", "b"]}, "first": PIPE | {"nodes": ["lake", "c"]}},
                links={"check": {"kind": "check valve", "nodes": ["c", "a"]}},
                loads={"lake": {"at": "lake", "kind": "reservoir", "pressure": "5 bar"}},
                nodes={"b": {"start": start}},
                probes={"p": {"at": "b"}},
            )
        )

    assert above_level(describe(pocket(7e5))).effort["a"] == pytest.approx(7e5, rel=1e-12)
    with pytest.raises(InputError, match=r"nodes\.b\.start: a valve would open, expected such as 500000 Pa"):
        above_level(describe(pocket(4e5)))
