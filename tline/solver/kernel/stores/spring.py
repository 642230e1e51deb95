"""Liquid on a spring with a preload, between two stops, behind an orifice. Its state is its effort.

Constants: effort beyond the element, capacity of the orifice, capacitance, efforts at its two stops.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill
from tline.solver.kernel.stores.tank import entering


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow: at a stop X stays what it is, whatever the effort."""
    x = min(max(y, c[at + 3]), c[at + 4])
    return x, 1.0 if x == y else 0.0, y, 1.0 / c[at + 2]


@unit
def spring(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows onto the spring at the points of a slab of width h, behind the efforts v and the impedance z."""
    fill(stored, entering, store, at, state, h, z, np.inf)
    for j in range(store.y.size):
        store.drive[j] = stored(store.constants, at, store.y[j])[0]  # which has a corner where it meets a stop
    return 0
