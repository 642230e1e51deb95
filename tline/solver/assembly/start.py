"""Lossy lines in a steady flow as arrays: waves before t = 0 on lines in diamonds."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tline.solver.kernel.diamonds.friction import lost
from tline.solver.kernel.network import Network, State
from tline.solver.radau import Basis
from tline.solver.steady.lossy_lines import Ends


def fill_diamonds(network: Network, state: State, flows: Mapping[int, Ends], order: Basis) -> None:
    """Write waves on lines that lose all along, each slab on its next edge, and what half diamonds take."""
    s, c = order.s, order.c
    for row, k in enumerate(network.diamonds.line.tolist()):
        D, f = int(network.delay[k]), float(network.diamonds.rest[row])
        m, n = np.arange(-D, 0)[:, None], np.arange(D)[:, None]
        ring = state.waves[network.offset[k] :][: 2 * D * s].reshape(2, D, s)

        def wave(xi: NDArray, eta: NDArray, sign: int, k: int = k, long: float = D + f) -> NDArray:
            u, q = flows[k].at((eta - xi) / (2 * long))
            return u + sign * q

        ring[0], ring[1] = wave(-n + 0 * c, n + f + c, -1), wave(m + c, -m + f + 0 * c, 1)
        state.before[2 * k] = wave(0 * c, f * c, -1)
        state.before[2 * k + 1] = wave(f * c - D - f, D + f + 0 * c, 1)
        d = 2 * flows[k].line.z0 * float(flows[k].y[0])
        state.halves[2 * k] = lost(network.diamonds, row, d)[0]
        state.halves[2 * k + 1] = -state.halves[2 * k]
