"""Random drives under a design of random bandwidths, and how fast their loops are."""

import random
from typing import Any

import numpy as np
from scipy.optimize import brentq

from drives import Belt, CoupledDrives, Design, Pulley, Spool, closed_loop, design

SOLVE: Any = brentq


def random_design(seed: int) -> tuple[Design, dict[str, float]]:
    """The design, and for each loop the frequency at which its gain is 1 in floats, over the one asked for."""
    rng = random.Random(seed)

    def size(low: float, high: float) -> float:
        return float(f"{10 ** rng.uniform(low, high):.4g}")

    spools = [Spool(size(-4, -1), size(-3, 0) * (rng.random() > 0.1), size(-2, -0.5)) for _ in range(2)]
    belts = [Belt(size(1, 4), size(-2, 1) * (rng.random() > 0.1)) for _ in range(2)]
    drives = CoupledDrives(
        spools[0], spools[1], belts[0], belts[1], Pulley(size(1, 4), round(rng.uniform(0.2, 1.4), 3))
    )
    asked = {"speed": size(0, 2.5), "tension": size(0, 2.5)}
    made = design(drives, asked["speed"], asked["tension"])
    loop = closed_loop(made)
    found = {}
    for k, (name, output) in enumerate((("speed", "belt_speed"), ("tension", "tension"))):
        row = loop.outputs.index(output)

        def gain(log: float, row: int = row, k: int = k) -> float:
            s = 1j * 10.0**log * np.eye(len(loop.states))
            whole = loop.C[row] @ np.linalg.solve(s - loop.A, loop.B[:, k]) + loop.D[row, k]
            return float(np.log(abs(whole / (1.0 - whole))))

        middle = np.log10(asked[name])
        grid = np.linspace(middle - 2.0, middle + 2.0, 401)
        values = [gain(x) for x in grid]
        last = max((j for j in range(400) if values[j] > 0.0 >= values[j + 1]), default=None)
        found[name] = 10.0 ** SOLVE(gain, grid[last], grid[last + 1]) / asked[name] if last is not None else np.inf
    return made, found
