"""Random circuits of R, L, C and coupled coils between two lines do what their readable twin does."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from circuit_twin import Twin

from tline import Scene, simulate

Z0, EMF, RISE, SLAB, SLABS = [50.0, 70.0], 10.0, 0.5, 0.1, 60
NAMES = ["a", "b", "m1", "m2", "m3"]
KEYS = {"resistor": "resistance", "inductor": "inductance", "capacitor": "capacitance"}


def random_circuit(seed: int) -> tuple[Twin, dict[str, Any], dict[str, Any]]:
    """A chain from the first line to the second, and more across it: loops of capacitors and cuts of inductors too."""
    rng = np.random.default_rng(seed)
    nodes = int(rng.integers(2, 6))
    twin, links, loads = Twin(nodes, Z0), {}, {}

    def add(i: int, j: int) -> None:
        kind = [*KEYS][rng.integers(3)]
        value = float(10 ** rng.uniform(-1.5, 1)) * (1 / 50 if kind == "capacitor" else 50)
        if kind == "inductor":
            twin.windings([(i, j)], np.array([[value]]))
        else:
            (twin.capacitances if kind == "capacitor" else twin.conductances).append(
                (i, j, value if kind == "capacitor" else 1 / value)
            )
        table = {"kind": kind, KEYS[kind]: value}
        if j < 0:
            loads[f"load{len(loads)}"] = table | {"at": NAMES[i]}
        else:
            links[f"link{len(links)}"] = table | {"nodes": [NAMES[i], NAMES[j]]}

    chain = [0, *range(2, nodes), 1]
    for i, j in pairwise(chain):
        add(i, j)
    for _ in range(rng.integers(0, 5)):
        i, j = int(rng.integers(nodes)), int(rng.integers(-1, nodes))
        if i != j:
            add(i, j)
    if nodes >= 4 and rng.random() < 0.4:
        at, own, coupling = rng.permutation(nodes)[:4], 50 * 10 ** rng.uniform(-1.5, 1, 2), rng.uniform(-0.95, 0.95)
        mutual = coupling * np.sqrt(own.prod())
        twin.windings([(at[0], at[1]), (at[2], at[3])], np.array([[own[0], mutual], [mutual, own[1]]]))
        links["coils"] = {
            "kind": "coupled inductors",
            "nodes": [NAMES[k] for k in at],
            "inductance": own.tolist(),
            "coupling": float(coupling),
        }
    return twin, links, loads


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
@pytest.mark.parametrize("order", range(1, 9))
def test_random_circuits_do_what_their_twins_do(order):
    for seed in range(100 * order, 100 * order + 12):
        twin, links, loads = random_circuit(seed)
        ramp = {"shape": "ramp", "to": EMF, "duration": RISE}
        scene = Scene(
            medium="electrical",
            t_end=SLAB * SLABS,
            lines={
                "first": {"nodes": ["source", "a"], "z0": Z0[0], "delay": 1.0},
                "second": {"nodes": ["b", "end"], "z0": Z0[1], "delay": 1.0},
            },
            sources={"s": {"at": "source", "kind": "voltage", "value": ramp, "resistance": Z0[0]}},
            links=links,
            loads=loads | {"end": {"at": "end", "kind": "matched"}},
            probes={"a": {"at": "a"}, "b": {"at": "b"}},
            solver={"order": order, "slab": SLAB},
        )
        probes = simulate(scene).probes
        arriving = (lambda t: EMF * min(max((t - 1) / RISE, 0), 1), lambda t: 0.0)
        exact = twin.efforts(arriving, order, SLAB, SLABS)
        for node, name in enumerate("ab"):
            assert np.abs(probes[name].u - exact[:, node]).max() < 1e-9 * EMF, (seed, name)
