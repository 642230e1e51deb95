"""Random lossless multiports with lines and loads."""

import numpy as np
from hypothesis import strategies as st


@st.composite
def multiport_scenes(draw):
    """A line to each port of a random junction, gyrator, transformer or pair of windings, with loads at all ends."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def size() -> float:
        return float(rng.uniform(0.2, 5))

    k = draw(st.integers(2, 4))
    q, _ = np.linalg.qr(rng.normal(size=(k, k)))
    kinds = [{"kind": "junction", "z0": size(), "scattering": q.tolist()}]
    if k == 2:
        kinds += [
            {"kind": "gyrator", "resistance": size()}, {"kind": "transformer", "ratio": float(rng.normal())},
            {"kind": "coupled inductors", "inductance": [size(), size()], "coupling": float(rng.uniform(-0.99, 0.99))},
        ]  # fmt: skip
    ports = [f"p{j}" for j in range(k)]
    lines = {f"l{j}": {"nodes": [f"e{j}", at], "z0": size(), "delay": size()} for j, at in enumerate(ports)}
    if draw(st.booleans()):
        del lines["l1"]  # that port has its load alone
    loads = [
        {"kind": "parallel", "resistance": size(), "capacitance": size()},
        {"kind": "series", "inductance": size(), "capacitance": size()}, {"kind": "resistor", "resistance": size()},
    ]  # fmt: skip
    if "l1" not in lines:  # nothing but inductors at a node would leave its effort open
        del loads[1]
    places = [*ports, *(line["nodes"][0] for line in lines.values())]
    loaded = {  # with capacitors at several ports efforts may depend on each other
        at: {"at": at} | loads[rng.integers(at in ports[:1] + ports[2:], len(loads))]
        for at in places if at == "p1" or rng.random() > 0.3
    }  # fmt: skip
    return {
        "medium": "electrical", "t_end": 25.0, "lines": lines, "probes": {"p": {"at": "e0"}}, "loads": loaded,
        "links": {"x": {"nodes": ports} | kinds[rng.integers(len(kinds))]},
    }  # fmt: skip
