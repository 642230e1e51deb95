"""Pump with a rotor that runs down once its control signal falls to zero; its state is speed over rated speed.

Constants: those of a pump (`laws.pump`), then the inertia's share.
"""

import numpy as np

from tline.solver.kernel.laws.pump import parabolic
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill, filling
from tline.unit import function, unit


@function
def stored(c, at, y):
    """X, dX/dy, effort, loss over the flow, and dX/dt = (r + q i) i."""
    sign = 1.0 if y > 0.0 else -1.0
    rate, bend = -c[at + 1] * abs(y) / c[at + 5], c[at + 2] * sign / c[at + 5]
    return y, 1.0, -c[at + 1] * y * abs(y), c[at + 2] * abs(y), rate, bend


@function
def entering(c, at, d, z):
    """Flow through the pump."""
    return parabolic(d, z, c[at + 3], c[at + 4])[0]


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
