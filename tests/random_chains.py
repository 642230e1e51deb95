"""Random networks of lines with laws in a row between them, through nodes at which nothing else is."""

import numpy as np
from energy import silent
from random_circuits import Table, law

from tline.scene.scene import Scene
from tline.solver.loop.march import Stepper


def random_chains(seed: int, order: int) -> Table:
    """Two to nine lines that end in resistances near their z0, joined by rows of one to six laws; any slab."""
    rng = np.random.default_rng(seed)
    number = int(rng.integers(2, 10))
    delays = 10 ** rng.uniform(-0.5, 0.5, number)
    slab = float(delays.min() * (1.0 if rng.random() < 0.2 else 10 ** rng.uniform(-1, 0)))
    lines, loads, links = {}, {}, {}
    for k in range(number):
        z0 = float(10 ** rng.uniform(-1, 1))
        lines[f"l{k}"] = {"nodes": [f"a{k}", f"b{k}"], "z0": z0, "delay": float(delays[k])}
        loads[f"end{k}"] = {"at": f"b{k}", "kind": "resistor", "resistance": z0 * float(rng.uniform(0.3, 3.0))}
        if k:
            _row(rng, links, f"a{rng.integers(k)}", f"a{k}", k)
    if number > 2 and rng.random() < 0.5:
        one, other = rng.choice(number, 2, replace=False)
        _row(rng, links, f"a{one}", f"a{other}", number)
    if rng.random() < 0.5:
        loads["side"] = {"at": f"a{rng.integers(number)}"} | law(rng, False)
    return {
        "medium": "hydraulic",
        "t_end": 400 * slab,
        "solver": {"order": order, "slab": slab},
        "lines": lines,
        "loads": loads,
        "links": links,
        "probes": {"p": {"at": "a0", "line": "l0"}},
    }


def _row(rng: np.random.Generator, links: Table, one: str, other: str, k: int) -> None:
    """Laws between two nodes, one after the other."""
    laws = int(rng.integers(1, 7))
    nodes = [one, *(f"m{k}_{j}" for j in range(1, laws)), other]
    for j in range(laws):
        pair = [nodes[j], nodes[j + 1]]
        links[f"law{k}_{j}"] = {"nodes": pair if rng.random() < 0.7 else pair[::-1]} | law(rng, True)


def fade(table: Table, seed: int, slabs: int = 130) -> float:
    """Leave random waves to themselves, made ten times weaker every ten slabs. Returns what is left of the largest."""
    assembly = silent(Scene(**table), seed)
    steps = Stepper(assembly, slabs, np.zeros((0, 2, slabs * table["solver"]["order"])))
    state, start = assembly.state, np.abs(assembly.state.waves).max()
    for slab in range(0, slabs, 10):
        steps.advance(slab, slab + 10)
        state.waves[:] *= 0.1
        state.before[:] *= 0.1
    return float(np.abs(state.waves).max() / start)
