"""Random passive scenes: any topology, impedances and delays; loads with R, L, C, resistors and switches."""

import numpy as np

from tline.scene.scene import Scene


def random_scene(
    seed: int, *, lines: int = 6, loads: bool = True, switches: bool = True, sources: bool = False, **scene
) -> Scene:
    """A connected network with loops, delays without common measure, loads at half of its nodes, switches at some."""
    rng = np.random.default_rng(seed)
    count = max(2, int(rng.integers(lines // 2 + 1, lines + 2)))
    pairs = [(int(rng.integers(k)), k) for k in range(1, count)]
    pairs += [tuple(int(n) for n in rng.integers(count, size=2)) for _ in range(lines - len(pairs))]
    names = [f"n{k}" for k in range(count)]
    data = {
        "medium": "electrical",
        "t_end": 20.0,
        "lines": {
            f"l{k}": {
                "nodes": [names[i] for i in rng.permutation(pair)],
                "z0": float(10 ** rng.uniform(-1, 1)),
                "delay": float(rng.uniform(0.5, 3.0)),
            }
            for k, pair in enumerate(pairs)
        },
        "probes": {"p": {"at": names[-1], "line": next(f"l{k}" for k, pair in enumerate(pairs) if count - 1 in pair)}},
    }
    if sources:
        kinds = [("voltage", float(rng.uniform(0.2, 5))), ("current", float(rng.uniform(0.2, 5)))]
        kind, resistance = kinds[int(rng.integers(2))]
        value = {"shape": "sine", "amplitude": 1.0, "frequency": 0.2, "until": 5.0}
        data["sources"] = {"s": {"at": names[0], "kind": kind, "value": value, "resistance": resistance}}
    if loads:
        data["loads"] = {f"load{k}": _load(rng) | {"at": name} for k, name in enumerate(names) if rng.random() < 0.5}
        beside = {f"beside{k}": _beside(rng) | {"at": n} for k, n in enumerate(names) if rng.random() < 0.4}
        data["loads"] |= {k: load for k, load in beside.items() if switches or load["kind"] == "resistor"}
    return Scene(**data, **scene)


def _load(rng: np.random.Generator) -> dict:
    keys = ("resistance", "inductance", "capacitance")
    chosen = [key for key in keys if rng.random() < 0.7] or ["capacitance"]
    kind = "series" if rng.random() < 0.5 else "parallel"
    return {"kind": kind} | {key: float(10 ** rng.uniform(-1, 1)) for key in chosen}


def _beside(rng: np.random.Generator) -> dict:
    """A resistor, or a switch that moves somewhere in a slab of the first half of the run."""
    resistances = [float(10 ** rng.uniform(-1, 1)), float(rng.choice([10 ** rng.uniform(-2, 0), np.inf]))]
    if rng.random() < 0.5:
        return {"kind": "resistor", "resistance": resistances[0]}
    before, after = rng.permutation(resistances).tolist()
    return {"kind": "switch", "before": before, "after": after, "time": float(rng.uniform(0.0, 10.0))}
