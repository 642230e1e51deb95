"""Liquid on a spring with a preload, between two stops. Its state is its effort.

Constants: effort beyond the element, capacitance, efforts at its two stops.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow: at a stop X stays what it is, whatever the effort."""
    x = min(max(y, c[at + 2]), c[at + 3])
    return x, 1.0 if x == y else 0.0, y, 1.0 / c[at + 1]


@function
def entering(c, at, y, share, d, z):
    """Flow, and dX/dt."""
    return d / z, share * d / z


@unit
def spring(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows onto the spring at the points of a slab of width h, behind the efforts v and the impedance z."""
    fill(stored, entering, store, at, state, h, z, np.inf)
    for j in range(store.y.size):
        store.drive[j] = stored(store.constants, at, store.y[j])[0]  # which has a corner where it meets a stop
    return 0
