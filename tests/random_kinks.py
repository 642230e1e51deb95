"""Random scenes in which waves bend within slabs: laws that kink, switches, sources with jumps and corners, losses."""

from typing import Any

import numpy as np

from tline.scene.scene import Scene

KINDS = "law", "link", "switch", "smooth", "element", "cable", "pipe"


def random_kinks(seed: int, kind: str | None = None, delayed: float | None = None) -> Scene:
    """A driven scene of one to three lines of some 1 s each, of a kind in KINDS, or of any.

    All instants of sources, switches and openings are `delayed`, and the run ends later by as much; sources are then
    zero until their first instant, or another clock would make another scene.
    """
    rng = np.random.default_rng(seed)
    kind = kind or str(rng.choice(KINDS))
    table = {"cable": _cable, "pipe": _pipe}.get(kind, _lossless)(rng, kind)
    return Scene(**(table if delayed is None else _later(table, delayed)))


def _lossless(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    lines = int(rng.integers(1, 4))
    names = [f"n{k}" for k in range(lines + 1)]
    pairs = [(0, 1), *((int(rng.integers(k)), k) for k in range(2, lines + 1))]
    delays = rng.choice([0.5, 1.0, 1.5], lines) if rng.random() < 0.6 else rng.uniform(0.5, 1.5, lines)
    hydraulic = kind == "element" or (kind in ("law", "link") and rng.random() < 0.5)
    loads: dict[str, Any] = {}
    links: dict[str, Any] = {}
    if kind in ("law", "link", "element"):
        made = (_water if hydraulic else _electric)(rng)
        far = names[-1]
        if kind == "link" and "reverse" not in made and made["kind"] not in ("leak", "demand"):
            links["x"] = made | {"nodes": [far, "beyond"]}
            loads["r"] = {"at": "beyond", "kind": "resistor", "resistance": _size(rng)}
        else:
            loads["x"] = made | {"at": far}
        if kind == "element":
            loads["v"] = _vessel(rng) | {"at": "n1" if lines > 1 else "n0"}
    if kind == "switch":
        before, after = rng.permutation([_size(rng), 100.0]).tolist()
        loads["s"] = {
            "at": names[-1], "kind": "switch", "before": before, "after": after, "time": float(rng.uniform(0, 5))
        }  # fmt: skip
    free = names[:-1] if kind in ("law", "link") else names
    if kind != "element" and rng.random() < 0.4:
        rc = {"kind": "parallel", "resistance": _size(rng), "capacitance": 0.1 * _size(rng)}
        loads["c"] = rc | {"at": str(rng.choice(free))}
    effort = "pressure" if hydraulic else "voltage"
    source = {"at": "n0", "kind": effort, "value": _waveform(rng, kind), "resistance": _size(rng)}
    return {
        "medium": "hydraulic" if hydraulic else "electrical",
        "t_end": 8.0,
        "lines": {
            f"l{k}": {"nodes": [names[i] for i in pair], "z0": _size(rng), "delay": float(delay)}
            for k, (pair, delay) in enumerate(zip(pairs, delays, strict=True))
        },
        "sources": {"s": source},
        "loads": loads,
        "links": links,
        "probes": {"far": {"at": names[-1]}, "mid": {"line": "l0", "position": f"{int(rng.integers(10, 90))} %"}},
    }


def _cable(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    losses = [
        {"resistance": _size(rng)},
        {"resistance": 0.5 * _size(rng), "conductance": 0.2 * _size(rng)},
        {"skin": {"resistance": 0.1 * _size(rng), "frequency": 1.0}},
    ][int(rng.integers(3))]
    loads = {"r": {"at": "b", "kind": "resistor", "resistance": _size(rng)}}
    if rng.random() < 0.3:
        loads = {"d": _electric(rng) | {"at": "b"}}
    return {
        "medium": "electrical",
        "t_end": 8.0,
        "lines": {"l": {"nodes": ["a", "b"], "length": 1.0, "z0": 1.0, "delay": 1.0, **losses}},
        "sources": {"s": {"at": "a", "kind": "voltage", "value": _waveform(rng, kind), "resistance": _size(rng)}},
        "loads": loads,
        "probes": {"near": {"at": "a"}, "far": {"at": "b"}},
    }


def _pipe(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    times = (float(10 ** rng.uniform(-1.5, 0.5)), float(10 ** rng.uniform(-1.5, 0.5)))
    losses = [
        {"friction": {"kind": "laminar", "viscosity": "0.03 Pa s"}},
        {"friction": {"kind": "darcy", "factor": 0.03}},
        {"wall_thickness": "2 mm", "creep": [{"compliance": "1e-10 1/Pa", "time": times[0]}]},
        {"wall_thickness": "2 mm", "creep": [{"compliance": float(3e-11 * _size(rng)), "time": t} for t in times]},
    ][int(rng.integers(4))]
    loads = {} if rng.random() < 0.5 else {"r": {"at": "b", "kind": "orifice", "flow": 1e-3, "pressure_drop": 1e5}}
    return {
        "medium": "hydraulic",
        "t_end": 8.0,
        "lines": {
            "l": {"nodes": ["a", "b"], "length": 1e3, "radius": 0.025, "density": 900, "wave_speed": 1e3, **losses}
        },
        "sources": {"s": {"at": "a", "kind": "pressure", "value": _scaled(_waveform(rng, kind), 1e5), "resistance": 0}},
        "loads": loads,
        "probes": {"near": {"at": "a"}, "far": {"at": "b"}},
    }  # fmt: skip


def _size(rng: np.random.Generator) -> float:
    return float(10 ** rng.uniform(-0.5, 0.5))


def _waveform(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    at, to = float(rng.choice([0.0, 0.25, rng.uniform(0, 2)])), float(rng.uniform(0.5, 3))
    sine = {"shape": "sine", "amplitude": to, "frequency": float(rng.uniform(0.1, 0.6))}
    ramp = {"shape": "ramp", "to": to, "at": at, "duration": float(rng.uniform(0.1, 2))}
    if kind == "smooth":
        return sine
    levels, gaps = rng.uniform(-2, 2, 5).round(1), rng.uniform(0.2, 1.5, 5)
    corners = {"shape": "piecewise linear", "points": np.stack([np.cumsum(gaps), levels], axis=1).tolist()}
    return [sine, ramp, corners, {"shape": "step", "to": to, "at": at}][int(rng.integers(4))]


def _scaled(value: dict[str, Any], by: float) -> dict[str, Any]:
    value = {k: by * x if k in ("to", "amplitude") else x for k, x in value.items()}
    if "points" in value:
        value["points"] = [[t, by * x] for t, x in value["points"]]
    return value


def _electric(rng: np.random.Generator) -> dict[str, Any]:
    return [
        {"kind": "diode", "saturation": 1e-3, "temperature": float(10 ** rng.uniform(2, 3.6)), "reverse": False},
        {"kind": "diode", "saturation": 1e-6, "temperature": 1000.0, "reverse": True},
        {"kind": "table", "points": [[-1, -2], [0, 0], [0.5, 0.5], [1, 2]]},
    ][int(rng.integers(3))]


def _water(rng: np.random.Generator) -> dict[str, Any]:
    rated = {"flow": _size(rng), "pressure_drop": 1.0}
    return [
        {"kind": "orifice"} | rated,
        {"kind": "check valve"} | rated,
        {"kind": "relief valve", "set_pressure": 0.3 * _size(rng), "band": 0.3 * _size(rng)} | rated,
        {"kind": "leak", "flow": _size(rng), "pressure": 1.0, "exponent": float(rng.uniform(0.4, 1.6))},
        {"kind": "demand", "flow": _size(rng), "required_pressure": _size(rng), "exponent": float(rng.uniform(0.5, 2))},
        {"kind": "table", "points": [[-1, -2], [0, 0], [0.5, 0.5], [1, 2]]},
    ][int(rng.integers(6))]  # fmt: skip


def _vessel(rng: np.random.Generator) -> dict[str, Any]:
    return [
        {"kind": "air vessel", "gas_volume": _size(rng), "gas_pressure": 0.0, "atmosphere": 5 * _size(rng)},
        {"kind": "surge tank", "tank_area": _size(rng), "gravity": 1.0, "density": 1.0},
    ][int(rng.integers(2))]


def _later(table: dict[str, Any], by: float) -> dict[str, Any]:
    """All instants later, in a copy."""
    value = dict(table["sources"]["s"]["value"])
    if "points" in value:
        value["points"] = [[t + by, x if k else 0.0] for k, (t, x) in enumerate(value["points"])]
    else:
        value["at"] = value.get("at", 0.0) + by
    loads = {k: load | ({"time": load["time"] + by} if "time" in load else {}) for k, load in table["loads"].items()}
    sources = {"s": table["sources"]["s"] | {"value": value}}
    return table | {"t_end": table["t_end"] + by, "sources": sources, "loads": loads}
