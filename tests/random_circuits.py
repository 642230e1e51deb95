"""Random lumped circuits between the ends of lossless lines, as tables of scenes that nothing drives."""

from collections.abc import Iterator
from typing import Any

import numpy as np

Table = dict[str, Any]

DECADES = 3  # of time constants, to both sides of the slab
LINEAR = (
    "resistor", "inductor", "capacitor", "series", "parallel", "coupled inductors", "transformer", "gyrator",
)  # fmt: skip
LAWS = ("diode", "table", "check valve", "orifice", "relief valve")
VESSELS = ("air vessel", "surge tank", "vapour cavity")
POINTS = ([[-1, -2], [0, 0], [0.5, 0.5], [0.5, 1], [3, 1]], [[-1, -2], [0, 0], [0.5, 0.5], [1, 2]])


def random_circuit(
    seed: int, order: int, *, laws: bool = True, vessels: bool = False, slab: float | None = None
) -> Table:
    """One to four lines, some with delays of whole slabs, and up to eight elements at nodes and between them."""
    rng = np.random.default_rng(seed)
    slab = float(10 ** rng.uniform(-1.3, -0.31))
    lines = _lines(rng, slab)
    outer = sorted({node for line in lines.values() for node in line["nodes"]})
    inner = [f"m{k}" for k in range(rng.integers(4))]
    loads: Table = {}
    links: Table = {}
    for k, node in enumerate(inner):  # each is tied to a node of lines, maybe through others
        tie = str(rng.choice([*outer, *inner[:k]]))
        links[f"tie{k}"] = {"nodes": [tie, node] if rng.random() < 0.5 else [node, tie]} | element(rng, slab, laws, 1)
        if rng.random() < 0.5:
            other = str(rng.choice([at for at in (*outer, *inner[:k]) if at != tie]))
            links[f"other{k}"] = {"nodes": [node, other]} | element(rng, slab, laws, 1)
        else:
            loads[f"end{k}"] = {"at": node} | element(rng, slab, laws, 0)
    nodes = [*outer, *inner]
    for k, node in enumerate(nodes):
        if rng.random() < 0.5 and f"end{k - len(outer)}" not in loads:
            loads[f"load{k}"] = {"at": node} | element(rng, slab, laws, 0)
        if vessels and rng.random() < 0.3:
            loads[f"vessel{k}"] = {"at": node} | vessel(rng, slab)
    for k in range(rng.integers(1, 6)):
        made = element(rng, slab, laws, 2 if len(nodes) > 1 else 0)
        most = 4 if made["kind"] in LINEAR[5:] and rng.random() < 0.5 and len(nodes) > 2 else 2
        if len(nodes) > 1:
            one, other = rng.choice(nodes, 2, replace=False).tolist()
            chosen = [one, other]
            if most == 4:
                chosen += next(pair for pair in _pairs(rng, nodes) if set(pair) != set(chosen))
            links[f"link{k}"] = {"nodes": chosen} | made
    return {
        "medium": "hydraulic",
        "t_end": 40 * slab,
        "solver": {"order": order, "slab": slab},
        "lines": lines,
        "loads": loads,
        "links": links,
        "probes": {"p": {"at": lines["l0"]["nodes"][0], "line": "l0"}},
    }


def _lines(rng: np.random.Generator, slab: float) -> Table:
    """A tree, or with loops, of lines."""
    number = int(rng.integers(1, 5))
    lines, equal = {}, bool(rng.random() < 0.3)
    for k in range(number):
        pair = [int(rng.integers(k + 1)), k + 1]
        if k > 1 and rng.random() < 0.2:
            pair = rng.choice(k + 1, 2, replace=False).tolist()
        delay = max(float(10 ** rng.uniform(-0.3, 0.3)), slab)
        if equal or rng.random() < 0.3:
            delay = slab * (4 if equal else int(rng.integers(1, 6)))
        lines[f"l{k}"] = {
            "nodes": [f"n{i}" for i in rng.permutation(pair)],
            "z0": float(10 ** rng.uniform(-1, 1)),
            "delay": delay,
        }
    return lines


def element(rng: np.random.Generator, slab: float, laws: bool, ends: int) -> Table:
    """An element at a node (0), or between two (1), or of as many nodes as it likes (2), without them."""
    if laws and rng.random() < 0.45:
        return law(rng, ends > 0)
    z, tau = _spread(rng, 1.0), slab * _spread(rng, DECADES)
    kind = str(rng.choice(LINEAR[: 8 if ends == 2 else 5]))
    match kind:
        case "resistor":
            return {"kind": kind, "resistance": z}
        case "inductor":
            return {"kind": kind, "inductance": z * tau}
        case "capacitor":
            return {"kind": kind, "capacitance": tau / z}
        case "transformer":
            return {"kind": kind, "ratio": float(rng.choice([-1, 1]) * _spread(rng, 0.5))}
        case "gyrator":
            return {"kind": kind, "resistance": z}
        case "coupled inductors":
            k = float(rng.choice([rng.uniform(-0.99, 0.99), 0.9999]))
            return {"kind": kind, "inductance": [z * tau, z * tau * _spread(rng, 1.0)], "coupling": k}
    parts = {"resistance": z, "inductance": z * tau, "capacitance": slab * _spread(rng, DECADES) / z}
    gone = str(rng.choice([*parts, ""]))
    return {"kind": kind} | {name: value for name, value in parts.items() if name != gone}


def law(rng: np.random.Generator, between: bool) -> Table:
    """An element whose flow is no linear function of the effort across it."""
    rated = {"flow": _spread(rng, 1.0), "pressure_drop": 1.0}
    match str(rng.choice(LAWS)):
        case "diode":
            if rng.random() < 0.5:
                steep = {"saturation": _spread(rng, 3.0) * 1e-6, "temperature": 300.0, "emission": 1.0}
            else:
                steep = {"saturation": 0.1, "temperature": 3000.0, "emission": 4.0}
            return {"kind": "diode"} | steep | ({} if between else {"reverse": bool(rng.random() < 0.5)})
        case "table":
            return {"kind": "table", "points": POINTS[int(rng.integers(2))]}
        case "check valve":
            return {"kind": "check valve"} | ({} if between and rng.random() < 0.5 else rated)
        case "orifice":
            return {"kind": "orifice", "opening": float(rng.uniform(0.0, 1.0))} | rated
    return {"kind": "relief valve", "set_pressure": _spread(rng, 1.0), "band": _spread(rng, 1.0)} | rated


def vessel(rng: np.random.Generator, slab: float) -> Table:
    """A store at a node whose law is not linear, or a tank."""
    loss = {"flow": _spread(rng, 1.0), "pressure_drop": 1.0} if rng.random() < 0.5 else {}
    size = slab * 10 * _spread(rng, 1.0)
    match str(rng.choice(VESSELS)):
        case "air vessel":
            outside = _spread(rng, 1.0)
            return {
                "kind": "air vessel",
                "gas_volume": size * outside,
                "gas_pressure": 0.0,
                "atmosphere": outside,
            } | loss
        case "surge tank":
            return {"kind": "surge tank", "tank_area": size, "gravity": 1.0, "density": 1.0} | loss
    return {"kind": "vapour cavity", "atmosphere": 0.3, "vapour_pressure": 0.1}


def _pairs(rng: np.random.Generator, nodes: list[str]) -> Iterator[list[str]]:
    while True:
        yield rng.choice(nodes, 2, replace=False).tolist()


def _spread(rng: np.random.Generator, decades: float) -> float:
    """A number within so many decades around 1."""
    return float(10 ** rng.uniform(-decades, decades))
