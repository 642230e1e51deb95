"""Random water networks with friction in which valves that hold cut off pockets, in rows and in loops."""

import numpy as np

from tline.scene.scene import Scene


def random_pockets(seed: int, nodes: int = 9, **scene) -> Scene:
    """Pipes, check valves, shut valves, relief valves and pumps between two reservoirs and an outlet; nothing moves."""
    rng = np.random.default_rng(seed)
    names = [f"n{k}" for k in range(nodes)]
    lines, links = {}, {}
    pairs = [(names[int(rng.integers(k))], names[k]) for k in range(1, nodes)]
    pairs += [tuple(rng.choice(names, 2, replace=False).tolist()) for _ in range(3)]
    for k, pair in enumerate(pairs):
        ends = [str(name) for name in rng.permutation(pair)]
        if k == 0 or rng.random() < 0.4:
            lines[f"pipe{k}"] = {"nodes": ends} | _pipe(rng)
            continue
        lines[f"pipe{k}"] = {"nodes": [f"m{k}", ends[1]]} | _pipe(rng)
        links[f"link{k}"] = {"nodes": [ends[0], f"m{k}"]} | _link(rng)
    ended = {node for line in lines.values() for node in line["nodes"]}
    for k, name in enumerate(names):
        if name not in ended:
            lines[f"end{k}"] = {"nodes": [name, f"e{k}"]} | _pipe(rng)
    levels = rng.uniform(1e5, 1e6, 2)
    loads = {
        "lake": {"at": "n0", "kind": "reservoir", "pressure": float(levels[0])},
        "tower": {"at": names[-1], "kind": "reservoir", "pressure": float(levels[1])},
        "out": {"at": "n1", "kind": "orifice", "flow": 0.01, "pressure_drop": 3e5},
    }
    if rng.random() < 0.5:
        loads["leak"] = {"at": "n2", "kind": "leak", "flow": 1e-3, "pressure": 3e5}
    probes = {"p": {"at": "n0", "line": "pipe0"}}
    fixed = {"medium": "hydraulic", "start": "steady", "t_end": 5.0, "probes": probes}
    return Scene(lines=lines, links=links, loads=loads, **fixed | scene)


def _pipe(rng: np.random.Generator) -> dict:
    pipe = {"length": float(10 ** rng.uniform(0.5, 3)), "diameter": 0.15, "wave_speed": 1000, "density": 1000}
    return pipe | {"friction": {"kind": "darcy", "factor": 0.02}}


def _link(rng: np.random.Generator) -> dict:
    rated = {"flow": float(10 ** rng.uniform(-5, -1)), "pressure_drop": 1e5}
    return [
        {"kind": "check valve"},
        {"kind": "check valve"} | rated,
        {"kind": "check valve", "cracking_pressure": 3e4} | rated,
        {"kind": "orifice", "opening": 0} | rated,
        {"kind": "orifice", "opening": 0.5} | rated,
        {"kind": "relief valve", "set_pressure": 2e5, "band": 1e5} | rated,
        {"kind": "pump", "curve": [[0.01, 2e5]], "check_valve": bool(rng.random() < 0.7)},
        {"kind": "pump", "curve": [[0.01, 2e5]], "check_valve": True, "speed": 0},
    ][int(rng.integers(8))]
