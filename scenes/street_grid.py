"""Writes a scene of 10,000 water pipes along the streets of a town: python scenes/street_grid.py > town.toml."""

import random
import sys
from collections.abc import Sequence
from itertools import pairwise

import tomli_w

SIDE, SEED = 71, 1  # nodes along a side of the town
LENGTHS, DIAMETERS = (60, 70, 80, 90, 100), (100, 150, 200, 300)  # m, mm


def grid(
    side: int = SIDE,
    *,
    friction: bool = True,
    lengths: Sequence[int] = LENGTHS,
    diameters: Sequence[int] = DIAMETERS,
    seed: int = SEED,
) -> dict:
    """Tables of a square grid with 2·side·(side - 1) pipes: reservoirs at three corners, a demand at every 20th node,
    and a hydrant in the middle that is shut at 0.1 s."""
    draw = random.Random(seed)
    nodes = [[f"n{i}_{j}" for j in range(side)] for i in range(side)]
    pairs = [pair for row in nodes for pair in pairwise(row)]
    pairs += [pair for column in zip(*nodes, strict=True) for pair in pairwise(column)]
    lines = {}
    for k, pair in enumerate(pairs):
        pipe = {"nodes": list(pair), "length": f"{draw.choice(lengths)} m", "diameter": f"{draw.choice(diameters)} mm"}
        pipe |= {"wave_speed": "1000 m/s", "density": "1000 kg/m^3"}
        lines[f"p{k}"] = pipe | ({"friction": {"kind": "darcy", "factor": "0.02"}} if friction else {})
    corners, every = [nodes[0][0], nodes[0][-1], nodes[-1][0]], [node for row in nodes for node in row]
    middle = nodes[side // 2][side // 2]
    demands = {
        f"demand at {node}": {"at": node, "kind": "flow", "value": "-0.02 L/s"}
        for node in every[::20]
        if node not in {middle, *corners}
    }
    shut = {"shape": "step", "from": "-5 L/s", "to": "0 L/s", "at": "0.1 s"}
    return {
        "title": f"{len(lines)} pipes along streets",
        "medium": "hydraulic",
        "t_end": "1 s",
        "start": "steady",
        "solver": {"order": 1, "slab": "10 ms"},
        "lines": lines,
        "loads": {f"lake {k}": {"at": at, "kind": "reservoir", "pressure": "5 bar"} for k, at in enumerate(corners)},
        "sources": demands | {"hydrant": {"at": middle, "kind": "flow", "value": shut}},
        "probes": {"hydrant": {"at": middle, "line": f"p{side // 2 * (side - 1) + side // 2}"}},
    }


if __name__ == "__main__":
    sys.stdout.write(tomli_w.dumps(grid()))
