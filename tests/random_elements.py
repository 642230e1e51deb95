"""Random passive scenes with non-linear elements at nodes and between them, some at nodes without lines."""

import numpy as np

from tline.scene.scene import Scene

ALONE = ("air vessel", "cavity", "vapour cavity", "air valve", "surge tank")  # kinds that want a node of their own


def random_elements(seed: int, *, lines: int = 5, operated: bool = True, driven: bool = False, **scene) -> Scene:
    """A tree of pipes with elements; openings move in the first half of the run if `operated`.

    If `driven`, a tank feeds it, and a valve lets some of it out.
    """
    rng = np.random.default_rng(seed)
    names = [f"n{k}" for k in range(lines + 1)]
    pairs = [(int(rng.integers(k)), k) for k in range(1, lines + 1)]
    free, loads, links = names.copy(), {}, {}
    if driven:
        free.remove("n0")
        loads["tank"] = {"at": "n0", "kind": "reservoir", "pressure": float(rng.uniform(2, 8))}
        loads["out"] = {"at": names[-1], "kind": "orifice", "flow": 1.0, "pressure_drop": 1.0}
    for k, name in enumerate(names):
        if name in free and rng.random() < 0.25 and not (driven and k == lines):
            free.remove(name)
            loads[f"vessel{k}"] = {"at": name} | _vessel(rng)
    for k, name in enumerate(free):
        if rng.random() < 0.6:
            loads[f"load{k}"] = {"at": name} | _load(rng, operated)
    for k in range(3):
        if len(free) > 1:
            one, other = rng.choice(free, 2, replace=False).tolist()
            if rng.random() < 0.4:  # two in a row, with nothing else between them
                links[f"second{k}"] = {"nodes": [f"m{k}", other]} | _link(rng, operated)
                other = f"m{k}"
            links[f"link{k}"] = {"nodes": [one, other]} | _link(rng, operated)
    return Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={
            f"l{k}": {
                "nodes": [names[i] for i in rng.permutation(pair)],
                "z0": float(10 ** rng.uniform(-0.5, 0.5)),
                "delay": float(rng.uniform(0.5, 2.0)),
            }
            for k, pair in enumerate(pairs)
        },
        loads=loads,
        links=links,
        probes={"p": {"at": names[-1], "line": f"l{lines - 1}"}},
        **scene,
    )


def _size(rng: np.random.Generator) -> float:
    return float(10 ** rng.uniform(-1, 1))


def _opening(rng: np.random.Generator, operated: bool) -> dict:
    if not operated:
        return {"opening": float(rng.uniform(0.1, 1))}
    levels, t = rng.uniform(0, 1, 4).round(1), np.sort(rng.uniform(0, 10, 4))
    return {"opening": {"shape": "piecewise linear", "points": np.stack([t, levels], axis=1).tolist()}}


def _load(rng: np.random.Generator, operated: bool) -> dict:
    rated = {"flow": _size(rng), "pressure_drop": 1.0}
    return [
        {"kind": "orifice"} | rated | _opening(rng, operated),
        {"kind": "check valve"} | rated,
        {"kind": "relief valve", "set_pressure": _size(rng), "band": _size(rng)} | rated,
        {"kind": "leak", "flow": _size(rng), "pressure": 1.0, "exponent": float(rng.uniform(0.4, 1.6))},
        {
            "kind": "demand",
            "flow": _size(rng),
            "required_pressure": _size(rng),
            "exponent": float(rng.uniform(0.4, 1.5)),
        },
        {"kind": "diode", "saturation": 0.1, "temperature": 3000, "emission": 4, "reverse": bool(rng.random() < 0.5)},
        {"kind": "table", "points": [[-1, -2], [0, 0], [0.5, 0.5], [0.5, 1], [3, 1]]},
    ][int(rng.integers(7))]


def _link(rng: np.random.Generator, operated: bool) -> dict:
    rated = {"flow": _size(rng), "pressure_drop": 1.0}
    return [
        {"kind": "orifice"} | rated | _opening(rng, operated),
        {"kind": "check valve"} | rated,
        {"kind": "relief valve", "set_pressure": _size(rng), "band": _size(rng)} | rated,
        {"kind": "diode", "saturation": 0.1, "temperature": 3000, "emission": 4},
        {"kind": "table", "points": [[-1, -2], [0, 0], [0.5, 0.5], [1, 2]]},
    ][int(rng.integers(5))]


def _vessel(rng: np.random.Generator) -> dict:
    loss = {"flow": _size(rng), "pressure_drop": 1.0} if rng.random() < 0.5 else {}
    return [
        {"kind": "air vessel", "gas_volume": _size(rng), "gas_pressure": 0.0, "atmosphere": 10 * _size(rng)} | loss,
        {"kind": "surge tank", "tank_area": _size(rng), "gravity": 1.0, "density": 1.0} | loss,
        {"kind": "cavity", "gas_volume": 0.1 * _size(rng), "atmosphere": 5.0, "vapour_pressure": 0.1},
        {"kind": "vapour cavity", "atmosphere": 0.3, "vapour_pressure": 0.1},
        {
            "kind": "air valve",
            "inlet_diameter": 0.1 * _size(rng) ** 0.5,
            "outlet_diameter": 0.1 * _size(rng) ** 0.5,
            "atmosphere": _size(rng),
        },
    ][int(rng.integers(5))]
