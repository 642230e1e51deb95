"""Tank with an area, or a capacitance, behind an orifice; its state is its effort.

Constants: effort beyond the element, capacity of the orifice, capacitance.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow."""
    return y, 1.0, y, 1.0 / c[at + 2]


@function
def entering(c, at, y, share, d, z):
    """Flow through the orifice, and dX/dt."""
    i = rooted(d, z, c[at + 1], 0.0)[0]
    return i, share * i


@unit
def tank(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the tank at the points of a slab of width h, behind the efforts v and the impedance z."""
    fill(stored, entering, store, at, state, h, z, np.inf)
    return 0
