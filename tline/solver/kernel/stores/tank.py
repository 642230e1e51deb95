"""Tank with an area, or a capacitance, behind an orifice; its state is its effort.

Constants: effort beyond the element, capacity of the orifice, capacitance.
"""

import numpy as np

from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill
from tline.unit import function, unit


@function
def stored(c, at, y):
    """X, dX/dy, effort, no loss of its own, and dX/dt over the flow."""
    return y, 1.0, y, 0.0, 1.0 / c[at + 2], 0.0


@function
def entering(c, at, d, z):
    """Flow through the orifice."""
    return rooted(d, z, c[at + 1], 0.0)[0]


@unit
def tank(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the tank at the points of a slab of width h, behind the efforts v and the impedance z."""
    fill(stored, entering, store, at, state, h, z, np.inf)
    return 0
