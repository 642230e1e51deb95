"""Pump with a rotor that runs down once its control signal falls to zero; its state is speed over rated speed.

Constants: those of a pump (`laws.pump`).
"""

import numpy as np

from tline.solver.kernel.laws.pump import pumped, resting, torque
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill, filling
from tline.unit import function, unit


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow, about."""
    return y, 1.0, -resting(c, at, y), -abs(c[at + 1] * y) / c[at + 3]


@function
def entering(c, at, y, share, d, z):
    """Flow through the pump, and dX/dt."""
    i = pumped(c, at, y, d, z)[0]
    return i, -torque(c, at, y, i) / c[at + 3]


@unit
def rotor(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows through the pump at the points of a slab of width h, behind the efforts v and the impedance z."""
    if store.control[0] > 0.5:
        for j in range(store.flow.size):
            store.drive[j] = store.v[j] - store.constants[at] - stored(store.constants, at, store.states[state])[2]
            store.flow[j] = filling(stored, entering, store.constants, at, store.states[state], store.v[j], z)[0]
    else:
        fill(stored, entering, store, at, state, h, z, np.inf)
    return 0
